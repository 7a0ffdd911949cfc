// SPDX-License-Identifier: Apache-2.0
// Walks along constraints that are not in a mesh.
#pragma once

#include <functional>

#include "tiles/tile_mesh.hpp"

namespace gcdt::tiles {

/// Calls use(triangle) for all triangles that a passage crosses inside or runs along an edge of; of a wide one, also
/// for those that have a point less than one cell away from it on both axes. For some more than once. Passages end in
/// vertices of the mesh, and may touch others.
void for_passed_triangles(const ProblemMesh& mesh, const std::vector<GridPoint>& points,
                          const std::vector<Passage>& passages, const std::function<void(std::uint32_t)>& use);

}  // namespace gcdt::tiles
