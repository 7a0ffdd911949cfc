// SPDX-License-Identifier: Apache-2.0
// What splitting makes of constraints that cross, found in the seam (docs/scale.md, T6).
#pragma once

#include "tiles/join.hpp"

namespace gcdt::tiles {

/// A part of the route of a constraint.
struct Link {
  std::uint32_t owner;  ///< the constraint, by input number
  Constraint ends;      ///< vertices by input number, or that were added
  std::array<GridPoint, 2> points;
};

/// What is added to the input: vertices behind the others, and links in place of the constraints that are routed.
struct Routed {
  GridPoints added;
  std::vector<Constraint> crossing;   ///< by added vertex, as GCDT_ADDED_CROSSINGS
  std::vector<Link> links;            ///< by owner, ascending
  std::vector<std::uint32_t> owners;  ///< the constraints that are routed, ascending
  double largest_move = 0;            ///< in input units
};

/// The seam's problem, split.
struct SplitSeam {
  const Seam& seam;
  const std::vector<SolvedTile>& tiles;
  const std::vector<OpenConstraint>& open;  ///< all that are routed are among these; by ascending number
  const ForestResult& made;
};

/// All but the largest move. `owners`: the constraints that are routed; `n`: vertices before the added ones.
Routed take_routes(std::uint64_t n, const SplitSeam& split, std::vector<std::uint32_t> owners);

/// Constraints with links in place of those that are routed.
struct Replaced {
  explicit Replaced(const GivenConstraints& given, const Routed& routed);
  std::vector<Constraint> ends;
  GivenConstraints constraints;  ///< of `ends`, but for its end points, and its numbers those of the owners
};

}  // namespace gcdt::tiles
