// SPDX-License-Identifier: Apache-2.0
// The part of a tile's mesh that open constraints may pass through: it alone comes to the host.
#pragma once

#include "mesh/primitives.hpp"
#include "phases/output.hpp"
#include "tiles/final.hpp"
#include "tiles/partition.hpp"

namespace gcdt::tiles {

/// Triangles that have a point near a passage, and no few others; and their corners. Numbered among themselves, in the
/// order of the mesh.
struct NearMesh {
  Array<Triangle> triangles;
  Array<Neighbours> neighbours;  ///< -1: none that is near
  GridPoints points;
  std::vector<Passage> passages;       ///< that end in these vertices
  std::vector<std::uint32_t> numbers;  ///< of the triangles, in the mesh
};

/// `passages` end in vertices of the mesh that triangles have; `points`: of the mesh's vertices. All triangles that
/// passed_by() would find in the whole mesh, or turn around on its way, are there. Throws check_failed.
NearMesh near_mesh(runtime::Runtime& runtime, Primitives& primitives, const OrderedMesh& mesh,
                   const runtime::Buffer<cl_int2>& points, const std::vector<Passage>& passages);

}  // namespace gcdt::tiles
