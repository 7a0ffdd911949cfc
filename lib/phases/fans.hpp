// SPDX-License-Identifier: Apache-2.0
// The faces around vertices that have many, in order (kernels/constrain/fan.h).
#pragma once

#include "mesh/phase.hpp"
#include "mesh/primitives.hpp"
#include "phases/output.hpp"

namespace gcdt {

/// Made when a walk has taken too long, and valid until the mesh changes. Most inputs need none.
struct Fans {
  runtime::Buffer<cl_uint> begins;  ///< n + 1: the fan of vertex v is [begins[v], begins[v + 1])
  runtime::Buffer<cl_uint2> faces;  ///< a face, and its corner after v
  bool made = false;
};

/// Fans that are not made; kernels get their buffers all the same.
Fans no_fans(runtime::Runtime& runtime);

/// The fans of all vertices with GCDT_FAN_LEAST faces and more. Their elements are at most 2.3 n: edges between such
/// vertices and others form a planar bipartite graph, so there are at most two a vertex, and the few among themselves
/// three each. Takes 12 bytes a vertex and 20 an element. Blocks. Sets counters' failure bits if faces around a vertex
/// form no ring.
Fans make_fans(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices, const Mesh& mesh,
               PhaseCounters& counters);

/// The same in a finished mesh that covers the convex hull; corners are numbers of input vertices (`by_input`) or of
/// vertices. Fans of vertices on the hull are open: they begin with the face that none comes before.
Fans make_result_fans(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices,
                      const OrderedMesh& mesh, bool by_input, PhaseCounters& counters);

}  // namespace gcdt
