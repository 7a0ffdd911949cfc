// SPDX-License-Identifier: Apache-2.0
// The C interface: values of the vertices that splitting adds.
#include <algorithm>
#include <array>
#include <cmath>

#include "api/state.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

using Point = std::array<double, 2>;

/// The value on the segment between two vertices, at its point nearest to `p`, linear between the values of the two.
/// Differences are scaled by the largest one, so that their squares neither overflow nor vanish.
double value_along(const Points& points, const Constraint& constraint, const double* values, const Point& p) {
  const auto at = [&](std::uint32_t v) { return Point{points.coordinate(v, 0), points.coordinate(v, 1)}; };
  const Point a = at(constraint[0]), b = at(constraint[1]);
  const double scale = std::max(std::abs(b[0] / 2 - a[0] / 2), std::abs(b[1] / 2 - a[1] / 2));
  double along = 0, square = 0;
  for (int axis = 0; axis < 2 && scale > 0; ++axis) {
    const double whole = (b[axis] / 2 - a[axis] / 2) / scale, part = (p[axis] / 2 - a[axis] / 2) / scale;
    along += part * whole;
    square += whole * whole;
  }
  const double t = square > 0 ? std::min(1.0, std::max(0.0, along / square)) : 0.0;
  return (1 - t) * values[constraint[0]] + t * values[constraint[1]];
}

}  // namespace

int32_t gcdt_added_values(const gcdt_input* input, const double* added, const uint32_t* crossings, uint64_t count,
                          const double* vertex_values, double* values) {
  return guarded(nullptr, [&] {
    const gcdt_input given = read_struct(input, "gcdt_input");
    const Points points = read_points(given);
    const Constraints constraints = read_constraints(given);
    require((added && crossings && values) || count == 0, "added, crossings or values is null");
    require(vertex_values || points.size() == 0, "vertex_values is null");
    for (std::uint64_t i = 0; i < 2 * count; ++i) {
      if (crossings[i] >= constraints.size())
        throw Error(
            Status::invalid_argument,
            "added vertex " + std::to_string(i / 2) + ": there is no constraint " + std::to_string(crossings[i]),
            {i / 2, crossings[i]});
      for (const std::uint32_t v : constraints[crossings[i]])
        if (v >= points.size())
          throw Error(Status::index_out_of_range,
                      "constraint " + std::to_string(crossings[i]) + " has vertex " + std::to_string(v) +
                          ", but there are " + std::to_string(points.size()),
                      {crossings[i], v == constraints[crossings[i]][1]});
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      const Point p = {added[2 * i], added[2 * i + 1]};
      const double one = value_along(points, constraints[crossings[2 * i]], vertex_values, p);
      const double other = value_along(points, constraints[crossings[2 * i + 1]], vertex_values, p);
      values[i] = one / 2 + other / 2;
    }
  });
}
