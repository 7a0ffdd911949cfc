// SPDX-License-Identifier: Apache-2.0
// A pool of OpenCL devices of any platforms that work on one batch. Each device has one or more workers, and a context
// of its own or the application's. Contexts cannot span platforms, so everything goes through host memory.
#pragma once

#include "batch/backoff.hpp"
#include "batch/pool_plan.hpp"
#include "batch/schedule.hpp"
#include "batch/warmup.hpp"
#include "device/pinned_ranges.hpp"
#include "device/side_queue.hpp"

namespace gcdt {

/// What a device of a pool did in the last batch, and whether it still takes part.
struct DeviceReport {
  DeviceInfo info;
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

  /// Where a problem without an error is: a result, and its place there.
  std::pair<const ForestResult*, std::size_t> at(std::size_t problem) const {
    const Schedule::Place place = places[problem];
    return results[place.result].at(place.place);
  }
};

/// The error of a device whose host threw something else.
inline Error host_failed(const std::exception& error) {
  return Error(Status::device_failed, std::string("the host failed it: ") + error.what());
}

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

  /// What a device's first worker lends to who makes something there, on the worker's thread.
  struct Lent {
    std::size_t device;
    runtime::Runtime& runtime;
    Primitives& primitives;
    std::uint64_t capacity;    ///< bytes that may be used at once
    runtime::SideQueue* side;  ///< null: transfers beside other work would gain nothing
  };
  using MakeOne = std::function<ForestResult(Lent& lent, std::uint32_t problem)>;
  /// `gpus`: if there are some that are not lost; else all. `first`: of these the first one, which then has the memory
  /// for it the next time.
  enum class Who { all, gpus, first };
  /// As triangulate(), but each problem is made by `make`, by itself, on one worker a device; of the batch only the
  /// sizes are read, and of the options only the progress. An Error of a problem (is_of_problem()) is the problem's;
  /// others take the device out of the pool. A problem may be made on several devices at once. When it returns, or
  /// throws, nothing goes on in a side queue, but what one has thrown is still there to be waited for.
  PoolResult make_each(const BatchInput& sizes, const Options& options, Who who, const MakeOne& make);
  /// Calls `use` for each device that is not lost, at once. Returns whether all did it: a device that throws an Error
  /// is taken out of the pool. Throws if none is left.
  bool on_each(Who who, const std::function<void(Lent& lent)>& use);
  /// How many devices that is now.
  std::size_t count_of(Who who) const;

  std::size_t size() const { return reports_.size(); }
  /// Where to what devices have no room for goes; empty: to the host's memory.
  const std::string& spill_directory() const { return spill_directory_; }
  void spill_to(std::string directory) { spill_directory_ = std::move(directory); }
  /// Bytes that one problem may need, on the device that has most.
  std::uint64_t capacity() const { return capacities().back(); }
  std::uint64_t least_capacity() const { return capacities().front(); }
  /// Whether a device that is not lost does (Tuning::prepares_host_memory).
  bool prepares_host_memory() const;
  const DeviceReport& report(std::size_t device) const { return reports_[device]; }
  /// What is known to be pinned of the host's memory.
  runtime::PinnedRanges& pinned() { return *pinned_; }
  /// Has results in tiles lie in memory that the driver of a GPU has pinned, which is kept for the next calls'. Nothing
  /// where no device's transfers are prepared (prepares_host_memory()), or the driver has no such memory.
  void pin_results();
  /// Where such memory comes from; null: from the system.
  const std::shared_ptr<HostSource>& result_memory() const { return result_memory_; }

 private:
  /// A worker does one run after the other on a device. It has a queue, memory, and during calls a thread. While the
  /// host copies its results and gathers its next problems, the device works for another worker.
  struct Worker {
    std::size_t device = 0;
    std::uint32_t number = 0;        ///< among the device's workers
    std::uint32_t rounds_alone = 0;  ///< between two reads while the device is lent
    std::unique_ptr<runtime::Runtime> runtime;
    std::unique_ptr<Primitives> primitives;
    std::unique_ptr<Staging> staging;  ///< of the runtime
    /// Of a device's first worker: the queue of its second one, which does nothing while devices are lent.
    std::unique_ptr<runtime::SideQueue> side;
    Throughput throughput;
    Backoff backoff;
    bool warms_up = false;  ///< before it takes part in the first batch
    std::set<WarmupKey> warmed_up;
  };
  /// What a run has made of its problems.
  struct Made {
    ForestResult result;
    std::vector<std::pair<std::uint32_t, Error>> errors;  ///< of those that `result` lacks
  };
  /// One problem of a job needs more memory than there is, though its size does not say so.
  struct Shortage {
    std::uint32_t problem;
    Error error;
  };
  /// A call: what is to be made, and by what, if not by triangulate_forest().
  struct Call {
    const BatchInput& batch;
    const Options& options;
    const MakeOne* make_one;
    Who who;
  };
  void open(Member& member, std::size_t device, const DevicePlan& plan);
  std::vector<DevicePlan> current_plans() const;
  std::vector<DevicePlan> plan();
  std::vector<WorkerState> states(const std::vector<DevicePlan>& plans, const Call& call) const;
  PoolResult run(const Call& call);
  void work(std::size_t worker, Schedule& schedule, const Call& call);
  void warm_up(std::size_t worker, Schedule& schedule, const Options& options);
  void run_job(std::size_t worker, Schedule& schedule, const std::shared_ptr<Job>& job, const Call& call);
  Made make(Worker& worker, const BatchInput& batch, std::vector<std::uint32_t> numbers, const Options& options);
  Made make_forest(Worker& worker, const BatchInput& batch, std::vector<std::uint32_t> numbers, const Options& options);
  ForestResult make_single(Worker& worker, const BatchInput& batch, std::uint32_t problem, const Options& options);
  Made make_on_lent(Worker& worker, const std::vector<std::uint32_t>& numbers, const MakeOne& make,
                    std::uint64_t capacity);
  /// An Error of a problem is the problem's.
  Made make_one_by_one(Worker& worker, const std::vector<std::uint32_t>& numbers,
                       const std::function<ForestResult(std::uint32_t problem)>& make);
  void give_up(std::size_t number, Schedule& schedule, const std::shared_ptr<Job>& job, const Error& error);
  void settle(Worker& worker);
  void lose(std::size_t device, const Error& error);
  /// Of the devices that are not lost, ascending; {0} if all are.
  std::vector<std::uint64_t> capacities() const;
  void forget_lost();
  void rest_sides() const;
  [[noreturn]] void throw_reasons() const;
  bool all_lost() const;
  /// Whether the worker is the first of a device that is one of these, and not lost.
  bool is_first_of(const Worker& worker, Who who) const;

  std::mutex mutex_;  ///< held during callbacks, and while a device is reported as lost
  runtime::Log log_;  ///< takes the mutex, as does the trace
  Trace trace_;
  std::vector<PooledDevice> devices_;
  std::vector<DeviceReport> reports_;
  std::vector<Worker> workers_;
  std::string spill_directory_;
  std::shared_ptr<runtime::PinnedRanges> pinned_ = std::make_shared<runtime::PinnedRanges>();
  std::shared_ptr<HostSource> result_memory_;
};

}  // namespace gcdt
