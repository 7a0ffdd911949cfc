// SPDX-License-Identifier: Apache-2.0
// What all walks along constraints share on the host: cutting pieces into parts, and finding where these begin
// (kernels/constrain/walk.h).
#pragma once

#include "mesh/primitives.hpp"
#include "phases/insert.hpp"

namespace gcdt {

/// The mesh as it is after its last insertion and before any flip, with what locates points in it.
struct WalkedMesh {
  const Plan& plan;
  const Vertices& vertices;
  const Mesh& mesh;
  History& history;  ///< a walk may make its fans
};

/// Pieces cut into parts of about equal length for load balance (paper, section 6.2).
struct PieceParts {
  cl_uint pool = 0;                 ///< parts at most beyond one a piece, and those that the piece had before
  cl_uint capacity = 0;             ///< the most parts there may be; their number is begins[pieces]
  runtime::Buffer<cl_uint> begins;  ///< pieces + 1: the first part of each piece
};
/// By length along the longer axis; `length`: of all pieces, and `crossings`: faces that they are expected to cross.
PieceParts parts_by_length(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                           const runtime::Buffer<cl_uint>& lengths, cl_uint pieces, std::uint64_t length,
                           std::uint64_t crossings);
/// The same of pieces whose lengths nobody knows. Blocks.
PieceParts parts_by_length(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                           const Vertices& vertices, const runtime::Buffer<cl_uint2>& ends, cl_uint pieces);
/// The sum of the weights, or lengths, of pieces. Blocks.
std::uint64_t total_weight(runtime::Runtime& runtime, const runtime::Buffer<cl_uint>& weights, cl_uint pieces);
/// The faces that constraints of this total length cross on an evenly filled mesh.
std::uint64_t expected_crossings(const Vertices& vertices, std::uint64_t length);
/// The same by the weights of the pieces, which are the crossings counted when the constraints were cleaned. They are a
/// better measure than lengths, because vertices are seldom spread evenly.
PieceParts parts_by_crossings(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                              const Pieces& pieces);

/// What a walk along each part begins with.
struct PartBegins {
  runtime::Buffer<cl_int4> lines;   ///< by piece: its ends as points, in the order in which it is walked
  runtime::Buffer<cl_uint> pieces;  ///< by part
  runtime::Buffer<cl_uint> faces;   ///< by part: where it begins, or GCDT_NONE if it was not found
};

/// Finds the first faces of all parts. `before`, if any, says where cleaning's walks began. A hasty search gives up
/// where fans might help and are not made. Adds to counters: steps.
PartBegins find_first_faces(runtime::Runtime& runtime, const WalkedMesh& walked, const runtime::Buffer<cl_uint2>& ends,
                            cl_uint pieces, const PieceParts& parts, const WalkedPieces* before, bool hasty,
                            PhaseCounters& counters);
/// Which part each work-item walks, where lanes would wait long for others (Plan::crossings_ordered). Of none: its own.
runtime::Buffer<cl_uint> order_parts(runtime::Runtime& runtime, const Plan& plan, const Pieces& pieces,
                                     const PieceParts& parts, const PartBegins& begins);
/// Finds those that a hasty search has not found.
void find_missing_faces(runtime::Runtime& runtime, const WalkedMesh& walked, const runtime::Buffer<cl_uint2>& ends,
                        cl_uint pieces, const PieceParts& parts, PartBegins& begins, PhaseCounters& counters);

}  // namespace gcdt
