// SPDX-License-Identifier: Apache-2.0
// One problem by many processes, each of which has a part of the input, of the tiles, and of the result (docs/scale.md,
// "Several machines").
#pragma once

#include "tiles/tiled.hpp"
#include "tiles/tiled_run.hpp"

namespace gcdt::tiles {

/// What a rank was given: vertices and constraints that follow each other, those of begin_of_part().
struct InputBlock {
  Array<std::array<double, 2>> vertices;
  Array<Constraint> constraints;
  std::uint64_t all_vertices = 0, all_constraints = 0;
};

/// Vertices of the rank's tiles, by ascending input number.
struct OwnVertices {
  Array<std::array<double, 2>> vertices;
  Array<std::uint32_t> numbers;
};

/// What a rank has in the end.
struct RankResult {
  OwnVertices own;
  ResultPart part;
  Cuts cuts{{}};
  ChosenGrid chosen;
  double ms_exchange = 0;  ///< of ms_share: until each rank had the vertices of its tiles
};

/// The cuts, from what the rank was given. All ranks must find the same, a multiple of their number.
using Cut = std::function<Cuts(const GridInput& block)>;

/// Solves the problem of all ranks. Of the options, domains and regions are for gather_result(). Throws what
/// gcdt::triangulate() does: what is said of the input, all ranks throw; what is said of a device, its rank.
RankResult triangulate_rank(DevicePool& pool, Team& team, InputBlock block, const Options& options, std::size_t tiles,
                            const Cut& cut);

/// At the first rank the whole result, with the bytes that one device would give; at others nothing. `points` and
/// `constraints` are the whole input, and the first rank's.
ForestResult gather_result(Team& team, RankResult& rank, Points points, Constraints constraints,
                           const Options& options);

}  // namespace gcdt::tiles
