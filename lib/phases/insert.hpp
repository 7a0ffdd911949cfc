// SPDX-License-Identifier: Apache-2.0
// Phase 1 on the host: vertex insertion, level by level (kernels/insert/insert.cl).
#pragma once

#include "phases/fans.hpp"
#include "phases/gates.hpp"

namespace gcdt {

/// The history tree of the last level inserted and the top layer that it hangs from (kernels/common/history.h).
/// Valid for location until the mesh is flipped.
struct History {
  cl_uint level = 0, begin = 0, end = 0;
  runtime::Buffer<cl_uint4> top, nodes;
  runtime::Buffer<cl_uint> vertex_face, shape;
  Fans fans;    ///< of the mesh with the level in it
  Gates gates;  ///< of the same
};

/// Buffers for the largest level; sizes in `required_bytes`.
History make_history(runtime::Runtime& runtime, const device::Levels& levels, std::uint32_t roots = 1);

/// A history without splits, of a mesh with all vertices, Delaunay or not: all of it is top layer. Zeroes the counters.
History freeze_all(runtime::Runtime& runtime, const Vertices& vertices, Mesh& mesh, PhaseCounters& counters);

/// Makes the mesh hold the symbolic triangles alone, no edge constrained.
void insert_root(runtime::Runtime& runtime, const Vertices& vertices, Mesh& mesh);

/// Inserts the vertices of `level` into the mesh of the levels before, which must be Delaunay.
/// After: every vertex of the level is in the mesh, which is a valid triangulation, and `history` locates
/// points in it if it is to be `located_in`. Zeroes the counters, then adds to edge_splits, steps, history_depth and
/// rounds; those of flips stay zero. Returns the number of rounds. Throws round_limit.
std::uint64_t insert_level(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                           History& history, bool located_in, const WorkLists& lists, PhaseCounters& counters,
                           unsigned level, Ticker& ticker);

}  // namespace gcdt
