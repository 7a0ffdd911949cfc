// SPDX-License-Identifier: Apache-2.0
// Any set of OpenCL devices, of any platforms, at one batch: each with its own context or the application's, and one or
// more lanes. Contexts cannot span platforms, so everything goes through host memory.
#pragma once

#include "batch/rehearsal.hpp"
#include "batch/schedule.hpp"

namespace gcdt {

/// What a device of a pool has done in the last batch, and whether it still takes part.
struct DeviceReport {
  DeviceInfo info;
  DeviceKind kind = DeviceKind::accelerator;
  std::optional<Error> lost;  ///< why it was taken out
  std::uint64_t problems = 0, vertices = 0, runs = 0;
  double milliseconds = 0;  ///< in runs whose results counted
};

/// A batch's results, and where each problem's are.
struct PoolResult {
  std::vector<ForestResult> results;
  std::vector<Schedule::Place> places;
  std::map<std::uint32_t, Error> errors;  ///< by problem; with one, the place says nothing
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

  std::size_t size() const { return reports_.size(); }
  const DeviceReport& report(std::size_t device) const { return reports_[device]; }

 private:
  /// One stream of runs on a device: a queue, memory, and in calls a thread. While one lane's results go to
  /// the host, and the host puts its next problems together, the device works for another.
  struct Lane {
    std::size_t device = 0;
    std::unique_ptr<runtime::Runtime> runtime;
    std::unique_ptr<Primitives> primitives;
    std::unique_ptr<Staging> staging;  ///< of the runtime
    Speed speed;
    SittingOut sitting_out;
    DeviceReport report;     ///< its part in the last batch
    bool rehearses = false;  ///< before it takes part in the first batch
    Rehearsed rehearsed;
  };
  /// What a lane has made of problems.
  struct Made {
    ForestResult result;
    std::vector<std::pair<std::uint32_t, Error>> errors;  ///< of those that `result` lacks
  };
  /// There is too little memory for one problem of a pack, whatever its size says.
  struct Shortage {
    std::uint32_t problem;
    Error error;
  };
  void open(Member member, std::size_t device);
  bool has_gpus() const;
  std::vector<LaneShare> shares(bool gpus) const;
  void work(std::size_t lane, Schedule& schedule, const BatchInput& batch, const Options& options);
  void rehearse(std::size_t lane, Schedule& schedule, const Options& options);
  void run(std::size_t lane, Schedule& schedule, const std::shared_ptr<Pack>& pack, const BatchInput& batch,
           const Options& options);
  Made make(Lane& lane, const BatchInput& batch, std::vector<std::uint32_t> numbers, const Options& options);
  void give_up(std::size_t number, Schedule& schedule, const std::shared_ptr<Pack>& pack, const Error& error);
  void settle(Lane& lane);
  void lose(std::size_t device, const Error& error);
  void add_reports();
  [[noreturn]] void throw_reasons() const;
  bool all_lost() const;

  std::mutex mutex_;  ///< of callbacks and of losses
  runtime::Log log_;
  Trace trace_;
  std::vector<DeviceReport> reports_;
  std::vector<Lane> lanes_;
};

}  // namespace gcdt
