// SPDX-License-Identifier: Apache-2.0
// Copies in host memory, made by several threads.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

namespace gcdt::runtime {

/// Copies in slots, at most one in each at a time, each made in pieces by all threads that are free: so the first and
/// the last of many do not wait for one thread. The thread that begins them makes pieces that no helper has begun when
/// it waits, so a crew without helpers copies as well. It alone calls the functions below; helpers do nothing but copy.
/// Starting one takes some tens of microseconds, and so does its end: they are started one by one, as copies are
/// begun that none waits for, and sleep until there are others.
class CopyCrew {
 public:
  explicit CopyCrew(std::size_t slots) : left_(slots) {}
  CopyCrew(const CopyCrew&) = delete;
  CopyCrew& operator=(const CopyCrew&) = delete;
  /// Ends the helpers, after forget().
  ~CopyCrew();

  /// Starts no helper for the next copies if there are so many threads already, the caller included. There are fewer if
  /// the system has no more.
  void limit(unsigned threads);
  /// Whether there are helpers, or will be.
  bool has_helpers() const { return std::max(helpers_.size(), most_helpers_) > 0; }

  struct Copy {
    unsigned char* to;
    const unsigned char* from;
    std::size_t bytes;
    /// Nobody on the host reads it soon, and the system may have pages of it yet to clear: two threads that come to one
    /// for the first time clear it twice, and pages may be of 2 MiB. So while others wait it is made whole.
    bool to_caller;
  };
  /// The slot must be free.
  void begin(std::size_t slot, const Copy& copy);
  /// Waits until the slot is free.
  void wait(std::size_t slot);
  /// Drops pieces that nobody has begun, and waits for the others: then nothing is read or written any more, and all
  /// slots are free.
  void forget();

 private:
  void start_helper();
  void help();
  void make_next(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;  ///< of all but the helpers
  std::condition_variable begun_, done_;
  struct Waiting {
    std::size_t slot;
    Copy rest;  ///< that nobody has begun
  };
  std::deque<Waiting> waiting_;
  std::vector<std::size_t> left_;  ///< bytes of each slot's copy that have not been copied
  std::size_t idle_ = 0;           ///< helpers that wait for a copy
  bool over_ = false;
  std::size_t most_helpers_ = 0;  ///< to be started
  std::vector<std::thread> helpers_;
};

/// A crew during one transfer. When that ends, or throws, nothing is read or written any more.
struct CrewAtWork {
  CopyCrew& crew;
  CrewAtWork(CopyCrew& whole, unsigned threads) : crew(whole) { crew.limit(threads); }
  CrewAtWork(const CrewAtWork&) = delete;
  CrewAtWork& operator=(const CrewAtWork&) = delete;
  ~CrewAtWork() { crew.forget(); }
};

}  // namespace gcdt::runtime
