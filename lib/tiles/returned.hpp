// SPDX-License-Identifier: Apache-2.0
// What comes back from the seam to the tiles: where their triangles are in the result, and what stands between them.
#pragma once

#include "tiles/seam.hpp"

namespace gcdt::tiles {

/// All that a problem's result is made of, at the rank that has the seam. Every part must outlive what is made of it.
/// Tiles of other ranks are as gather_tiles() leaves them.
struct Solved {
  const std::vector<SolvedTile>& tiles;
  const Seam& seam;
  const SolvedSeam& between;
};

/// The place of a final triangle in the result. `before`: what write_tile() returned.
inline std::uint32_t place_of_final(const std::vector<std::uint32_t>& before, std::uint32_t first,
                                    std::uint32_t triangle) {
  const auto inserted = std::upper_bound(before.begin(), before.end(), triangle) - before.begin();
  return first + triangle + static_cast<std::uint32_t>(inserted);
}

/// Where triangles are in the result. Those of a tile come before those of the next; a triangle of the seam is among
/// those of the tile that has its first vertex (docs/scale.md, T5).
class Order {
 public:
  explicit Order(const Solved& solved);

  std::uint32_t triangles() const { return firsts_.back(); }
  /// What makes the keys asks this object.
  TilePlaces places(std::size_t tile) const;
  std::uint32_t of_seam(std::size_t tile) const { return firsts_of_seam_[tile + 1] - firsts_of_seam_[tile]; }
  /// What write_tile() returns.
  void set_before(std::size_t tile, std::vector<std::uint32_t> before) { before_[tile] = std::move(before); }
  const std::vector<std::uint32_t>& before(std::size_t tile) const { return before_[tile]; }
  // From here on when all tiles are set.
  std::uint32_t place_of_final(std::size_t tile, std::uint32_t triangle) const {
    return tiles::place_of_final(before_[tile], firsts_[tile], triangle);
  }
  std::uint32_t place_in_seam(std::uint32_t triangle) const;
  /// The tile that has a triangle of the seam, and its number among those there.
  std::pair<std::size_t, std::uint32_t> of_tile(std::uint32_t triangle) const;

 private:
  std::uint32_t rank_of(std::uint32_t triangle) const;
  std::array<std::uint64_t, 2> key_of(std::uint32_t triangle) const;

  const Solved solved_;
  std::vector<std::uint32_t> firsts_;               ///< of each tile, and of all
  std::vector<std::vector<std::uint32_t>> before_;  ///< final ones before each of those
  // The seam's triangles are in the order of their first vertices, and so come tile by tile.
  static constexpr std::uint32_t of_block = 64;
  const std::vector<std::uint8_t>& kept_;
  std::vector<std::uint32_t> kept_before_;      ///< by block of triangles: how many kept ones come before it
  std::vector<std::uint32_t> firsts_of_seam_;   ///< of each tile's among the kept ones, and of all
  std::vector<std::uint32_t> first_triangles_;  ///< of each tile, if it has some
};

/// A triangle of the seam as it stands in the result.
struct SeamTriangle {
  Triangle corners;  ///< input numbers
  Neighbours neighbours;
  std::array<GridPoint, 3> points;  ///< the corners
  std::uint32_t constrained;
};

/// What is across from corner k of one of a tile's final triangles.
struct Across {
  std::uint32_t triangle, k;
  std::uint32_t place;  ///< of the seam's triangle there
  GridPoint apex;       ///< that one's corner that is not on the edge
};

/// Who gets the seam's triangles, from several threads at once, each triangle and each side of a final one once.
class SeamTaker {
 public:
  SeamTaker() = default;
  SeamTaker(const SeamTaker&) = delete;
  virtual ~SeamTaker() = default;
  /// `number`: among those of the tile.
  virtual void take(std::size_t tile, std::uint32_t number, const SeamTriangle& triangle) = 0;
  /// `border`: the number of the border's edge in the seam.
  virtual void take(std::uint32_t border, const Across& across) = 0;
};

/// Gives all when `order` knows all places.
void give_back(const Solved& solved, const Order& order, SeamTaker& to);

/// What a tile gets of the seam, where ranks are told; a process by itself takes it as it comes (SeamTaker).
struct Returned {
  Array<SeamTriangle> triangles;  ///< those with their first vertex in the tile, in their order
  Array<Across> across;
};

/// By tile, when `order` knows all places.
std::vector<Returned> returned_by(const Solved& solved, const Order& order);

/// By tile. Ranks want keys.
std::vector<SeamPieces> seam_pieces_by(const Solved& solved, bool with_keys);

/// Throws check_failed unless the result has as many triangles as so many distinct vertices ask for.
void check_count(const Solved& solved, const Order& order, std::uint64_t vertices);

}  // namespace gcdt::tiles
