// SPDX-License-Identifier: Apache-2.0
// The mesh of a result that is there, as the phases work on it (kernels/refine/relink.cl).
#pragma once

#include "phases/output.hpp"

namespace gcdt {

struct RelinkedMesh {
  Mesh mesh;                      ///< that of which `ordered` was made, but for the numbers of faces and edges
  runtime::Buffer<cl_uint> refs;  ///< by triangle: the reference of its first corner in `mesh`
};

/// `ordered` has all triangles of the hull of `vertices`, at least one, in any order, with corners as input numbers.
/// Beside the result it needs 24 bytes a triangle. The scratch of `primitives` is released.
RelinkedMesh relink(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices,
                    const OrderedMesh& ordered);

}  // namespace gcdt
