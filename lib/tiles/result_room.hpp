// SPDX-License-Identifier: Apache-2.0
// Host memory for a result, made ready while the devices work on its tiles.
#pragma once

#include <future>
#include <mutex>
#include <thread>

#include "device/host_room.hpp"
#include "device/parts.hpp"
#include "tiles/join.hpp"

namespace gcdt::tiles {

/// Of a result's triangles.
inline Berth berth_of(ForestResult& result) {
  return {elements_of<Triangle>(result, GCDT_TRIANGLES), elements_of<Neighbours>(result, GCDT_NEIGHBOURS),
          elements_of<std::uint8_t>(result, GCDT_CONSTRAINED)};
}

/// Room for the triangles of n vertices, and their representatives, and for the pieces of m constraints. Only time
/// depends on when it is made. Tiles wait there for their places.
class ResultRoom {
 public:
  ResultRoom(const DevicePool& pool, std::uint64_t n, std::uint64_t m) : vertices_(static_cast<std::size_t>(n)) {
    if (!pool.prepares_host_memory() || n < Tuning::least_prepared_vertices) return;
    const bool is_pinned = pool.result_memory() != nullptr;
    if (is_pinned)
      for (const int array : {GCDT_TRIANGLES, GCDT_NEIGHBOURS, GCDT_CONSTRAINED, GCDT_REPRESENTATIVES, GCDT_PIECES,
                              GCDT_SOURCE_OFFSETS, GCDT_SOURCES})
        made_.arrays[static_cast<std::size_t>(array)].source = pool.result_memory();
    const unsigned threads = std::max(1u, std::thread::hardware_concurrency() / Tuning::cores_of_room_thread);
    try {
      make(2 * vertices_);
      std::vector<runtime::HostRoom::Range> all;  // as tiles come
      for (std::size_t part = 0; part < parts_in_turn; ++part) {
        const std::size_t first = 2 * vertices_ * part / parts_in_turn,
                          end = 2 * vertices_ * (part + 1) / parts_in_turn;
        for (const runtime::HostRoom::Range& range : ranges(first, end - first)) all.push_back(range);
      }
      if (m > 0) {  // some constraints are cut into several pieces
        const std::size_t pieces = static_cast<std::size_t>(m + m / 32);
        for (const auto& [array, bytes] : {std::pair{GCDT_PIECES, sizeof(Constraint)},
                                           {GCDT_SOURCE_OFFSETS, sizeof(std::uint32_t)},
                                           {GCDT_SOURCES, sizeof(std::uint32_t)}})
          all.push_back(
              {made_.arrays[static_cast<std::size_t>(array)].reuse<unsigned char>(pieces * bytes), pieces * bytes});
      }
      if (!is_pinned) room_.emplace(all, threads);  // whose pages are there
      numbering_ = std::async(std::launch::async, [this] { number(); });
    } catch (const std::exception&) {
      // There is no memory, or no thread: take() asks again, and reports it.
    }
  }
  ResultRoom(const ResultRoom&) = delete;

  /// What there is room for while tiles are solved: as many triangles as the vertices can have. A rank may get more,
  /// of the seam.
  std::size_t most() const { return 2 * vertices_; }
  /// Where triangles from number `first` on wait until take(), which leaves them there if it is for most() at the
  /// most; null if there is no room. From any thread.
  Berth berth(std::size_t first, std::size_t count) {
    if (first > most() || count > most() - first) return {};
    const std::lock_guard<std::mutex> lock(mutex_);
    make(most());
    if (room_)
      for (const runtime::HostRoom::Range& range : ranges(first, count)) room_->leave(range);
    return berth_of(made_).from(first);
  }

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

  std::array<runtime::HostRoom::Range, 3> ranges(std::size_t first, std::size_t count) {
    const Berth all = berth_of(made_).from(first);
    return {runtime::HostRoom::Range{reinterpret_cast<unsigned char*>(all.triangles), count * sizeof(Triangle)},
            {reinterpret_cast<unsigned char*>(all.neighbours), count * sizeof(Neighbours)},
            {all.constrained, count}};
  }

  static constexpr std::size_t parts_in_turn = 64;
  std::size_t vertices_;
  std::mutex mutex_;  ///< of berth()
  ForestResult made_;
  std::optional<runtime::HostRoom> room_;
  std::future<void> numbering_;  ///< it writes representatives, and nothing else does meanwhile
};

}  // namespace gcdt::tiles
