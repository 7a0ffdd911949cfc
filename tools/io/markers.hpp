// SPDX-License-Identifier: Apache-2.0
// What the input's markers and attributes say of pieces, edges and triangles of a result.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "triangle_files.hpp"

namespace gcdt::io {

/// The markers of constrained edges. An edge has the marker of its least source that has one; 1 if none has.
class PieceMarkers {
 public:
  explicit PieceMarkers(const Result& result);
  std::int32_t of_piece(std::size_t piece) const;
  std::int32_t of_edge(std::uint32_t a, std::uint32_t b) const;

 private:
  using Entry = std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;
  const Result& result_;
  std::vector<Entry> by_ends_;
};

/// What Triangle's switch -A writes: the attribute of the region's seed, 0 without one.
double region_attribute(const Result& result, std::size_t t);

}  // namespace gcdt::io
