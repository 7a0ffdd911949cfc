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

/// A vertex of another tile.
struct Foreign {
  std::uint32_t vertex;
  GridPoint point;
};

/// What a tile has beside its own vertices. All numbers are input numbers.
struct Share {
  Array<Constraint> constraints;        ///< none, where devices share them out (share_out.hpp)
  Array<std::uint32_t> constraint_ids;  ///< ascending
  std::uint64_t expected = 0;           ///< where they do, about how many there are
  std::vector<Passage> passages;
  /// Vertices of other tiles where passages end, ascending: the tile's mesh has them, too.
  std::vector<Foreign> foreign;
  std::vector<std::uint32_t> open_ends;  ///< its own vertices where passages end, ascending
};

/// A constraint that no tile was given.
struct OpenConstraint {
  std::uint32_t number;
  Constraint ends;
  std::array<GridPoint, 2> points;  ///< of its ends
};

/// The constraints, shared out. One is of the tile that has the whole box around it; the others are open, and come
/// together in the seam.
struct Partition {
  std::vector<Share> tiles;
  std::vector<OpenConstraint> open;  ///< by ascending number
};

/// What is asked of a constraint.
enum class Role : std::uint8_t {
  any,   ///< a tile's, if it has the whole of it
  wide,  ///< open, and it may be replaced by its route
  out,   ///< left out
};

/// Of the constraints that the process has. The ends of all are vertices. `roles`: by constraint of the process; none
/// if all are `any`.
Partition partition(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles);

/// About how many constraints each tile has.
std::vector<std::uint64_t> expected_constraints(const GridInput& input, const Cuts& cuts);
/// The same as partition() where each tile's device finds the tile's constraints. `open`: what find_open() returned.
Partition partition_open(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles,
                         std::vector<OpenConstraint> open, const std::vector<std::uint64_t>& expected);

/// Whether all ends of the process's constraints are vertices.
bool has_good_ends(const GridInput& input, std::size_t threads);
/// The number of the first end that is no vertex, where 2 c + e is end e of constraint c; if there is none, the
/// greatest number.
std::uint64_t first_bad_end(const GridInput& input);
/// Sorts vertices of other tiles, and keeps each once.
void sort_unique(std::vector<Foreign>& vertices);
void sort_unique(std::vector<std::uint32_t>& numbers);

}  // namespace gcdt::tiles
