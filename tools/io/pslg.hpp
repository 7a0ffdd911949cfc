// SPDX-License-Identifier: Apache-2.0
// Binary planar straight-line graphs (.pslg), of which any part can be read.
#pragma once

#include "binary_file.hpp"

#include <gcdt/types.hpp>

namespace gcdt::io {

/// "PSLGBIN1", the numbers of vertices and segments (int64), the vertices (two float64 each), the segments (two int32
/// each), least byte first. Throws Failure (Exit::input).
class PslgFile {
 public:
  /// Reads the head, and checks that the file is as long as it says.
  explicit PslgFile(const std::string& path);

  std::uint64_t vertices() const { return vertices_; }
  std::uint64_t segments() const { return segments_; }
  void read_vertices(std::uint64_t first, std::uint64_t count, std::array<double, 2>* to);
  /// Vertex numbers may be any.
  void read_segments(std::uint64_t first, std::uint64_t count, Constraint* to);
  /// Where a segment stands in the file.
  std::uint64_t place_of_segment(std::uint64_t number) const;

 private:
  BinaryFile file_;
  std::uint64_t vertices_ = 0, segments_ = 0;
};

}  // namespace gcdt::io
