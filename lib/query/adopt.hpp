// SPDX-License-Identifier: Apache-2.0
// A result made of a mesh that is there already (kernels/query/adopt.cl).
#pragma once

#include "phases/triangulation.hpp"

namespace gcdt {

using Triangles = Span<std::array<std::uint32_t, 3>>;

/// The distinct edges of `triangles`, the lesser end first, ascending. Throws invalid_argument for a corner that is not
/// below `vertices`; indices {triangle, corner}.
std::vector<Constraint> edges_of(Triangles triangles, std::uint64_t vertices);

/// What is wrong with a mesh whose edges, numbered after the `constraints` that are to be flagged, cross or are
/// crossed: `crossing` says so of constraints. Other errors come back as they are.
Error mesh_error(const Error& crossing, Constraints constraints, Span<Constraint> edges);

/// The result that has `triangles`, with their numbers and first corners, out of `whole`: the triangulation of the same
/// vertices under `constraints` constraints and, after them, all edges of the triangles. Throws check_failed, with the
/// triangle, for one that is not counter-clockwise on the grid, has a vertex inside or on its border, overlaps others,
/// or is there twice.
DeviceTriangulation adopt(runtime::Runtime& runtime, Primitives& primitives, DeviceTriangulation whole,
                          Triangles triangles, std::uint32_t constraints);

}  // namespace gcdt
