// SPDX-License-Identifier: Apache-2.0
// Vertices go from the ranks that were given them to those that need them.
#pragma once

#include "tiles/ranks.hpp"

namespace gcdt::tiles {

/// Of the vertices that all ranks were given, those of the rank's tiles.
OwnVertices exchange_vertices(Team& team, const GridInput& block, const Cuts& cuts);

/// Where the ends of the rank's constraints are on the grid.
Array<std::array<GridPoint, 2>> end_points(Team& team, const GridInput& block);

/// The coordinates, as they were given, of vertices that are of any rank's tiles.
struct Wanted {
  std::uint32_t number;
  GridPoint point;
};
Array<std::array<double, 2>> coordinates_of(Team& team, const RankResult& rank, const std::vector<Wanted>& wanted);

}  // namespace gcdt::tiles
