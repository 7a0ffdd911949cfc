// SPDX-License-Identifier: Apache-2.0
#include "tiles/messages.hpp"

namespace gcdt::tiles {

namespace {

/// Calls pack(tile, packer) for each rank's tiles.
template <class Pack>
std::vector<Bytes> for_ranks(const Team& team, std::size_t tiles, Pack&& pack) {
  std::vector<Bytes> messages;
  for (std::size_t rank = 0; rank < team.size(); ++rank) {
    const TileRange range = tiles_of_rank(team, rank, tiles);
    Packer packer;
    for (std::size_t t = range.first; t < range.end; ++t) pack(t, packer);
    messages.push_back(packer.take());
  }
  return messages;
}

/// Calls use(array) for each array of a message, in its order: so that what is put is what is got.
template <class OneShare, class Use>
void each_of_share(OneShare& share, Use&& use) {
  use(share.constraints), use(share.constraint_ids), use(share.passages), use(share.foreign), use(share.open_ends);
}
template <class OneReturned, class Use>
void each_of_returned(OneReturned& r, Use&& use) {
  use(r.triangles), use(r.across);
}
template <class OnePieces, class Use>
void each_of_pieces(OnePieces& p, Use&& use) {
  use(p.keys), use(p.pieces), use(p.source_offsets), use(p.sources);
}

void put(Packer& to, const Share& share) {
  each_of_share(share, [&](const auto& array) { to.put(array); });
}

void append(Unpacker& from, Share& share) {
  each_of_share(share, [&](auto& array) { from.append_to(array); });
}

void put(Packer& to, const SolvedTile& tile) {
  to.put_one(tile.own);
  to.put_one(tile.box);
  to.put_one(tile.final.count);
  to.put(tile.vertices);
  to.put(tile.hull_vertices);
  to.put(tile.border);
  to.put(tile.dropped);
  to.put(tile.ends);
  to.put(tile.stand_ins);
  to.put(tile.pieces);
  to.put(tile.source_offsets);
  to.put(tile.sources);
}

void get(Unpacker& from, SolvedTile& tile) {
  tile = {};
  from.get_one(tile.own);
  from.get_one(tile.box);
  from.get_one(tile.final.count);
  from.append_to(tile.vertices);
  from.append_to(tile.hull_vertices);
  from.append_to(tile.border);
  from.append_to(tile.dropped);
  from.append_to(tile.ends);
  from.append_to(tile.stand_ins);
  from.append_to(tile.pieces);
  from.append_to(tile.source_offsets);
  from.append_to(tile.sources);
}

void put(Packer& to, const Returned& returned) {
  each_of_returned(returned, [&](const auto& array) { to.put(array); });
}

void get(Unpacker& from, Returned& returned) {
  each_of_returned(returned, [&](auto& array) { from.append_to(array); });
}

void put(Packer& to, const SeamPieces& pieces) {
  each_of_pieces(pieces, [&](const auto& array) { to.put(array); });
}

void get(Unpacker& from, SeamPieces& pieces) {
  each_of_pieces(pieces, [&](auto& array) { from.append_to(array); });
}

/// Of what the first rank has for all tiles that of the rank's.
template <class T>
std::vector<T> scatter(Team& team, std::size_t tiles, std::vector<T> all) {
  if (team.is_alone()) return all;
  std::vector<Bytes> messages;
  if (team.is_first()) messages = for_ranks(team, tiles, [&](std::size_t t, Packer& to) { put(to, all[t]); });
  const Bytes message = team.scatter(std::move(messages));
  Unpacker from(message);
  std::vector<T> own(own_tiles(team, tiles).size());
  for (T& one : own) get(from, one);
  return own;
}

}  // namespace

void exchange_shares(Team& team, Partition& all) {
  if (team.is_alone()) return;
  const std::size_t tiles = all.tiles.size();
  std::vector<Bytes> messages = for_ranks(team, tiles, [&](std::size_t t, Packer& to) {
    put(to, all.tiles[t]);
    all.tiles[t] = {};
  });
  const TileRange own = own_tiles(team, tiles);
  // A rank's constraints come before those of the next, so numbers ascend.
  for (const Bytes& message : team.exchange(std::move(messages))) {
    Unpacker from(message);
    for (std::size_t t = own.first; t < own.end; ++t) append(from, all.tiles[t]);
  }
  for (std::size_t t = own.first; t < own.end; ++t) {
    sort_unique(all.tiles[t].foreign);
    sort_unique(all.tiles[t].open_ends);
  }
  gather(team, all.open);
}

void gather_tiles(Team& team, std::vector<SolvedTile>& tiles) {
  if (team.is_alone()) return;
  const TileRange own = own_tiles(team, tiles.size());
  Packer packer;
  for (std::size_t t = own.first; t < own.end; ++t) put(packer, tiles[t]);
  const std::vector<Bytes> all = team.gather(packer.take());
  for (std::size_t rank = 1; rank < all.size(); ++rank) {
    const TileRange range = tiles_of_rank(team, rank, tiles.size());
    Unpacker from(all[rank]);
    for (std::size_t t = range.first; t < range.end; ++t) get(from, tiles[t]);
  }
}

OwnPlaces scatter_places(Team& team, std::size_t tiles, Order* order) {
  OwnPlaces own;
  if (team.is_alone()) {
    for (std::size_t t = 0; t < tiles; ++t) own.tiles.push_back(order->places(t));
    own.triangles = order->triangles();
    return own;
  }
  std::vector<Bytes> messages;
  if (order)
    messages = for_ranks(team, tiles, [&](std::size_t t, Packer& to) {
      const TilePlaces places = order->places(t);
      to.put_one(order->triangles());
      to.put_one(places.first);
      to.put(places.make_keys());
    });
  const Bytes message = team.scatter(std::move(messages));
  Unpacker from(message);
  own.tiles.resize(own_tiles(team, tiles).size());
  for (TilePlaces& places : own.tiles) {
    from.get_one(own.triangles);
    from.get_one(places.first);
    auto keys = std::make_shared<SeamKeys>();
    from.append_to(*keys);
    places.of_seam = static_cast<std::uint32_t>(keys->size());
    places.make_keys = [keys] { return *keys; };
  }
  return own;
}

void gather_before(Team& team, std::size_t tiles, std::vector<std::vector<std::uint32_t>>& own, Order* order) {
  if (team.is_alone()) {
    for (std::size_t t = 0; t < tiles; ++t) order->set_before(t, std::move(own[t]));
    return;
  }
  Packer packer;
  for (const std::vector<std::uint32_t>& before : own) packer.put(before);
  const std::vector<Bytes> all = team.gather(packer.take());
  for (std::size_t rank = 0; rank < all.size() && order; ++rank) {
    const TileRange range = tiles_of_rank(team, rank, tiles);
    Unpacker from(all[rank]);
    for (std::size_t t = range.first; t < range.end; ++t) {
      std::vector<std::uint32_t> before;
      from.append_to(before);
      order->set_before(t, std::move(before));
    }
  }
}

std::vector<SeamPieces> scatter_pieces(Team& team, std::size_t tiles, std::vector<SeamPieces> all) {
  return scatter(team, tiles, std::move(all));
}

std::vector<Returned> scatter_returned(Team& team, std::size_t tiles, std::vector<Returned> all) {
  return scatter(team, tiles, std::move(all));
}

}  // namespace gcdt::tiles
