// SPDX-License-Identifier: Apache-2.0
// What splitting makes of constraints that cross, found in the seam (docs/scale.md, T6).
#pragma once

#include "tiles/join.hpp"

namespace gcdt::tiles {

/// What is added to the input: vertices behind the others, and links in place of the constraints that are routed.
struct Routed {
  GridPoints added;
  std::vector<Constraint> constraints, crossing;  ///< crossing: by added vertex, as GCDT_ADDED_CROSSINGS
  std::vector<std::uint32_t> owners;              ///< of the constraints: input numbers, ascending
  std::uint64_t count = 0;                        ///< of routed constraints
  double largest_move = 0;                        ///< in input units
};

/// The seam's problem, split.
struct SplitSeam {
  const Seam& seam;
  const std::vector<SolvedTile>& tiles;
  const ForestResult& made;
};

/// All but the largest move. `is_routed`: by input constraint.
Routed take_routes(const GridInput& input, const SplitSeam& split, const std::vector<bool>& is_routed);

}  // namespace gcdt::tiles
