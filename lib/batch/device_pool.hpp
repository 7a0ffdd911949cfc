// SPDX-License-Identifier: Apache-2.0
// A pool of OpenCL devices of any platforms that work on one batch. Each device has a context, its own or the
// application's, and one or more lanes. Contexts cannot span platforms, so everything goes through host memory.
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
  double milliseconds = 0;  ///< the time of the runs whose results counted
};

/// A batch's results, and for each problem where its result is.
struct PoolResult {
  std::vector<ForestResult> results;
  std::vector<Schedule::Place> places;
  std::map<std::uint32_t, Error> errors;  ///< by problem; the place of a problem with an error means nothing
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
  /// One stream of runs on a device. It has a queue, memory, and during calls a thread. While the host copies a lane's
  /// results and gathers its next problems, the device works for another lane.
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
  /// What a run has made of its problems.
  struct Made {
    ForestResult result;
    std::vector<std::pair<std::uint32_t, Error>> errors;  ///< of those that `result` lacks
  };
  /// One problem of a pack needs more memory than there is, though its size does not say so.
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

  std::mutex mutex_;  ///< held during callbacks, and while a device is reported as lost
  runtime::Log log_;
  Trace trace_;
  std::vector<DeviceReport> reports_;
  std::vector<Lane> lanes_;
};

}  // namespace gcdt
