// SPDX-License-Identifier: Apache-2.0
// Where a plane is cut into tiles.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tiles/placed.hpp"
#include "tiles/team.hpp"

namespace gcdt::tiles {

/// Tiles are ranges of the Z-order: tile t has the grid points with codes from begin(t) up to begin(t + 1). The code of
/// a point grows with either coordinate, so those of a box lie between the codes of its least and its greatest corner:
/// if both are of one tile, the whole box is (docs/scale.md, T1). And the vertices of a tile follow each other in the
/// canonical order, so that the triangles of a result come tile by tile.
class Cuts {
 public:
  /// The first code of each tile but the first, ascending; equal ones make tiles without points.
  explicit Cuts(std::vector<std::uint64_t> first_codes) : first_codes_(std::move(first_codes)) {}

  std::size_t tiles() const { return first_codes_.size() + 1; }
  const std::vector<std::uint64_t>& first_codes() const { return first_codes_; }  ///< of each tile but the first
  std::size_t tile_of(std::uint64_t code) const;
  /// The first and the last code of a tile. A tile without points may have none in between.
  std::array<std::uint64_t, 2> codes_of(std::size_t tile) const;
  /// The least box that has the tile's grid points; none if it has none.
  std::optional<Box> box_of(std::size_t tile) const;
  /// The first and the last tile that points of the box may be of.
  std::array<std::size_t, 2> tiles_of(const Box& box) const;

 private:
  std::vector<std::uint64_t> first_codes_;
};

/// How many vertices of a sample a cut may have more or fewer on one side than an even one would.
inline std::size_t slack_of_cut(std::size_t sample, std::size_t tiles) { return sample / tiles / 64; }

/// Cuts that give each of so many tiles about as many of the vertices, from a sample of them: the same for all ranks,
/// and for any number of them. Those given to a rank follow each other. Of the codes within the slack a cut is the one
/// that ends in most zeros: then the tiles on both sides are of few rectangles, so that their borders are short, and a
/// tile has no vertex far before a long straight border, from which thousands of triangles would reach to it.
Cuts even_cuts(const GridInput& input, std::size_t tiles, Team& team);

}  // namespace gcdt::tiles
