// SPDX-License-Identifier: Apache-2.0
// Which solved tiles leave their devices for others to have room, and when.
#pragma once

#include <atomic>
#include <mutex>
#include <optional>

#include "tiles/ranks.hpp"
#include "tiles/result_room.hpp"

namespace gcdt::tiles {

/// Spills tiles, the first solved ones first. Where a device has a side queue, a tile leaves while the next one is
/// made: as soon as it is known that the one after that would have no room. A device's tiles are touched by its thread
/// alone, and by the one spill that goes on in its side queue. Everything given must outlive the object.
///
/// Tiles wait in the result's arrays, each behind the final triangles of all before it: in the result there are those
/// of the seam besides, so no tile has to go down when their number is known, and none is in the way of one before it
/// that has gone up (spilled.cpp). Where a tile leaves while one before it is not solved, it waits in memory of its
/// own.
class Spiller {
 public:
  Spiller(const DevicePool& pool, Staged& staged, ResultRoom& room, const TileRange& range)
      : pool_(pool), staged_(staged), room_(room), range_(range), counts_(range.size()), devices_(pool.size()) {}

  /// So many tiles are to be made.
  void expect(std::size_t tiles) { left_ = tiles; }
  /// Before a tile of n vertices and m constraints is made. If spilling makes too little room, what can be had again is
  /// given back, which takes longer for the whole input than for a tile. `constraints`: null if none are staged.
  void make_room(DevicePool::Lent& lent, std::uint64_t n, std::uint64_t m, StagedConstraints* constraints);
  /// The device has what is final of a tile from now on, of n vertices and m constraints, as the next one will be.
  void add(DevicePool::Lent& lent, std::size_t tile, FinalTriangles& final, std::uint64_t n, std::uint64_t m);
  /// Whether a tile is on its way.
  bool goes_on() const;
  /// Waits for the one that leaves the device, if one does. Throws what went wrong; then it is there yet.
  void settle(DevicePool::Lent& lent);
  /// settle() when all tiles are made: nothing needs the room, so a tile for which there was too little memory stays.
  void finish(DevicePool::Lent& lent);

 private:
  struct There {
    std::size_t tile;
    FinalTriangles* final;
  };
  struct OfDevice {
    std::vector<There> there;
    bool leaving = false;  ///< the first of those
  };
  void note(std::size_t tile, std::uint32_t count);
  SpillTo target_of(const There& one);

  const DevicePool& pool_;
  Staged& staged_;
  ResultRoom& room_;
  const TileRange range_;
  std::mutex mutex_;                                  ///< of the next two
  std::vector<std::optional<std::uint32_t>> counts_;  ///< by tile of the range: final triangles, as first solved
  std::vector<std::uint64_t> ends_;                   ///< of places in the result, as far as all counts are known
  std::atomic<std::size_t> left_{0};                  ///< tiles that nobody has begun, or fewer, if one is made twice
  std::vector<OfDevice> devices_;
};

}  // namespace gcdt::tiles
