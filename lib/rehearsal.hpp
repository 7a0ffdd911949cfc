// SPDX-License-Identifier: Apache-2.0
// Work that nobody waits for, so that what a driver compiles when it first launches a kernel (PoCL: seconds) is
// compiled before a batch depends on it.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <set>

#include "forest.hpp"

namespace gcdt {

/// Problems that take a lane through all that others may: of 40 vertices each, two of them equal, with a constraint
/// that crosses edges and has a vertex inside, one that overlaps it, one of length 0, and in every fourth one that
/// crosses.
class RehearsalBatch {
 public:
  explicit RehearsalBatch(std::uint32_t problems);
  BatchInput view() const;

 private:
  std::vector<std::array<double, 2>> vertices_;
  std::vector<Constraint> constraints_;
  std::vector<std::uint64_t> vertex_offsets_ = {0}, constraint_offsets_ = {0};
};

/// Runs of a lane in a thread of its own, each once for the options that decide which kernels there are.
class Rehearsal {
 public:
  /// What to run; may throw. It has to end soon after `stop` became true.
  using Run = std::function<void(const Options& options, const std::atomic<bool>& stop)>;
  Rehearsal() = default;
  Rehearsal(const Rehearsal&) = delete;
  Rehearsal& operator=(const Rehearsal&) = delete;
  ~Rehearsal() { end(); }

  /// Starts the run, unless one is under way or has been made for such options.
  void start(const Options& options, const Run& run);
  /// Waits so long at most; whether no run is under way. Throws what the last one threw, once.
  bool wait(std::chrono::milliseconds most);
  /// Stops the run and waits for it.
  void end();

 private:
  std::atomic<bool> stop_{false};
  std::future<void> run_;
  std::set<std::array<int, 3>> made_;
};

}  // namespace gcdt
