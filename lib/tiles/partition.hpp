// SPDX-License-Identifier: Apache-2.0
// Which constraints are whose. Vertices are a tile's by their codes, which the tile's device finds by itself.
#pragma once

#include "tiles/cuts.hpp"

namespace gcdt::tiles {

/// A constraint that is no tile's, since it may leave every tile, and may pass through one.
struct Passage {
  std::uint32_t from, to;  ///< its ends
  bool wide;               ///< it may be replaced by its route, which is near it (docs/splitting.md, S2)
};

/// What a tile has beside its own vertices. All numbers are input numbers.
struct Share {
  Array<Constraint> constraints;
  Array<std::uint32_t> constraint_ids;  ///< ascending
  std::vector<Passage> passages;
  /// Vertices of other tiles where passages end, ascending: the tile's mesh has them, too.
  std::vector<std::uint32_t> foreign;
  std::vector<std::uint32_t> open_ends;  ///< its own vertices where passages end, ascending
};

/// The constraints, shared out. One is of the tile that has the whole box around it; the others are open, and come
/// together in the seam.
struct Partition {
  std::vector<Share> tiles;
  std::vector<std::uint32_t> open;  ///< ascending
};

/// What is asked of a constraint.
enum class Role : std::uint8_t {
  any,   ///< a tile's, if it has the whole of it
  wide,  ///< open, and it may be replaced by its route
  out,   ///< left out
};

/// The ends of all constraints are vertices. `roles`: by constraint; none if all are `any`.
Partition partition(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles);

/// Throws index_out_of_range as cleaning does; before that, as order() does, coordinate_outside_grid.
void check_ends(const GridInput& input);

}  // namespace gcdt::tiles
