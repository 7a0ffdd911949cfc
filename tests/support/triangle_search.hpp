// SPDX-License-Identifier: Apache-2.0
// Where a point is, by a search of all triangles: the oracle of point location.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace gcdt::test {

using Grid32 = std::vector<std::array<std::int32_t, 2>>;

inline std::int64_t orient(const std::array<std::int32_t, 2>& a, const std::array<std::int32_t, 2>& b,
                           const std::array<std::int32_t, 2>& c) {
  return (std::int64_t{b[0]} - a[0]) * (std::int64_t{c[1]} - a[1]) -
         (std::int64_t{b[1]} - a[1]) * (std::int64_t{c[0]} - a[0]);
}

/// The least of the triangles that holds q, border included, or -1.
template <class Triangles>
std::int32_t found_in(const Grid32& points, const Triangles& triangles, const std::array<std::int32_t, 2>& q) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (orient(points[a], points[b], q) >= 0 && orient(points[b], points[c], q) >= 0 &&
        orient(points[c], points[a], q) >= 0)
      return static_cast<std::int32_t>(t);
  }
  return -1;
}

}  // namespace gcdt::test
