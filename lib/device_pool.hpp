// SPDX-License-Identifier: Apache-2.0
// Any set of OpenCL devices, of any platforms, at one batch: each with its own context or the application's, queue,
// memory, programs, and thread. Contexts cannot span platforms, so everything goes through host memory.
#pragma once

#include "schedule.hpp"

namespace gcdt {

/// What a device of a pool has done in the last batch, and whether it still takes part.
struct DeviceReport {
  DeviceInfo info;
  std::optional<Error> lost;  ///< why it was taken out
  std::uint64_t problems = 0, vertices = 0, runs = 0;
  double milliseconds = 0;  ///< in runs whose results counted
};

/// A batch's results, and where each problem's are.
struct PoolResult {
  std::vector<ForestResult> results;
  std::vector<Schedule::Place> places;
  std::vector<std::optional<Error>> errors;  ///< by problem; with one, the place says nothing
  double milliseconds = 0;
};

class DevicePool {
 public:
  struct Member {
    cl::Context context;  ///< null: one of its own
    cl::Device device;
    runtime::CallHook hook;
  };
  /// Devices that fail from the start are taken out and reported. Throws as triangulate() if all do.
  /// `log` and `trace` are called by workers, one at a time.
  DevicePool(std::vector<Member> members, runtime::Log log, Trace trace);

  /// Blocks. Throws invalid_argument (a bad fixed grid), cancelled, and, if no device is left, device_failed, or the
  /// status that all failed with, naming every device's reason.
  PoolResult triangulate(const BatchInput& batch, const Options& options);

  std::size_t size() const { return workers_.size(); }
  const DeviceReport& report(std::size_t device) const { return workers_[device].report; }

 private:
  struct Worker {
    std::unique_ptr<runtime::Runtime> runtime;
    std::unique_ptr<Primitives> primitives;
    DeviceReport report;
    double speed = 0;
  };
  void work(std::size_t device, Schedule& schedule, const BatchInput& batch, const Options& options);
  void run(std::size_t device, Schedule& schedule, const std::shared_ptr<Pack>& pack, const BatchInput& batch,
           const Options& options);
  void settle(Worker& worker);
  void lose(Worker& worker, const Error& error);
  [[noreturn]] void throw_reasons() const;
  bool all_lost() const;

  std::mutex callbacks_;
  runtime::Log log_;
  Trace trace_;
  std::vector<Worker> workers_;
};

}  // namespace gcdt
