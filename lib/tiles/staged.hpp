// SPDX-License-Identifier: Apache-2.0
// The vertices as they were given, on every device that has room for all of them.
#pragma once

#include <future>

#include "batch/device_pool.hpp"
#include "device/shared_upload.hpp"
#include "tiles/team.hpp"

namespace gcdt::tiles {

/// A device looks through the input chunk by chunk: to find the grid, and for each tile that it solves, to find the
/// tile's vertices. Chunks stay on the device if that does not take the memory that a tile needs.
class Staged {
 public:
  /// `tiles`: how many the input will have. The points must outlive the object.
  Staged(DevicePool& pool, Points points, std::size_t tiles);

  /// What devices are sent behind the vertices, by each device's thread.
  using Behind = std::function<void(DevicePool::Lent& lent, runtime::SharedUpload::Taker& taker)>;

  /// The grid that one device would choose (docs/contract.md, 1) for the points of all ranks, of which this one's begin
  /// with number `first`. Throws as order() does. `surveyed` is not set without points. What is sent `behind` is on its
  /// way then, until settle().
  ChosenGrid choose(const std::optional<FixedGrid>& fixed, Survey& surveyed, std::uint64_t first, Team& team,
                    const Behind& behind = {});
  /// Waits for what choose() has left under way. Throws if no device is left.
  void settle();
  /// The same without an exception, which is kept.
  void rest() const;

  /// Calls use(points, first) for each chunk on the device; `first` is the number of its first vertex.
  void for_chunks(DevicePool::Lent& lent, const std::function<void(const InputPoints& points, std::size_t first)>& use);
  /// Gives back the device's chunks; they are sent again when they are wanted.
  void leave(std::size_t device);
  bool keeps(std::size_t device) const { return keeps_[device]; }
  std::size_t of_chunk() const { return vertices_of_chunk_; }
  /// Of chunks that are to stay on the device, and are not there yet.
  std::uint64_t bytes_to_come(std::size_t device) const;

 private:
  using Taker = runtime::SharedUpload::Taker;
  /// Of the columns that the chunks have, by whichever devices look: GPUs if there are some.
  template <class Columns, class Look>
  Columns look(Team& team, const Behind& behind, Look&& look_at_chunk);
  void use_chunks(DevicePool::Lent& lent, Taker* taker,
                  const std::function<void(const InputPoints& points, std::size_t first)>& use);
  InputPoints send(DevicePool::Lent& lent, Taker* taker, std::size_t first) const;

  DevicePool& pool_;
  const Points points_;
  std::size_t vertices_of_chunk_;
  std::vector<char> keeps_;                       ///< by device; a device's thread alone changes its own
  std::vector<std::vector<InputPoints>> chunks_;  ///< by device; empty or all
  std::future<void> sending_;
};

}  // namespace gcdt::tiles
