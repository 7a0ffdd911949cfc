// SPDX-License-Identifier: Apache-2.0
// New memory of the host's, made ready while a device works.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace gcdt::runtime {

/// Threads that write a byte to each page of some memory. The system clears a new page when it is first written, which
/// takes longer than the copy that fills it (bench/NOTES.md, "Batches"). The contents are undefined afterwards, and
/// nobody else may use the memory meanwhile.
class HostRoom {
 public:
  struct Range {
    unsigned char* first;
    std::size_t bytes;
  };
  /// Touches nothing.
  HostRoom() = default;
  /// The ranges in their order. Fewer threads, or none, if the system has no more.
  HostRoom(const std::vector<Range>& ranges, unsigned threads);
  HostRoom(const HostRoom&) = delete;
  HostRoom& operator=(const HostRoom&) = delete;
  ~HostRoom() { stop(); }
  /// Leaves a part of the memory alone: from now on it is the caller's, touched or not.
  void leave(const Range& range);
  /// Ends the threads, which is soon, whether all pages are touched or not. From then on nothing is written.
  void stop();

 private:
  void start(std::size_t number);
  void touch();

  enum State : unsigned char { untouched, being_touched, left };
  std::vector<Range> blocks_;
  std::vector<std::atomic<State>> states_;  ///< of the blocks
  std::atomic<std::size_t> next_{0};        ///< of the blocks
  std::atomic<bool> enough_{false};
  std::vector<std::thread> threads_;
};

}  // namespace gcdt::runtime
