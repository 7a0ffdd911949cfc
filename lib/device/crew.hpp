// SPDX-License-Identifier: Apache-2.0
// Threads that wait for loops.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace gcdt {

/// As long as it lives, the loops of parts.hpp that its thread makes are shared out to threads that are there already:
/// to begin one takes 40 microseconds, as much as a hundred elements of a loop whose loads miss the caches
/// (bench/NOTES.md, "Tiles"). Loops of other threads begin their own, as without it.
class Crew {
 public:
  /// Threads begin behind its back; so many beside the caller's at most. Fewer, or none, if the system has no more.
  explicit Crew(std::size_t threads);
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;
  ~Crew();

  /// The one that this thread has made, the last of several; null if there is none, or it is in a loop.
  static Crew* of_this_thread();
  /// Calls part(i) for each i below `parts`, by whichever threads come first, the caller's with them. Returns when all
  /// have returned. `part` throws nothing.
  void run(std::size_t parts, const std::function<void(std::size_t)>& part);

 private:
  void work();
  void make_some(std::unique_lock<std::mutex>& lock);

  Crew* const outer_;  ///< of this thread
  std::mutex mutex_;   ///< of all that follows
  std::condition_variable begun_, done_;
  const std::function<void(std::size_t)>* part_ = nullptr;  ///< of the loop that is under way; else null
  std::size_t parts_ = 0, next_ = 0, left_ = 0;             ///< left: parts that have not returned
  bool over_ = false;
  std::vector<std::thread> threads_;  ///< the first one's, which makes the others
  std::thread first_;
};

}  // namespace gcdt
