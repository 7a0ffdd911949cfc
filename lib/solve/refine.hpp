// SPDX-License-Identifier: Apache-2.0
// Quality refinement as a step of a run (docs/refinement.md).
#pragma once

#include "solve/run.hpp"

namespace gcdt {

/// Throws invalid_argument for a refinement that makes no sense, or that cannot be combined with `options`, of an input
/// of `vertices`. The message names the member.
void check_refinement(const Refinement& wanted, const Options& options, std::uint64_t vertices);

/// Says in the log and as a note if the grid is too coarse for what is wanted. Called when the grid is known.
void tell_coarse_grid(Run& run);

struct TriangleCounts {
  std::uint32_t kept = 0;  ///< of the domain, at least one
  std::uint32_t hull = 0;
};

/// Takes the notes of a refinement away.
void forget_notes(Statistics& statistics);

/// Refines the triangles of the domain, which the run's mesh has among others: run.result.kept, if that is allocated,
/// has the place of each triangle of the hull among them. `refs`: the face of each triangle of the hull. The run's
/// pieces are those of `subsegments` that have sources. Changes all that the run has of mesh, vertices, pieces and
/// domain. Returns the triangles of the domain.
OrderedMesh refine(Run& run, TriangleCounts counts, runtime::Buffer<cl_uint> refs, Subsegments subsegments);

}  // namespace gcdt
