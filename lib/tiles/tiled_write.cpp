// SPDX-License-Identifier: Apache-2.0
// From solved tiles and seam to the result.
#include "device/parts.hpp"
#include "device/step.hpp"
#include "tiles/spilled.hpp"
#include "tiles/tiled_run.hpp"

namespace gcdt::tiles {

/// The devices write final triangles, and the host the rest. If a device is lost, all is solved again without it.
ResultPart TiledRun::write(const std::vector<Role>& roles, const std::vector<std::uint32_t>& dropped) {
  for (;;) {
    if (!tell("join", 0.9)) throw Error(Status::cancelled, "cancelled during join");
    std::optional<Order> order;
    OwnPlaces places;
    ResultPart part;
    std::vector<std::vector<std::uint32_t>> before(range_.size());
    std::vector<TilePieces> pieces;
    {
      const Timed timed(report_.ms_write);
      if (team_.is_first()) order.emplace(Solved{tiles_, seam_, between_});
      places = scatter_places(team_, tiles_.size(), order ? &*order : nullptr);
      std::uint32_t triangles = 0;
      for (std::size_t i = 0; i < range_.size(); ++i)
        triangles += tiles_[range_.first + i].final.count + places.tiles[i].of_seam;
      for (SolvedTile& tile : tiles_)
        if (triangles > room_.most() && tile.final.is_in_result()) tile.final.leave_result();
      part.result = room_.take(triangles);
      part.first = places.tiles[0].first;
      pieces = pieces_of_seam();
      make_room_for_pieces(tiles_, range_.first, pieces, part.result);
    }
    if (write_tiles(places, before, pieces, part.result)) {
      const Timed timed(report_.ms_join);
      for (TilePlaces& own : places.tiles) own.make_keys = {};
      finish(places, std::move(before), std::move(pieces), order ? &*order : nullptr, part);
      part.result.statistics.constraints_dropped = dropped.size();
      std::copy(dropped.begin(), dropped.end(), room<std::uint32_t>(part.result, GCDT_DROPPED, dropped.size()));
      return part;
    }
    solve_uncrossed(roles);
  }
}

/// What is spilled the host writes, and what is on devices these do, at once; but not where spilled tiles wait.
bool TiledRun::write_tiles(const OwnPlaces& places, std::vector<std::vector<std::uint32_t>>& before,
                           std::vector<TilePieces>& pieces, ForestResult& joined) {
  const Timed timed(report_.ms_write);
  std::vector<ToWrite> spilled;
  std::vector<std::vector<std::pair<ToWrite, TilePieces*>>> on_device(pool_.size());
  const Triangle* first_waiting = nullptr;  // of the last tile in the result's arrays: nothing before it is free
  for (std::size_t i = 0; i < range_.size(); ++i) {
    SolvedTile& tile = tiles_[range_.first + i];
    const TilePlaces& to = places.tiles[i];
    const ToWrite one{tile.final, to, berth_of(joined).from(to.first - places.tiles[0].first), before[i]};
    if (tile.final.is_in_result()) first_waiting = one.to.triangles;
    if (tile.final.is_spilled()) spilled.push_back(one);
    if (tile.final.on_device()) on_device[tile.device].emplace_back(one, &pieces[i]);
  }
  const std::shared_future<void> writing = begin_in_thread([&] { write_spilled(task_.input, spilled); }).share();
  const bool all = pool_.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) {
    for (const auto& [one, of_tile] : on_device[lent.device]) {
      if (std::less<>()(one.to.triangles, first_waiting)) writing.wait();
      task_.staged.leave(lent.device);
      if (one.final.spill_failed()) {
        one.final.spill(lent.runtime, {pool_.spill_directory(), {}});
        write_spilled(task_.input, {one});
        continue;
      }
      Step step(lent.runtime, "write");
      const SeamPieces& seam = of_tile->of_seam;
      const FinalPieces::OnItsWay pieces_written = one.final.pieces.begin_write(
          lent.runtime, one.final.ids, one.final.points, seam, keys_of(task_.input, seam), of_tile->to);
      one.before = write_tile(lent, one.final, one.places, one.to, pieces_written.reads);
      of_tile->before = one.final.pieces.end_write(lent.runtime, pieces_written);
      of_tile->are_written = true;
      step.end();
      one.final.release();
    }
  });
  writing.get();
  // A device may have been lost since it solved a tile.
  return all && std::none_of(tiles_.begin(), tiles_.end(),
                             [](const SolvedTile& tile) { return tile.final.on_device() || tile.final.is_spilled(); });
}

/// Of the rank's tiles. What they are made of is given back.
std::vector<TilePieces> TiledRun::pieces_of_seam() {
  std::vector<SeamPieces> all;
  if (team_.is_first()) {
    all = seam_pieces_by(Solved{tiles_, seam_, between_}, !team_.is_alone());
    leave_pieces();
  }
  all = scatter_pieces(team_, tiles_.size(), std::move(all));
  std::vector<TilePieces> pieces(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) pieces[i].of_seam = std::move(all[i]);
  return pieces;
}

void TiledRun::finish(const OwnPlaces& places, std::vector<std::vector<std::uint32_t>> before,
                      std::vector<TilePieces> pieces, Order* order, ResultPart& part) {
  gather_before(team_, tiles_.size(), before, order);
  std::uint64_t merged = 0;
  for (const SolvedTile& tile : tiles_) merged += tile.merged.size();
  merged = team_.sum(merged);
  std::vector<Returned> returned;
  if (order) {
    const Solved solved{tiles_, seam_, between_};
    if (task_.check) check_count(solved, *order, task_.input.n() - merged);
    if (!team_.is_alone()) returned = returned_by(solved, *order);
  }
  if (team_.is_alone()) returned.resize(range_.size());
  returned = scatter_returned(team_, tiles_.size(), std::move(returned));
  std::vector<WrittenTile> written;
  for (std::size_t i = 0; i < range_.size(); ++i)
    written.push_back({tiles_[range_.first + i], places.tiles[i].first, team_.is_alone() ? order->before(i) : before[i],
                       std::move(returned[i]), pieces[i]});
  std::function<void(SeamTaker & to)> give;
  if (team_.is_alone()) give = [&](SeamTaker& to) { give_back(Solved{tiles_, seam_, between_}, *order, to); };
  join(task_.input, written, task_.check, part.result, seam_.border, give);
  part.result.statistics.vertices_merged = merged;
  count(places, part.result);
  if (team_.is_alone()) return write_representatives(part.result);
  part.result.begins[GCDT_REPRESENTATIVES].clear();
  for (const WrittenTile& tile : written) {
    part.seam.insert(part.seam.end(), tile.seam.triangles.begin(), tile.seam.triangles.end());
    part.merged.insert(part.merged.end(), tile.tile.merged.begin(), tile.tile.merged.end());
  }
}

/// Gives back what of the seam's pieces has been handed to the tiles.
void TiledRun::leave_pieces() {
  for (const std::size_t array : {GCDT_PIECES, GCDT_SOURCE_OFFSETS, GCDT_SOURCES, GCDT_REPRESENTATIVES})
    made_seam_.arrays[array] = {};
  between_.mesh.pieces = {}, between_.mesh.source_offsets = {}, between_.mesh.sources = {};
  forget(seam_.parts), forget(seam_.open);
  for (SolvedTile& tile : tiles_) forget(tile.pieces), forget(tile.source_offsets), forget(tile.sources);
}

void TiledRun::write_representatives(ForestResult& result) const {
  auto* representative = elements_of<std::uint32_t>(result, GCDT_REPRESENTATIVES);
  for (const SolvedTile& tile : tiles_)
    for (const Constraint& pair : tile.merged) representative[pair[0]] = pair[1];
}

/// What there is of the whole result.
void TiledRun::count(const OwnPlaces& places, ForestResult& result) {
  Statistics& s = result.statistics;
  s.n = task_.input.n();
  s.m = task_.input.constraints.count;
  s.triangles = places.triangles;
  s.constraints_pieces = team_.sum(result.begins[GCDT_PIECES].back());
  s.constraints_overlapping = team_.sum(result.begins[GCDT_SOURCES].back()) - s.constraints_pieces;
}

}  // namespace gcdt::tiles
