// SPDX-License-Identifier: Apache-2.0
// Host memory for a result, made ready while the devices work on its tiles.
#pragma once

#include <future>
#include <thread>

#include "device/host_room.hpp"
#include "device/parts.hpp"
#include "tiles/join.hpp"

namespace gcdt::tiles {

/// Room for the triangles of n vertices, and their representatives. Only time depends on when it is made.
class ResultRoom {
 public:
  ResultRoom(const DevicePool& pool, std::uint64_t n) : vertices_(static_cast<std::size_t>(n)) {
    if (!pool.prepares_host_memory() || n < Tuning::least_prepared_vertices) return;
    const unsigned threads = std::max(1u, std::thread::hardware_concurrency() / Tuning::cores_of_room_thread);
    try {
      make(2 * vertices_);
      const auto touched = [&](std::int32_t array, std::size_t bytes) {
        return runtime::HostRoom::Range{elements_of<unsigned char>(made_, array), bytes};
      };
      room_.emplace(std::vector{touched(GCDT_TRIANGLES, 2 * vertices_ * sizeof(Triangle)),
                                touched(GCDT_NEIGHBOURS, 2 * vertices_ * sizeof(Neighbours)),
                                touched(GCDT_CONSTRAINED, 2 * vertices_)},
                    threads);
      numbering_ = std::async(std::launch::async, [this] { number(); });
    } catch (const std::exception&) {
      // There is no memory, or no thread: take() asks again, and reports it.
    }
  }
  ResultRoom(const ResultRoom&) = delete;

  /// A result with room for so many triangles, in which every vertex stands for itself.
  ForestResult take(std::size_t triangles) {
    if (room_) room_->stop();
    make(triangles);
    numbering_.valid() ? numbering_.get() : number();
    return std::move(made_);
  }

 private:
  void make(std::size_t triangles) {
    room<Triangle>(made_, GCDT_TRIANGLES, triangles);
    room<Neighbours>(made_, GCDT_NEIGHBOURS, triangles);
    room<std::uint8_t>(made_, GCDT_CONSTRAINED, triangles);
  }
  void number() {
    auto* representative = room<std::uint32_t>(made_, GCDT_REPRESENTATIVES, vertices_);
    for_each_in_threads(vertices_, [&](std::size_t v) { representative[v] = static_cast<std::uint32_t>(v); });
  }

  std::size_t vertices_;
  ForestResult made_;
  std::optional<runtime::HostRoom> room_;
  std::future<void> numbering_;  ///< it writes representatives, and nothing else does meanwhile
};

}  // namespace gcdt::tiles
