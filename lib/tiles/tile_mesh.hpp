// SPDX-License-Identifier: Apache-2.0
// What a tile's call has made, and which of it is part of the whole result.
#pragma once

#include "batch/device_pool.hpp"
#include "tiles/partition.hpp"

namespace gcdt::tiles {

using Triangle = std::array<std::uint32_t, 3>;
using Neighbours = std::array<std::int32_t, 3>;

/// A view of one problem's arrays in a pool's result, which must outlive it. Numbers are the problem's.
struct ProblemMesh {
  ProblemMesh() = default;
  ProblemMesh(const PoolResult& made, std::size_t problem);

  Span<Triangle> triangles;
  Span<Neighbours> neighbours;
  Span<std::uint8_t> constrained;
  Span<std::uint32_t> representative;
  Span<Constraint> pieces;
  Span<std::uint32_t> source_offsets, sources, dropped;
  Statistics statistics;  ///< of the run that made it
};

/// The number of the piece between two vertices; pieces are in the order of their ends' codes. Throws check_failed if
/// there is none.
std::uint32_t piece_between(Span<Constraint> pieces, const std::vector<GridPoint>& points, std::uint32_t u,
                            std::uint32_t v);

/// Which triangles of a tile's mesh are final, that is of the whole result, too: 1 for each that is. A triangle is if
/// the box around its circle, cut to the box of all vertices, is of the tile; and if no passage meets it but in
/// corners (docs/scale.md, T2).
std::vector<std::uint8_t> final_triangles(const ProblemMesh& mesh, const Partition& all, std::size_t tile,
                                          const Cuts& cuts);

}  // namespace gcdt::tiles
