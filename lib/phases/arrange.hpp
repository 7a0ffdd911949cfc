// SPDX-License-Identifier: Apache-2.0
// The canonical order of a forest that was grown and constrained problem by problem (kernels/output/arrange.cl).
#pragma once

#include "phases/output.hpp"

namespace gcdt {

struct ArrangedForest {
  OrderedMesh mesh;                         ///< as of order_triangles()
  runtime::Buffer<cl_uint> first_triangle;  ///< of each problem; P + 1
};

/// As order_triangles(), where Plan::output is By::each: constraints, if any, were enforced problem by problem; all at
/// once would exchange faces between problems. Blocks once. Beside the result it needs 12 bytes a face and 8 a vertex.
ArrangedForest arrange_problems(runtime::Runtime& runtime, Primitives& primitives, const Mesh& mesh,
                                const Vertices& vertices);

}  // namespace gcdt
