// SPDX-License-Identifier: Apache-2.0
// What ranks that share a problem tell each other of tiles and seam. A rank by itself keeps what it has.
#pragma once

#include "tiles/returned.hpp"
#include "tiles/team.hpp"

namespace gcdt::tiles {

/// Tiles that follow each other, as many for each rank.
struct TileRange {
  std::size_t first, end;
  std::size_t size() const { return end - first; }
};
/// `tiles` is a multiple of the number of ranks.
inline TileRange tiles_of_rank(const Team& team, std::size_t rank, std::size_t tiles) {
  const std::size_t each = tiles / team.size();
  return {rank * each, (rank + 1) * each};
}
inline TileRange own_tiles(const Team& team, std::size_t tiles) { return tiles_of_rank(team, team.rank(), tiles); }

/// From what each rank has of the constraints to what its tiles get of all; the first rank gets those that are open.
void exchange_shares(Team& team, Partition& all);

/// The first rank gets of the tiles of others what the seam needs.
void gather_tiles(Team& team, std::vector<SolvedTile>& tiles);

/// The places of the rank's tiles, and of all triangles how many there are. `order`: the first rank's.
struct OwnPlaces {
  std::vector<TilePlaces> tiles;
  std::uint32_t triangles = 0;
};
OwnPlaces scatter_places(Team& team, std::size_t tiles, Order* order);

/// Tells the first rank's order what write_tile() has returned for the tiles of each rank. A process by itself gives
/// its own away.
void gather_before(Team& team, std::size_t tiles, std::vector<std::vector<std::uint32_t>>& own, Order* order);

/// Of what the first rank has for all tiles that of the rank's.
std::vector<SeamPieces> scatter_pieces(Team& team, std::size_t tiles, std::vector<SeamPieces> all);
std::vector<Returned> scatter_returned(Team& team, std::size_t tiles, std::vector<Returned> all);

}  // namespace gcdt::tiles
