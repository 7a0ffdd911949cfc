// SPDX-License-Identifier: Apache-2.0
// Programs that have been built in a context, and threads that build some before they are needed.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "device/device_memory.hpp"
#include "device/programs.hpp"

namespace gcdt::runtime {

class Runtime;

/// What has been built in a context for a device. Threads share it.
class BuiltPrograms {
 public:
  using Key = std::pair<std::string, Meshes>;  ///< its name, and what its meshes hold

  /// The program, which `build` makes if nobody has. Blocks while another thread builds it, or while `most` others are
  /// being built. Throws what `build` throws; then the next one tries again.
  const cl::Program& get(const Key& key, unsigned most, const std::function<cl::Program()>& build);
  bool has(const Key& key);
  void clear();

 private:
  std::mutex mutex_;
  std::condition_variable ended_;  ///< a build has
  std::map<Key, cl::Program> built_;
  std::set<Key> begun_;
};

/// While it lives, calls go without programs that only save time, where the driver of a GPU would have to compile all
/// that a call needs: it takes longer for them than they save. What a call does then is slower, its result the same.
class SparedPrograms {
 public:
  /// `may`: nothing is spared otherwise, as for inputs that are large.
  SparedPrograms(Runtime& runtime, bool may);
  SparedPrograms(const SparedPrograms&) = delete;
  SparedPrograms& operator=(const SparedPrograms&) = delete;
  ~SparedPrograms();

 private:
  Runtime& runtime_;
};

/// Builds programs by threads of its own while a call is under way, which needs them one after the other: where a
/// driver compiles a program when it is built, some at once take less than all in turn (bench/NOTES.md, "First call").
/// What is built or kept in the cache is left to the call. Errors are: it tries again, and tells them.
class Builders {
 public:
  /// In the order in which the call needs them. As many threads as Runtime::most_builds() allows beside the caller's.
  Builders(Runtime& runtime, const std::vector<const char*>& programs);
  Builders(const Builders&) = delete;
  Builders& operator=(const Builders&) = delete;
  /// Begins no more, and waits for those under way: a process must not end while its driver compiles.
  ~Builders();

 private:
  std::vector<const char*> programs_;
  std::atomic<std::size_t> next_{0};
  std::vector<std::thread> threads_;
};

}  // namespace gcdt::runtime
