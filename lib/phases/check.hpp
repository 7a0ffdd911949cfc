// SPDX-License-Identifier: Apache-2.0
// The device's proof that a result is what docs/contract.md, 6, promises.
#pragma once

#include "check/check.h"
#include "mesh/mesh.hpp"
#include "phases/output.hpp"

namespace gcdt {

/// Proves that `ordered` is the constrained Delaunay triangulation of `vertices` under `pieces`; the
/// proof stands in kernels/check/check.cl. Corners are vertices still (before read_triangulation). Takes the
/// points, their order and the pieces as given, and nothing of the mesh. Reads back once, without
/// fault found. Throws check_failed naming the first fault; indices: the input numbers of the vertices
/// at fault (a triangle's three, an edge's or piece's two, or one), none where there are no such.
void check(runtime::Runtime& runtime, const Plan& plan, const OrderedMesh& ordered, const Vertices& vertices,
           const Pieces& pieces);

/// The same of many problems in one mesh, problem by problem. `first_triangle`, `first_piece`: where each one's begin,
/// P + 1 elements. Numbers in messages count through the run.
void check_problems(runtime::Runtime& runtime, const Plan& plan, const OrderedMesh& ordered, const Vertices& vertices,
                    const Pieces& pieces, const runtime::Buffer<cl_uint>& first_triangle,
                    const runtime::Buffer<cl_uint>& first_piece);

}  // namespace gcdt
