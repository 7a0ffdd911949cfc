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
  states_ = std::vector<std::atomic<State>>(blocks_.size());
  threads_.resize(std::min<std::size_t>(threads, blocks_.size()));
  start(0);
}

// Each thread starts the next, which takes some tens of microseconds: the caller waits for one alone.
void HostRoom::start(std::size_t number) {
  if (number == threads_.size() || enough_.load(std::memory_order_relaxed)) return;
  try {
    threads_[number] = std::thread([this, number] {
      start(number + 1);
      touch();
    });
  } catch (const std::exception&) {
    // There is no thread to be had: whoever fills the memory touches the rest.
  }
}

void HostRoom::touch() {
  for (std::size_t i; (i = next_.fetch_add(1, std::memory_order_relaxed)) < blocks_.size();) {
    State state = untouched;
    if (!states_[i].compare_exchange_strong(state, being_touched)) continue;
    for (std::size_t at = 0; at < blocks_[i].bytes; at += to_next(blocks_[i].first + at, page)) {
      if (enough_.load(std::memory_order_relaxed)) break;
      *static_cast<volatile unsigned char*>(blocks_[i].first + at) = 0;
    }
    states_[i] = left;
  }
}

void HostRoom::leave(const Range& range) {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Range& block = blocks_[i];
    if (block.first >= range.first + range.bytes || range.first >= block.first + block.bytes) continue;
    State state = untouched;
    if (states_[i].compare_exchange_strong(state, left)) continue;
    while (states_[i] == being_touched) std::this_thread::yield();  // for as long as a block takes
  }
}

void HostRoom::stop() {
  enough_ = true;
  for (std::thread& thread : threads_)  // once one has ended, the next has been started, or never will be
    if (thread.joinable()) thread.join();
  threads_.clear();
}

}  // namespace gcdt::runtime
