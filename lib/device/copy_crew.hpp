// SPDX-License-Identifier: Apache-2.0
// Copies in host memory, made by several threads.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

namespace gcdt::runtime {

/// Copies in slots, at most one in each at a time. The thread that begins them makes those that no helper has begun
/// when it waits, so a crew without helpers copies as well. It alone calls the functions below; helpers do nothing but
/// copy.
class CopyCrew {
 public:
  /// `threads`: with the caller; fewer if the system has no more.
  CopyCrew(std::size_t slots, unsigned threads);
  CopyCrew(const CopyCrew&) = delete;
  CopyCrew& operator=(const CopyCrew&) = delete;
  /// Forgets copies that nobody has begun, and waits for the others: then nothing is read or written any more.
  ~CopyCrew();

  struct Copy {
    unsigned char* to;
    const unsigned char* from;
    std::size_t bytes;
    bool past_caches;  ///< nobody on the host reads it soon
  };
  /// The slot must be free.
  void begin(std::size_t slot, const Copy& copy);
  /// Waits until the slot is free.
  void wait(std::size_t slot);
  bool has_helpers() const { return !helpers_.empty(); }

 private:
  void help();
  void make_next(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;  ///< of all but helpers_
  std::condition_variable begun_, done_;
  std::deque<std::pair<std::size_t, Copy>> waiting_;
  std::vector<bool> busy_;
  bool over_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace gcdt::runtime
