// SPDX-License-Identifier: Apache-2.0
// Phase 2 on the host for small problems, those of a batch or one by itself, where work-items are threads' loops
// (kernels/constrain/enforce.cl): each problem's constraints are cleaned and enforced by one work-item, one after the
// other.
#pragma once

#include <vector>

#include "phases/constrain.hpp"

namespace gcdt {

struct EnforceResult {
  bool wrong_index = false;  ///< an end is no input vertex: nothing else here counts
  /// By constraint: 1 if it crosses an earlier one that was enforced, and was left out. Empty if there is none.
  std::vector<cl_uint> crosses;
  Pieces pieces;  ///< without weights
  std::uint64_t zero_length = 0, hits = 0, existing_edges = 0, chain_vertices = 0, crossed_pairs = 0, flips = 0;
};

/// Makes constraints, pairs of input points, edges of a Delaunay mesh that then is constrained Delaunay
/// (Plan::constraints: By::each, By::one). Each problem's are taken in their order, and one that crosses an earlier one
/// is left out; unless `past_crossings`, all that follow in the problem, too. `first_constraint`: where each problem's
/// begin. Throws check_failed if a walk left the mesh.
EnforceResult enforce_problems(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices, Mesh& mesh,
                               const runtime::Buffer<cl_uint>& first_constraint,
                               const runtime::Buffer<cl_uint2>& constraints, bool past_crossings,
                               PhaseCounters& counters);

}  // namespace gcdt
