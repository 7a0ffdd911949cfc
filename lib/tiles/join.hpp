// SPDX-License-Identifier: Apache-2.0
// The final triangles of the tiles and those of the seam as one result, or as the part of one that a rank has.
#pragma once

#include "tiles/returned.hpp"

namespace gcdt::tiles {

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
  if (result.begins[slot].empty()) return {};
  return {reinterpret_cast<const T*>(result.arrays[slot].bytes.get()),
          static_cast<std::size_t>(result.begins[slot].back())};
}

/// The pieces of a tile, as far as they are in the result.
struct TilePieces {
  SeamPieces of_seam;
  PieceBerth to;
  PiecesBefore before;  ///< what FinalPieces::write() returned, if it wrote the tile's own
  bool are_written = false;
};

/// A tile whose final triangles are written.
struct WrittenTile {
  SolvedTile& tile;                          ///< gives up its pieces, if they are spilled
  std::uint32_t first;                       ///< the place of its first triangle in the result
  const std::vector<std::uint32_t>& before;  ///< what write_tile() returned; must outlive the object
  Returned seam;
  TilePieces& pieces;
};

/// Room for the pieces of a rank's tiles, of which the first one's come first: sets where each has its own.
void make_room_for_pieces(const std::vector<SolvedTile>& tiles, std::size_t first_tile, std::vector<TilePieces>& pieces,
                          ForestResult& result);

/// The keys of the seam's pieces.
SeamKeys keys_of(const GridInput& input, const SeamPieces& pieces);

/// What is left to do when the tiles of a rank have written their final triangles: the seam's triangles, the border
/// between, and the pieces that no device has written, as one device would have made them (docs/scale.md, T4). The
/// arrays of triangles begin with the first tile's. With `check`, throws check_failed unless the mesh is locally
/// Delaunay at the border; what is on either side, the runs have checked. `give`, if it is not null, gives the seam's
/// triangles and what is across at the border, of which the tiles have none then; `border`: the tile of each edge of
/// that.
void join(const GridInput& input, const std::vector<WrittenTile>& tiles, bool check, ForestResult& result,
          const std::vector<Seam::Border>& border = {}, const std::function<void(SeamTaker& to)>& give = {});

}  // namespace gcdt::tiles
