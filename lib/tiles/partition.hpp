// SPDX-License-Identifier: Apache-2.0
// Which tile has which vertices and constraints.
#pragma once

#include "tiles/cuts.hpp"

namespace gcdt::tiles {

/// The input on its grid. Arrays are the caller's.
struct GridInput {
  const std::vector<GridPoint>& points;
  Constraints constraints;
};

/// A constraint that is no tile's, since it may leave every tile, as a tile's mesh sees it.
struct Passage {
  std::uint32_t from, to;  ///< its ends, vertices of the tile
  bool wide;               ///< it may be replaced by its route, which is near it (docs/splitting.md, S2)
};

/// What a tile's call is given. Vertices have the tile's own first, in order of their input numbers, then those of
/// other tiles where constraints end that may pass through.
struct Tile {
  std::vector<GridPoint> points;
  std::vector<std::uint32_t> ids;  ///< input numbers
  std::uint32_t own = 0;           ///< so many vertices are the tile's own
  std::vector<Constraint> constraints;
  std::vector<std::uint32_t> constraint_ids;  ///< input numbers, ascending
  std::vector<Passage> passages;
  Box box{};  ///< around its own vertices, if there are any
};

/// All of the input, shared out. A constraint is of the tile that has the whole box around it; the others are open, and
/// come together in the seam.
struct Partition {
  std::vector<Tile> tiles;
  std::vector<std::uint32_t> open;     ///< input numbers, ascending
  std::vector<std::uint16_t> tile_of;  ///< by input vertex
  std::vector<std::uint32_t> place;    ///< by input vertex: its number in its tile
  Box box{};                           ///< around all vertices
};

/// What is asked of a constraint.
enum class Role : std::uint8_t {
  any,   ///< a tile's, if it has the whole of it
  wide,  ///< open, and it may be replaced by its route
  out,   ///< left out
};

/// Throws index_out_of_range as cleaning does. `roles`: by constraint; none if all are `any`.
Partition partition(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles);

}  // namespace gcdt::tiles
