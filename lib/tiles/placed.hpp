// SPDX-License-Identifier: Apache-2.0
// The whole input as the host sees it: vertices go to their common grid when they are asked for, one by one.
#pragma once

#include <optional>
#include <vector>

#include "common/levels.h"
#include "common/predicates.h"
#include "mesh/grid.hpp"

namespace gcdt::tiles {

/// A vertex on the grid; both are in [0, 2^31 - 1].
using GridPoint = std::array<std::int32_t, 2>;
using GridPoints = Array<GridPoint>;

/// A box of grid points, its border included.
struct Box {
  std::array<std::int64_t, 2> least, most;
};

/// The Morton code of a grid point, by which the Z-order goes.
inline std::uint64_t code_of(const GridPoint& p) {
  return device::gcdt_morton(static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]));
}

inline device::Vertex vertex_at(const GridPoint& p) { return device::gcdt_finite_vertex(p[0], p[1]); }
/// Twice the signed area of (a, b, c): > 0 counter-clockwise.
inline std::int64_t orient2d(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return device::gcdt_orient2d_finite(vertex_at(a), vertex_at(b), vertex_at(c));
}

/// One planar straight-line graph. The arrays are the caller's.
struct GridInput {
  Points given;
  ChosenGrid chosen;
  GridPoints added;  ///< vertices behind those given, on the grid already
  Constraints constraints;
  Box box{};  ///< around all vertices, if there are any

  std::uint64_t n() const { return given.size() + added.size(); }
  /// Anything if the vertex is outside the grid, which the tiles find out.
  GridPoint at(std::size_t vertex) const;
};

/// The input on a grid; `surveyed` unless it has no vertices.
GridInput place(Points points, Constraints constraints, const ChosenGrid& chosen, const Survey& surveyed);

/// Throws coordinate_outside_grid for the first vertex that is.
void check_inside(const GridInput& input);

/// The largest move of a coordinate; `key` is the greatest gcdt_move_key of all.
double move_of(const GridInput& input, std::uint64_t key);

}  // namespace gcdt::tiles
