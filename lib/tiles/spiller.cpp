// SPDX-License-Identifier: Apache-2.0
#include "tiles/spiller.hpp"

#include <algorithm>

namespace gcdt::tiles {

namespace {

bool fits(const DevicePool::Lent& lent, std::uint64_t bytes) {
  return lent.runtime.meter().now + bytes <= lent.capacity;
}

}  // namespace

void Spiller::make_room(DevicePool::Lent& lent, std::uint64_t n, std::uint64_t m, StagedConstraints* constraints) {
  std::size_t left = left_;
  while (left > 0 && !left_.compare_exchange_weak(left, left - 1)) {
  }
  OfDevice& own = devices_[lent.device];
  // What stays on the device comes while the tile takes its part, and is beside it from then on.
  const auto has_room = [&] {
    return fits(lent, forest_bytes(1, n, m) + staged_.bytes_to_come(lent.device) +
                          (constraints ? constraints->bytes_to_come(lent.device) : 0));
  };
  if (!has_room()) settle(lent);
  // Ends: each time there is one less.
  while (!has_room() && !own.there.empty()) {
    own.there.front().final->spill(lent.runtime, target_of(own.there.front()));
    own.there.erase(own.there.begin());
  }
  if (!has_room() && constraints) constraints->leave(lent.device);
  if (!has_room()) staged_.leave(lent.device);
}

void Spiller::add(DevicePool::Lent& lent, std::size_t tile, FinalTriangles& final, std::uint64_t n, std::uint64_t m) {
  note(tile, final.count);
  if (!final.on_device()) return;  // a tile without vertices
  OfDevice& own = devices_[lent.device];
  own.there.push_back({tile, &final});
  const std::size_t left = left_;
  if (left > 0) final.compact(lent.runtime);  // it stays beside the next one
  if (!lent.side || left == 0) return;
  settle(lent);
  if (fits(lent, forest_bytes(1, n, m) + (left > 1 ? final.device_bytes() : 0))) return;
  const There& first = own.there.front();
  lent.side->begin(first.final->begin_spill(lent.runtime, target_of(first)));
  own.leaving = true;
}

bool Spiller::goes_on() const {
  return std::any_of(devices_.begin(), devices_.end(), [](const OfDevice& device) { return device.leaving; });
}

void Spiller::settle(DevicePool::Lent& lent) {
  OfDevice& own = devices_[lent.device];
  if (!own.leaving) return;
  own.leaving = false;
  FinalTriangles& final = *own.there.front().final;
  try {
    lent.side->wait();
  } catch (...) {
    final.end_spill();
    throw;
  }
  final.end_spill();
  own.there.erase(own.there.begin());
}

void Spiller::finish(DevicePool::Lent& lent) {
  try {
    settle(lent);
  } catch (const Error& error) {
    if (error.status() != Status::out_of_memory) throw;
  }
}

/// A tile that is solved again, on another device, may have other final triangles (docs/scale.md, T2); its place stays.
void Spiller::note(std::size_t tile, std::uint32_t count) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::optional<std::uint32_t>& known = counts_[tile - range_.first];
  if (!known) known = count;
  // Ends: there is one more each time.
  while (ends_.size() < counts_.size() && counts_[ends_.size()])
    ends_.push_back((ends_.empty() ? 0 : ends_.back()) + *counts_[ends_.size()]);
}

SpillTo Spiller::target_of(const There& one) {
  if (!pool_.spill_directory().empty()) return {pool_.spill_directory(), {}};
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::size_t number = one.tile - range_.first;
  if (number >= ends_.size() || one.final->count > *counts_[number]) return {};
  return {{}, room_.berth(static_cast<std::size_t>(ends_[number] - *counts_[number]), one.final->count)};
}

}  // namespace gcdt::tiles
