// SPDX-License-Identifier: Apache-2.0
// The vertices of the whole input on their common grid, by the host.
#pragma once

#include <optional>
#include <vector>

#include "common/predicates.h"
#include "mesh/grid.hpp"

namespace gcdt::tiles {

/// A vertex on the grid; both are in [0, 2^31 - 1].
using GridPoint = std::array<std::int32_t, 2>;

inline device::Vertex vertex_at(const GridPoint& p) { return device::gcdt_finite_vertex(p[0], p[1]); }
/// Twice the signed area of (a, b, c): > 0 counter-clockwise.
inline std::int64_t orient2d(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return device::gcdt_orient2d_finite(vertex_at(a), vertex_at(b), vertex_at(c));
}

struct Placed {
  ChosenGrid chosen;
  std::vector<GridPoint> points;
};

/// The grid that one device would choose (docs/contract.md, 1), and every vertex on it. Throws invalid_argument,
/// coordinate_not_finite and coordinate_outside_grid as order() does.
Placed place(Points points, const std::optional<FixedGrid>& fixed);

}  // namespace gcdt::tiles
