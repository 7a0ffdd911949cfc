// SPDX-License-Identifier: Apache-2.0
// What a refinement may split, and what it leaves for another one (docs/refinement.md).
#pragma once

#include "mesh/mesh.hpp"

namespace gcdt {

/// The pieces of constraints, and edges of the hull and beside an adopted mesh that are on none, of a mesh that is to
/// be refined.
struct Subsegments {
  std::uint32_t count = 0;               ///< pieces; those with sources come first
  runtime::Buffer<cl_uint2> pieces;      ///< their ends; there may be room for more
  runtime::Buffer<cl_uint> edge_pieces;  ///< by edge: its piece, or GCDT_NONE
  runtime::Buffer<cl_uint> sharp;        ///< by piece, as refine_sharp finds it; not allocated: to be found
  /// By vertex: in w the piece that an earlier refinement put it on, or GCDT_NONE. Not allocated: there was none.
  runtime::Buffer<cl_uint4> origins;
};

/// The pieces as they were before the first of a row of refinements, and the links that they are now. Bounds hold for
/// pieces, so one that goes on from the mesh of another needs them. Vertices are those of the mesh.
struct Chains {
  Pieces pieces;            ///< with sources; `ends` has those without behind them
  std::uint32_t count = 0;  ///< of both
  runtime::Buffer<cl_uint> sharp;
  runtime::Buffer<cl_uint2> links;       ///< sorted as pieces are
  runtime::Buffer<cl_uint> link_pieces;  ///< by link

  bool there() const { return links.allocated(); }
};

/// Of a mesh that was not refined, which is constrained where it is on `pieces`.
Subsegments find_subsegments(runtime::Runtime& runtime, const Vertices& vertices, Mesh& mesh, const Pieces& pieces);

/// Of a mesh that covers the hull and has all edges of an adopted one, of which `kept` says by triangle which it has:
/// face t is triangle t. Edges on pieces and around what is kept are constrained then, and no others.
Subsegments find_adopted_subsegments(runtime::Runtime& runtime, const Vertices& vertices, Mesh& mesh,
                                     const Pieces& pieces, const runtime::Buffer<cl_uint>& refs,
                                     const runtime::Buffer<cl_int>& kept);

/// Of a mesh that was refined. All links are constrained then.
Subsegments find_subsegments(runtime::Runtime& runtime, const Vertices& vertices, Mesh& mesh, const Chains& chains);

}  // namespace gcdt
