// SPDX-License-Identifier: Apache-2.0
// The schedule decides which worker triangulates which problems of a batch. It hands out the largest problems first,
// and gives each worker as much as its measured throughput says.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>

#include "batch/pipeline.hpp"
#include "batch/pool_plan.hpp"
#include "batch/throughput.hpp"

namespace gcdt {

/// Problems that a worker triangulates together, in one run.
struct Job {
  std::vector<std::uint32_t> problems;
  std::uint64_t weight = 0;       ///< vertices and constraints, and `problem_weight` for each problem
  std::atomic<bool> done{false};  ///< set under the schedule's lock, but asked before every launch
  // Under the schedule's lock:
  unsigned runners = 0;   ///< workers that are running it
  std::size_t owner = 0;  ///< the first worker that took it
  std::chrono::steady_clock::time_point began,
      due;  ///< of the owner's run; `due` is `began` if the throughput is unknown
};

/// What the schedule knows of a worker, which does one run after the other on its device.
struct WorkerState {
  std::size_t device = 0;  ///< the workers of a device are equally fast, share its memory and are lost together
  DevicePlan plan;         ///< the worker's; `capacity` shrinks when the device turns out to have less memory
  Throughput throughput;   ///< without the overhead
  /// The first job is this part of a usual one. The workers of a device begin with different parts, so that they do not
  /// all work on the host, or all on the device, at the same time.
  double first_part = 1;
  bool started = false;   ///< the worker has taken its first job, or sits this call out
  bool too_slow = false;  ///< the worker was too slow to be of use, and got at most one job
  bool lost = false;      ///< the worker takes no more jobs
  bool evicted = false;   ///< the worker is lost, and must free its memory, which another worker of the device needs
  bool ended = false;     ///< the worker's thread is gone; if it was evicted, its memory is free
  std::set<std::uint32_t> refused;  ///< problems that turned out to need more memory than their sizes say
};

/// One batch on its way. All members may be called by all workers.
///
/// Waiting problems are in a list, the largest first. A worker takes its job from the front of the list. Its share of
/// the list is what it would get if all workers ended together. Its job is most of that share, and all of it when the
/// end is near. So jobs become smaller towards the end. If there is only one worker, it takes as much as fits.
///
/// A CPU beside a much faster GPU takes one small job a call, so that its throughput is measured again. It also
/// takes problems for which the GPU has too little memory.
///
/// When the list is empty, an idle worker steals a job: it runs the job of another device too, if it would be done
/// sooner. The first result counts, and the other run is cancelled. If a device is lost or has too little memory, its
/// job goes back into the list. Every problem is settled once, by the first result of its job or by an error of its
/// own.
class Schedule {
 public:
  Schedule(const BatchInput& batch, std::vector<WorkerState> workers);

  /// The next job for the worker; null if there is nothing left for it. Blocks while other workers may put a job back.
  std::shared_ptr<Job> take(std::size_t worker);
  /// Settles the job with the worker's result, and with the errors of the problems that the result lacks, by their
  /// numbers in the batch. Returns false if another worker was first. `milliseconds`: the time of the run.
  bool finish(std::size_t worker, const std::shared_ptr<Job>& job, ForestResult result,
              std::vector<std::pair<std::uint32_t, Error>> errors, double milliseconds);
  /// The device has too little memory for the job. If other workers share the device, they are evicted: they take no
  /// more jobs, and this worker goes on when they have ended. Otherwise the worker takes only smaller jobs from now on.
  /// `problem`: the one problem that needs more memory than its size says; then the worker refuses only that problem.
  void too_large(std::size_t worker, const std::shared_ptr<Job>& job, const Error& error,
                 std::optional<std::uint32_t> problem = {});
  /// The worker's device is lost. `job`: the worker's job, or null. Other workers of the device may finish theirs.
  void lose(std::size_t worker, const std::shared_ptr<Job>& job);
  /// The worker gives the job up, because another worker has done it or the call is cancelled.
  void drop(std::size_t worker, const std::shared_ptr<Job>& job);
  /// Every worker calls this last.
  void end(std::size_t worker);
  /// What has become of the worker.
  WorkerState state(std::size_t worker);
  /// Whether a run of the job may stop.
  bool needless(const Job& job) const { return cancelled() || job.done; }
  void cancel();
  bool cancelled() const { return cancelled_; }

  /// Waits for a change, or a short time. Returns the share of the work that is settled, and 1 when all workers have
  /// ended.
  double wait();

  /// Where a problem's result is: which result, and its place there. Valid when all workers have ended, for problems
  /// without an error.
  struct Place {
    std::uint32_t result = 0, place = 0;
  };
  std::vector<ForestResult> results;
  std::vector<Place> places;
  std::map<std::uint32_t, Error> errors;
  std::uint64_t unsettled() const { return unsettled_; }

 private:
  using Lock = std::unique_lock<std::mutex>;
  std::uint64_t bytes(std::uint32_t p) const { return bytes_[p]; }
  std::uint64_t bytes(const Job& job) const;
  bool outgrown(std::uint32_t p) const { return outgrown_.count(p) > 0; }
  std::uint64_t weight(std::uint32_t p) const { return batch_.n(p) + batch_.m(p) + Tuning::problem_weight; }
  bool is_before(std::uint32_t p, std::uint32_t q) const;
  void sort_waiting();
  double throughput_of(std::size_t device) const;
  double milliseconds_of_rest(std::size_t worker) const;
  double wanted_weight(std::size_t worker) const;
  bool leaves_to_gpu(std::size_t worker, std::uint32_t p) const;
  bool must_wait(std::size_t worker) const;
  bool evict_others(std::size_t worker);
  std::shared_ptr<Job> take_waiting(std::size_t worker);
  std::size_t count_that_fit(const WorkerState& state, std::size_t begin, double most_weight) const;
  static std::chrono::steady_clock::duration remaining(const Job& job);
  std::shared_ptr<Job> steal(std::size_t worker);
  void start(std::size_t worker, const std::shared_ptr<Job>& job, bool first);
  void put_back(const std::shared_ptr<Job>& job);
  void stop_running(const std::shared_ptr<Job>& job);
  void settle(std::uint32_t p, Error error);
  void refuse_what_is_too_large();

  const BatchInput& batch_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<WorkerState> workers_;
  std::vector<std::uint64_t> bytes_;    ///< bytes that each problem needs by itself
  std::set<std::uint32_t> outgrown_;    ///< problems that need more than their sizes say; each gets a job of its own
  std::vector<std::uint32_t> waiting_;  ///< largest first
  std::uint64_t waiting_weight_ = 0, weight_ = 0, settled_weight_ = 0, unsettled_ = 0;
  std::list<std::shared_ptr<Job>> running_;
  std::optional<Error> shortage_;  ///< the last error of too little memory
  std::atomic<bool> cancelled_{false};
};

}  // namespace gcdt
