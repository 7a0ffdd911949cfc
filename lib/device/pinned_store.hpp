// SPDX-License-Identifier: Apache-2.0
// Host memory for results that a driver has pinned, kept from call to call.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "device/host_array.hpp"
#include "device/mapped_memory.hpp"
#include "device/pinned_ranges.hpp"

namespace gcdt::runtime {

/// Blocks of such memory. Pinning takes a hundred times as long as what is then saved in one transfer
/// (bench/NOTES.md, "Tiles"), so a block that is handed back serves the next call. All functions may be called by any
/// thread.
class PinnedStore final : public HostSource {
 public:
  /// `runtime`: nobody else's. `ranges`: to which the blocks are told.
  PinnedStore(std::unique_ptr<Runtime> runtime, std::shared_ptr<PinnedRanges> ranges)
      : runtime_(std::move(runtime)), ranges_(std::move(ranges)) {}
  PinnedStore(const PinnedStore&) = delete;
  ~PinnedStore() override;

  /// A free block, if one is large enough and not more than twice as large; else a new one, and then all free ones are
  /// given back, so that sizes which change do not pile up. Null if the driver has no such memory.
  unsigned char* take(std::size_t bytes) override;
  void give_back(unsigned char* memory) noexcept override;

 private:
  struct Block {
    std::unique_ptr<MappedMemory> memory;
    std::size_t bytes = 0;
    bool used = false;
  };
  void drop_free();

  std::mutex mutex_;  ///< of all that follows
  std::unique_ptr<Runtime> runtime_;
  std::shared_ptr<PinnedRanges> ranges_;
  std::vector<Block> blocks_;
};

}  // namespace gcdt::runtime
