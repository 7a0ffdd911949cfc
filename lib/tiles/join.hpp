// SPDX-License-Identifier: Apache-2.0
// The final triangles of the tiles and those of the seam as one result.
#pragma once

#include "tiles/seam.hpp"

namespace gcdt::tiles {

/// All that a problem's result is made of. Every part must outlive the joining.
struct Solved {
  const TileTask& task;
  const std::vector<SolvedTile>& tiles;
  const Seam& seam;
  const SolvedSeam& between;
};

/// Makes room for one of a result's arrays, or uses what is there.
template <class T>
T* room(ForestResult& result, std::int32_t array, std::size_t count) {
  const auto slot = static_cast<std::size_t>(array);
  result.begins[slot] = {0, count};
  return result.arrays[slot].reuse<T>(count);
}

template <class T>
T* elements_of(ForestResult& result, std::int32_t array) {
  return reinterpret_cast<T*>(result.arrays[static_cast<std::size_t>(array)].bytes.get());
}

template <class T>
Span<T> array_of(const ForestResult& result, std::int32_t array) {
  const auto slot = static_cast<std::size_t>(array);
  return {reinterpret_cast<const T*>(result.arrays[slot].bytes.get()),
          static_cast<std::size_t>(result.begins[slot].back())};
}

/// Where triangles are in the result. Those of a tile come before those of the next; a triangle of the seam is among
/// those of the tile that has its first vertex (docs/scale.md, T5).
class Order {
 public:
  explicit Order(const Solved& solved);

  std::uint32_t triangles() const { return firsts_.back(); }
  TilePlaces places_of(std::size_t tile) const { return {firsts_[tile], keys_[tile]}; }
  /// What write_tile() returns.
  void set_before(std::size_t tile, std::vector<std::uint32_t> before) { before_[tile] = std::move(before); }
  // From here on when all tiles are set.
  std::uint32_t place_of_final(std::size_t tile, std::uint32_t triangle) const;
  std::uint32_t place_in_seam(std::uint32_t triangle) const;

 private:
  std::vector<std::uint32_t> firsts_;                             ///< of each tile, and of all
  std::vector<std::vector<std::array<std::uint64_t, 2>>> keys_;   ///< of the seam's triangles, by tile
  std::vector<std::vector<std::uint32_t>> before_;                ///< final ones before each of those
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_seam_;  ///< by triangle of the seam: tile, number there
};

/// What is left to do when the tiles have written their final triangles: the seam's triangles, the border between, and
/// all other arrays, as one device would have made them (docs/scale.md, T4), with their counts in the statistics.
/// `dropped`: ascending. With `check`, throws check_failed unless the mesh has as many triangles as its vertices ask
/// for, and is locally Delaunay at the border; what is on either side, the runs have checked.
void join(const Solved& solved, const Order& order, const std::vector<std::uint32_t>& dropped, ForestResult& result);

}  // namespace gcdt::tiles
