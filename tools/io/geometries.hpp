// SPDX-License-Identifier: Apache-2.0
// Points, lines and polygons on their way to a planar straight-line graph: what formats of geometries share.
#pragma once

#include <limits>

#include "triangle_files.hpp"

namespace gcdt::io {

/// Collections in collections: deeper than any file that means it.
constexpr int deepest_collection = 64;

/// Takes positions in their order. A ring's last position, which repeats its first, is left out; outer rings are
/// directed counter-clockwise and holes clockwise; the positions' heights are an attribute, if all have one.
class Geometries {
 public:
  explicit Geometries(Input& input) : input_(input) {}

  /// Adds a vertex, of a line or alone; false if there are as many as there can be.
  bool add(double x, double y, double height = std::numeric_limits<double>::quiet_NaN());
  /// The vertices from now on are a line or ring.
  void begin() { begin_ = static_cast<std::uint32_t>(input_.vertices.size()); }
  void end_line() { connect(false); }
  void end_ring() { connect(true); }
  /// The rings since the last polygon are one: the first its outside, the others its holes.
  void end_polygon() { polygon_offsets_.push_back(rings_.size()); }
  /// To be called once, after the last.
  void finish();

 private:
  void connect(bool ring);
  void direct_rings();
  void take_heights();

  struct Ring {
    std::uint32_t begin, end;  ///< vertices
    std::size_t first_constraint;
  };
  Input& input_;
  std::uint32_t begin_ = 0;
  std::vector<Ring> rings_;
  std::vector<std::uint64_t> polygon_offsets_ = {0};
  std::vector<double> heights_;  ///< one a vertex
};

}  // namespace gcdt::io
