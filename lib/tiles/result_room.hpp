// SPDX-License-Identifier: Apache-2.0
// Host memory for a result, made ready while the devices work on its tiles.
#pragma once

#include <thread>

#include "device/host_room.hpp"
#include "tiles/join.hpp"

namespace gcdt::tiles {

/// Room for the triangles of n vertices. Only time depends on when it is made.
class ResultRoom {
 public:
  ResultRoom(const DevicePool& pool, std::uint64_t n) : most_(2 * static_cast<std::size_t>(n)) {
    if (!pool.prepares_host_memory() || n < Tuning::least_prepared_vertices) return;
    try {
      make(most_);
      const auto touched = [&](std::int32_t array, std::size_t bytes) {
        return runtime::HostRoom::Range{elements_of<unsigned char>(made_, array), bytes};
      };
      const unsigned threads = std::max(1u, std::thread::hardware_concurrency() / Tuning::cores_of_room_thread);
      room_.emplace(std::vector{touched(GCDT_TRIANGLES, most_ * sizeof(Triangle)),
                                touched(GCDT_NEIGHBOURS, most_ * sizeof(Neighbours)),
                                touched(GCDT_CONSTRAINED, most_)},
                    threads);
    } catch (const std::bad_alloc&) {
      // take() asks for the memory again, and reports it.
    }
  }

  /// A result with room for so many triangles.
  ForestResult take(std::size_t triangles) {
    if (room_) room_->stop();
    make(triangles);
    return std::move(made_);
  }

 private:
  void make(std::size_t triangles) {
    room<Triangle>(made_, GCDT_TRIANGLES, triangles);
    room<Neighbours>(made_, GCDT_NEIGHBOURS, triangles);
    room<std::uint8_t>(made_, GCDT_CONSTRAINED, triangles);
  }

  std::size_t most_;
  ForestResult made_;
  std::optional<runtime::HostRoom> room_;
};

}  // namespace gcdt::tiles
