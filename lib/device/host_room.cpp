// SPDX-License-Identifier: Apache-2.0
#include "device/host_room.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>

namespace gcdt::runtime {

namespace {

// Bytes of a page: the system's pages are no smaller. And of a block, in which one thread touches all pages: as large
// as a huge page, and beginning where one does, so that two threads do not wait for one page.
constexpr std::size_t page = 4096, block = std::size_t{1} << 21;

std::size_t to_next(const unsigned char* at, std::size_t multiple) {
  return multiple - reinterpret_cast<std::uintptr_t>(at) % multiple;
}

}  // namespace

HostRoom::HostRoom(const std::vector<Range>& ranges, unsigned threads) {
  if (threads == 0) return;
  for (const Range& range : ranges)
    for (std::size_t at = 0; at < range.bytes;) {
      unsigned char* first = range.first + at;
      const std::size_t bytes = std::min(range.bytes - at, to_next(first, block));
      blocks_.push_back({first, bytes});
      at += bytes;
    }
  threads = static_cast<unsigned>(std::min<std::size_t>(threads, blocks_.size()));
  threads_.reserve(threads);
  try {
    for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { touch(); });
  } catch (const std::exception&) {
    // There is no thread to be had: whoever fills the memory touches the rest.
  }
}

void HostRoom::touch() {
  for (std::size_t i; (i = next_.fetch_add(1, std::memory_order_relaxed)) < blocks_.size();)
    for (std::size_t at = 0; at < blocks_[i].bytes; at += to_next(blocks_[i].first + at, page)) {
      if (enough_.load(std::memory_order_relaxed)) return;
      *static_cast<volatile unsigned char*>(blocks_[i].first + at) = 0;
    }
}

void HostRoom::stop() {
  enough_ = true;
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

}  // namespace gcdt::runtime
