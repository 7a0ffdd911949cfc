// SPDX-License-Identifier: Apache-2.0
// Phases 1 and 3 on the host where work-items are threads' loops (kernels/insert/grow.cl): vertices go into a Delaunay
// mesh one after the other, many such sequences side by side.
#pragma once

#include "phases/flip.hpp"

namespace gcdt {

struct GrowResult {
  std::uint64_t rounds = 0;  ///< launches that insert
  std::uint64_t edge_splits = 0, steps = 0;
  FlipResult flips;
};

/// Makes the mesh, whatever it holds, that of the symbolic triangles and of all vertices below `end`, the first of a
/// level. After: the mesh is Delaunay, and no edge is constrained. Throws round_limit.
GrowResult grow(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                const WorkLists& lists, PhaseCounters& counters, std::uint32_t end, Ticker& ticker);

/// As flip(): makes a valid mesh of all vertices (constrained) Delaunay.
FlipResult grow_flip(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                     const WorkLists& lists, PhaseCounters& counters, Ticker& ticker);

}  // namespace gcdt
