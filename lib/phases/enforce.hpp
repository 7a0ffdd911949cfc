// SPDX-License-Identifier: Apache-2.0
// Phase 2 on the host for batches of small problems where work-items are threads' loops (kernels/constrain/enforce.cl):
// each problem's constraints are cleaned and enforced by one work-item, one after the other.
#pragma once

#include "batch/forest_order.hpp"
#include "phases/constrain.hpp"

namespace gcdt {

/// Whether a forest is for enforce_problems(): problem_by_problem(), and none so large that it matters that a
/// constraint begins with a look around its first vertex, whatever the degree.
bool enforces_by_problem(const runtime::Runtime& runtime, const Vertices& vertices);

struct EnforceResult {
  bool crossing = false;  ///< constraints of some problem cross: the mesh is void, and nothing else is here
  Pieces pieces;          ///< without weights
  std::uint64_t zero_length = 0, hits = 0, existing_edges = 0, chain_vertices = 0, crossed_pairs = 0, flips = 0;
};

/// Makes all constraints, pairs of input points none of which is out of range, edges of a Delaunay mesh with
/// enforces_by_problem(), which then is constrained Delaunay.
EnforceResult enforce_problems(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices,
                               const Mesh& mesh, const ProblemRanges& ranges,
                               const runtime::Buffer<cl_uint2>& constraints, PhaseCounters& counters);

}  // namespace gcdt
