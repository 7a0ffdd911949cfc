// SPDX-License-Identifier: Apache-2.0
// Constraints shared out by the devices, of a process that has the whole input.
#pragma once

#include <algorithm>
#include <memory>

#include "tiles/partition.hpp"
#include "tiles/staged.hpp"

namespace gcdt::tiles {

/// The constraints of the input on the devices, block by block. Blocks stay on a device that keeps the vertices and has
/// room for them, too.
class StagedConstraints {
 public:
  /// `roles`: as of partition(). Staged vertices, input and roles must outlive the object. `most`: constraints of a
  /// block.
  StagedConstraints(const DevicePool& pool, const Staged& staged, const GridInput& input,
                    const std::vector<Role>& roles, std::size_t tiles,
                    std::size_t most = Tuning::most_constraints_of_block);

  /// Constraints that follow each other, as pairs of input numbers; who has a role that is not `any` has none.
  struct Block {
    runtime::Buffer<cl_uint2> ends;
    std::size_t first;
    cl_uint count;
  };
  std::size_t blocks() const { return (count_ + of_block_ - 1) / of_block_; }
  std::size_t of_block() const { return of_block_; }
  /// A range within a block.
  struct Part {
    std::size_t block, first, count;
  };
  Part all_of(std::size_t block) const {
    return {block, block * of_block_, std::min(of_block_, count_ - block * of_block_)};
  }
  // On the device's thread.
  /// Sends all blocks that are to stay there, as other devices are at the same time; none where constraints have roles.
  void send(DevicePool::Lent& lent, runtime::SharedUpload::Taker& taker);
  std::shared_ptr<const Block> block(DevicePool::Lent& lent, std::size_t number);
  /// The same of a part. One that is not all of its block does not stay.
  std::shared_ptr<const Block> part(DevicePool::Lent& lent, const Part& part);
  /// Gives back the device's blocks; they are sent again when they are wanted.
  void leave(std::size_t device);
  /// Not where the vertices have left, be it since the object was made.
  bool keeps(std::size_t device) const { return keeps_[device] && staged_.keeps(device); }
  /// Of the blocks that are to stay on the device, and are not there yet.
  std::uint64_t bytes_to_come(std::size_t device) const;

 private:
  std::shared_ptr<const Block> made(DevicePool::Lent& lent, const Part& part) const;

  const Staged& staged_;
  const Constraints ends_;
  const std::vector<Role>& roles_;
  const std::size_t count_;
  std::size_t of_block_;
  std::vector<char> keeps_;                                        ///< by device; its thread alone changes its own
  std::vector<std::vector<std::shared_ptr<const Block>>> blocks_;  ///< by device and number; null: not there
};

/// The constraints that are no tile's, by ascending place among those of the process, which they have as numbers: wide
/// ones, and those around which the box is no tile's. Found by GPUs if there are some, by whichever takes a block.
std::vector<OpenConstraint> find_open(DevicePool& pool, Staged& staged, StagedConstraints& constraints,
                                      const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles);

}  // namespace gcdt::tiles
