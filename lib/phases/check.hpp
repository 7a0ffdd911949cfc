// SPDX-License-Identifier: Apache-2.0
// The device's proof that a result is what docs/contract.md, 6, promises.
#pragma once

#include "mesh/mesh.hpp"
#include "mesh/primitives.hpp"
#include "phases/output.hpp"

namespace gcdt {

/// Proves that `ordered` is the constrained Delaunay triangulation of `vertices` under `pieces`; the
/// proof stands in kernels/check/check.cl. Corners are vertices still (before read_triangulation). Takes the
/// points, their order and the pieces as given, and nothing of the mesh. Reads back once, without
/// fault found. Throws check_failed naming the first fault; indices: the input numbers of the vertices
/// at fault (a triangle's three, an edge's or piece's two, or one), none where there are no such.
void check(runtime::Runtime& runtime, Primitives& primitives, const OrderedMesh& ordered, const Vertices& vertices,
           const Pieces& pieces);

}  // namespace gcdt
