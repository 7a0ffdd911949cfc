// SPDX-License-Identifier: Apache-2.0
// Where vertices are in a picture.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace gcdt::io {

/// The vertices on a canvas of whole units: the bounding box scaled to the longer side, y downwards.
struct Canvas {
  static constexpr double longer_side = 1e5;  ///< units of the canvas; a unit is 1e-5 of the picture
  using Place = std::array<std::int32_t, 2>;

  std::vector<Place> places;
  double width = 0, height = 0;
  double unit = 0;  ///< of the input; 0 if the vertices are one point, or too far apart

  explicit Canvas(const std::vector<std::array<double, 2>>& vertices) : places(vertices.size()) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    std::array<double, 2> low{inf, inf}, high{-inf, -inf};
    for (const auto& v : vertices)
      for (int axis = 0; axis < 2; ++axis) {
        low[axis] = std::min(low[axis], v[axis] / 2);  // halves: the extent of doubles is no double
        high[axis] = std::max(high[axis], v[axis] / 2);
      }
    if (vertices.empty()) return;
    const double extent = std::max(high[0] - low[0], high[1] - low[1]);
    auto scaled = [&](double half) { return extent > 0 ? half / extent * longer_side : 0; };
    unit = 2 * (extent / longer_side);
    width = scaled(high[0] - low[0]);
    height = scaled(high[1] - low[1]);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      places[i] = {static_cast<std::int32_t>(std::lround(scaled(vertices[i][0] / 2 - low[0]))),
                   static_cast<std::int32_t>(std::lround(scaled(high[1] - vertices[i][1] / 2)))};
  }
};

}  // namespace gcdt::io
