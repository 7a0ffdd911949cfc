// SPDX-License-Identifier: Apache-2.0
#include "device/pinned_store.hpp"

#include <algorithm>

namespace gcdt::runtime {

PinnedStore::~PinnedStore() {
  for (const Block& block : blocks_) ranges_->remove(block.memory->get(), block.bytes);
}

unsigned char* PinnedStore::take(std::size_t bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Block* best = nullptr;
  for (Block& block : blocks_)
    if (!block.used && block.bytes >= bytes && block.bytes / 2 <= bytes && (!best || block.bytes < best->bytes))
      best = &block;
  if (!best) {
    drop_free();
    const std::size_t made = std::max<std::size_t>(bytes, 1);
    auto memory = std::make_unique<MappedMemory>(*runtime_, made);
    if (!memory->get()) return nullptr;
    blocks_.push_back({std::move(memory), made, false});
    best = &blocks_.back();
    ranges_->add(best->memory->get(), best->bytes);
  }
  best->used = true;
  return best->memory->get();
}

void PinnedStore::give_back(unsigned char* memory) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (Block& block : blocks_)
    if (block.memory->get() == memory) block.used = false;
}

void PinnedStore::drop_free() {
  const auto kept = std::partition(blocks_.begin(), blocks_.end(), [](const Block& block) { return block.used; });
  for (auto block = kept; block != blocks_.end(); ++block) ranges_->remove(block->memory->get(), block->bytes);
  blocks_.erase(kept, blocks_.end());
}

}  // namespace gcdt::runtime
