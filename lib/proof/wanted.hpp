// SPDX-License-Identifier: Apache-2.0
// What a refinement wants of triangles, for the proof of refined meshes.
#pragma once

#include <string>
#include <vector>

#include "proof/mesh.hpp"
#include "proof/wide.hpp"

namespace gcdt::proof {

/// Of a triangle: its doubled area, its largest corner product, in corner k, where the least angle is, and squares of
/// its shortest side, which is across from there, and of its longest.
struct Shape {
  std::int64_t area, dot, shortest, longest;
  std::uint32_t k;
};

Shape shape_of(const Sites& sites, const std::array<std::uint32_t, 3>& corners);

class Wanted {
 public:
  Wanted(const Refinement& refinement, const Grid& grid);

  /// Finds the lengths that are wanted at all vertices, in cells: those of the input as given, from 1 to 2^31 - 1, one
  /// at an added vertex as linear on what it was put on, which `origins` says. Needed before is_large() if lengths are
  /// wanted. Returns the first failure. Ends: a vertex is done once, and one that waits for itself is a failure.
  std::string find_lengths(const Sites& sites, std::uint32_t inputs, Span<std::array<std::uint32_t, 4>> origins);

  bool is_sharp(const Shape& shape) const { return Wide(shape.area) * (Wide(1) << 31) < Wide(shape.dot) * tangent_; }
  /// `seed`: of the triangle's region, or none.
  bool is_large(const Shape& shape, const std::array<std::uint32_t, 3>& corners, std::uint32_t seed) const;
  /// May this squared length, or one that is `times` as long, be made no shorter?
  bool is_short(std::int64_t squared, int times = 1) const {
    return static_cast<long double>(squared) < least_ * least_ * times * times;
  }

 private:
  std::string find_length(const Sites& sites, std::uint32_t v, const std::array<std::uint32_t, 4>& origin);

  const Refinement& refinement_;
  Wide tangent_ = 0;                      // the least one, in units of 2^-31
  long double cell_, most_area_, least_;  // areas are doubled, in cells
  std::vector<long double> most_areas_;   // by seed
  std::vector<std::uint32_t> lengths_;    // by vertex; empty unless they are wanted
};

}  // namespace gcdt::proof
