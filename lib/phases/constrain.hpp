// SPDX-License-Identifier: Apache-2.0
// Phase 2 on the host: all constraints at once (kernels/constrain/constrain.cl, retriangulate.cl, stitch.cl; paper,
// section 6).
#pragma once

#include <array>

#include "phases/walk.hpp"

namespace gcdt {

struct ConstrainResult {
  /// Failure bits (kernels/common/shared.h). If not 0, two pieces cross or the device computes wrongly; find_crossings
  /// (lib/phases/crossings.hpp) says which.
  std::uint32_t failed = 0;
  /// Whether the mesh was changed before the failure was seen. If not, only its claim words were.
  bool mesh_changed = false;
  std::uint64_t left_out = 0;  ///< of the existing edges: were marked and no more
  std::uint64_t existing_edges = 0, walked = 0, chain_vertices = 0, holes = 0, symbolic_chain_vertices = 0;
  std::uint64_t crossed_pairs = 0, steps = 0;
  std::array<std::uint32_t, 4> pairs_of_two = {};  ///< by intersection_case() of constrain.cl
};

/// Makes every piece an edge of the mesh and marks it. The mesh has all vertices, and has not been flipped since
/// `history` was made; afterwards it is proved to be a valid triangulation with every piece as an edge (stitch_prove,
/// stitch_mark), or `failed` is not 0; so pieces that cross never pass. The history is released after the last walk
/// (before `mesh_changed` is set). Pieces that are edges already, as cleaning has found, are only marked where they are
/// many (Plan::least_existing). `pieces` are as they were afterwards.
ConstrainResult constrain(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan, const Vertices& vertices,
                          Mesh& mesh, History& history, Pieces& pieces, PhaseCounters& counters);

}  // namespace gcdt
