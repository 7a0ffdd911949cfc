// SPDX-License-Identifier: Apache-2.0
// Phase 3 on the host: Delaunay flips until no unconstrained edge is illegal (kernels/flip/flip.cl).
#pragma once

#include "mesh/phase.hpp"

namespace gcdt {

struct FlipResult {
  std::uint64_t rounds = 0;  ///< of problems by work-groups of their own: the most of each launch, added up
  std::uint64_t flips = 0;
};

/// Makes the mesh of the first `vertices_in_mesh` finite vertices (constrained) Delaunay with the tie rule.
/// The mesh must be valid. The counters are zero, or as insert_level left them. Throws round_limit.
FlipResult flip(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh, Ticker& ticker);

/// The same where only the edges of the list `lists.first` may be illegal, all of them marked as queued: as many as
/// the counters that were just read say in list_test[0]. What the mesh knows of claims is right, and stays so.
FlipResult flip_queued(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                       const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh, Ticker& ticker);

/// The same where these are few, and the counters have not been read since they were zero: one work-group does some
/// rounds, and nobody reads what they did. The mesh may have fewer vertices than `vertices_in_mesh`. After:
/// list_test[0] is 0 if no edge is left.
void flip_few_unread(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                     const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh);

/// What flip_few_unread has left, as the counters say that were just read. Its rounds and flips are in the result.
FlipResult flip_left(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                     const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh, Ticker& ticker);

}  // namespace gcdt
