// SPDX-License-Identifier: Apache-2.0
// The result in canonical order, on the device and on the host.
#pragma once

#include "mesh/mesh.hpp"
#include "mesh/phase.hpp"
#include "mesh/plan.hpp"
#include "mesh/primitives.hpp"

namespace gcdt {

/// The finite triangles in canonical order, in device memory: each starts with its corner of least
/// rank, and they are sorted by the ranks of their first, then second corner.
struct OrderedMesh {
  std::uint32_t triangles = 0;            ///< T
  runtime::Buffer<cl_uint> corners;       ///< 3T vertices, counter-clockwise
  runtime::Buffer<cl_int> neighbours;     ///< 3T: [3t + k] is across from corner k; -1: none
  runtime::Buffer<cl_uchar> constrained;  ///< T: bit k tells of the edge across from corner k
  /// Wall time of finding the finite faces and of writing these arrays from them; `core` of the statistics includes it.
  /// Sorting is not in it, unless one work-item does all of that, or one for each problem (by_one_item.cl, arrange.cl).
  double gather_ms = 0;
};

/// Room for so many triangles, contents undefined.
OrderedMesh make_ordered(runtime::Runtime& runtime, std::size_t triangles);

/// The finite triangles of `mesh`, which is complete. Blocks once, to learn T. Beside the result it needs 24 bytes a
/// face while it sorts, then 8. The scratch of `primitives` is released. If not `canonical`, triangles come in any
/// order, with any corner first; that needs 12 bytes a face. `refs`, unless null, is given the reference of each
/// triangle's first corner in `mesh`; Plan::output is By::all then.
OrderedMesh order_triangles(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan, const Mesh& mesh,
                            const Vertices& vertices, bool canonical = true, runtime::Buffer<cl_uint>* refs = nullptr);

struct ArrangedForest {
  OrderedMesh mesh;                         ///< as of order_triangles()
  runtime::Buffer<cl_uint> first_triangle;  ///< of each problem; P + 1
};

/// The same where Plan::output is By::each, of a forest that was grown and constrained problem by problem: enforcing
/// constraints all at once would exchange faces between problems. Blocks once. Beside the result it needs 12 bytes a
/// face and 8 a vertex.
ArrangedForest arrange_problems(runtime::Runtime& runtime, Primitives& primitives, const Mesh& mesh,
                                const Vertices& vertices);

/// Replaces the corners of `ordered` and the ends of pieces, so far vertices, by input numbers, and returns the
/// representative of each input point. vertices.input_vertex has exactly one element per input point. Afterwards
/// `ordered` no longer holds vertices, as check() wants them. Without pieces it writes the one source offset, 0.
runtime::Buffer<cl_uint> number_by_input(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices,
                                         OrderedMesh& ordered, Pieces& pieces);

/// Replaces the corners of `ordered`, so far vertices, by input numbers.
void number_corners(runtime::Runtime& runtime, const Vertices& vertices, OrderedMesh& ordered);

}  // namespace gcdt
