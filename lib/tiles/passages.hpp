// SPDX-License-Identifier: Apache-2.0
// Walks along constraints that are not in a mesh.
#pragma once

#include "tiles/tile.hpp"

namespace gcdt::tiles {

/// A mesh on the host. The arrays must outlive the walks.
struct WalkedTile {
  Span<Triangle> triangles;
  Span<Neighbours> neighbours;
  Span<GridPoint> points;
};

/// All triangles that a passage crosses inside or runs along an edge of; of a wide one, also those that have a point
/// less than one cell away from it on both axes. Ascending. Passages end in vertices of the mesh, and may
/// touch others.
std::vector<std::uint32_t> passed_by(const WalkedTile& mesh, const std::vector<Passage>& passages);

}  // namespace gcdt::tiles
