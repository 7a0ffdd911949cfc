// SPDX-License-Identifier: Apache-2.0
// What all walks along constraints share on the host: cutting pieces into parts, and launching a kernel with the mesh
// and the history tree as arguments (kernels/constrain/walk.h).
#pragma once

#include <tuple>

#include "mesh/primitives.hpp"
#include "phases/insert.hpp"

namespace gcdt {

/// The mesh as it is after its last insertion and before any flip, with what locates points in it.
struct WalkedMesh {
  const Plan& plan;
  const Vertices& vertices;
  const Mesh& mesh;
  const History& history;

  /// Launches a kernel whose arguments are `first`, then GCDT_WALK_PARAMETERS, then `last`.
  template <class First, class... Last>
  void launch(runtime::Runtime& runtime, const char* program, const char* kernel, runtime::Range range,
              const First& first, const Last&... last) const {
    std::apply(
        [&](const auto&... f) {
          runtime.launch(program, kernel, range, f..., vertices.levels_buffer, history.level, mesh.n, vertices.points,
                         mesh.face_data, mesh.edge_faces, history.begin, history.end, history.top, history.vertex_face,
                         history.nodes, history.shape, last...);
        },
        first);
  }
};

/// Pieces cut into parts of about equal length for load balance (paper, section 6.2).
struct PieceParts {
  cl_uint capacity = 0;             ///< the most parts there may be; their number is begins[pieces]
  runtime::Buffer<cl_uint> begins;  ///< pieces + 1: the first part of each piece
};
PieceParts parts_by_length(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                           const Vertices& vertices, const runtime::Buffer<cl_uint2>& ends, cl_uint pieces);
/// The same by the weights of the pieces, which are the crossings counted when the constraints were cleaned. They are a
/// better measure than lengths, because vertices are seldom spread evenly.
PieceParts parts_by_crossings(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                              const Pieces& pieces);

}  // namespace gcdt
