// SPDX-License-Identifier: Apache-2.0
// The schedule decides which lane triangulates which problems of a batch. It hands out the largest problems first, and
// gives each lane as much as its measured speed says.
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

#include "batch/forest.hpp"
#include "batch/speed.hpp"

namespace gcdt {

/// Problems that a lane triangulates together, in one run.
struct Pack {
  std::vector<std::uint32_t> problems;
  std::uint64_t weight = 0;       ///< vertices and constraints, and `problem_weight` for each problem
  std::atomic<bool> done{false};  ///< set under the schedule's lock, but asked before every launch
  // Under the schedule's lock:
  unsigned runners = 0;                              ///< lanes that are running it
  std::size_t owner = 0;                             ///< the first lane that took it
  std::chrono::steady_clock::time_point began, due;  ///< of the owner's run; `due` is `began` if its speed is unknown
};

/// What the schedule knows of a lane. A lane is one stream of runs on a device.
struct LaneShare {
  std::size_t device = 0;         ///< the lanes of a device are equally fast, share its memory and are lost together
  std::uint64_t capacity = 0;     ///< bytes; the lane takes no problem that needs more
  std::uint64_t most_bytes = 0;   ///< limit for a pack of several problems
  std::uint64_t most_weight = 0;  ///< the same limit as a weight
  Speed speed;                    ///< without the overhead
  double overhead = 0;            ///< milliseconds that every pack takes, whatever it holds
  /// The first pack is this part of a usual one. The lanes of a device begin with different parts, so that they do not
  /// all work on the host, or all on the device, at the same time.
  double first_part = 1;
  bool started = false;             ///< the lane has taken its first pack, or sits out
  bool beside_gpus = false;         ///< the device is a CPU in a pool with GPUs
  bool left_out = false;            ///< the lane was too slow to get more than one pack
  bool lost = false;                ///< the lane takes no more packs
  bool crowded_out = false;         ///< it is lost because another lane of the device needs its memory
  bool ended = false;               ///< its thread is gone; if it was crowded out, its memory is free
  std::set<std::uint32_t> refused;  ///< problems that turned out to need more memory than their sizes say
};

/// One batch on its way. All members may be called by all workers.
///
/// Waiting problems are in a list, the largest first. A lane takes its pack from the front. Its share of the list is
/// what it would get if all lanes were to end together; a pack is most of that share, and all of it when the end is
/// near. So packs become smaller towards the end. A lane that is alone takes as much as fits.
///
/// A CPU beside a much faster GPU takes one small pack a call, so that its speed is measured again, and problems for
/// which the GPU has too little memory.
///
/// When the list is empty, an idle lane steals: it runs a pack of another device too if it would be done sooner. The
/// first result counts, and the other run is cancelled. A pack whose device is lost, or has too little memory, goes
/// back into the list. Every problem is settled once, by the first result of its pack or by an error of its own.
class Schedule {
 public:
  Schedule(const BatchInput& batch, std::vector<LaneShare> lanes);

  /// The next pack for the lane; null if there is nothing left for it. Blocks while other lanes may put a pack back.
  std::shared_ptr<Pack> take(std::size_t lane);
  /// Settles the pack with the lane's result and with the errors of the problems (batch numbers) that the result lacks.
  /// Returns false if another lane was first. `milliseconds`: the time of the run.
  bool finish(std::size_t lane, const std::shared_ptr<Pack>& pack, ForestResult result,
              std::vector<std::pair<std::uint32_t, Error>> errors, double milliseconds);
  /// The device has too little memory for the pack. If other lanes share the device, they take no more packs, and this
  /// lane goes on when they have ended. Otherwise the lane takes only smaller packs from now on.
  /// `problem`: the one problem that needs more memory than its size says; then the lane refuses that problem alone.
  void too_large(std::size_t lane, const std::shared_ptr<Pack>& pack, const Error& error,
                 std::optional<std::uint32_t> problem = {});
  /// The lane's device is lost. `pack`: the lane's pack, or null. Other lanes of the device may finish theirs.
  void lose(std::size_t lane, const std::shared_ptr<Pack>& pack);
  /// The lane gives the pack up, because another lane has done it or the call is cancelled.
  void drop(std::size_t lane, const std::shared_ptr<Pack>& pack);
  /// Every lane calls this last.
  void end(std::size_t lane);
  /// Whether the lane must free its device memory before it ends.
  bool crowded_out(std::size_t lane);
  /// Whether a run of the pack may stop.
  bool needless(const Pack& pack) const { return cancelled() || pack.done; }
  void cancel();
  bool cancelled() const { return cancelled_; }

  /// Waits for a change, or a short time, and returns the share of the work that is settled; 1 when all lanes have
  /// ended.
  double wait();
  Speed speed(std::size_t lane);
  /// Whether the lane was too slow to be of use, so that it got at most one pack.
  bool left_out(std::size_t lane);

  /// Where a problem's result is: which result, and its place there. Valid when all lanes have ended, for problems
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
  std::uint64_t bytes(const Pack& pack) const;
  bool outgrown(std::uint32_t p) const { return outgrown_.count(p) > 0; }
  std::uint64_t weight(std::uint32_t p) const { return batch_.n(p) + batch_.m(p) + Tuning::problem_weight; }
  bool before(std::uint32_t p, std::uint32_t q) const;
  void sort_waiting();
  double speed_of(std::size_t device) const;
  double milliseconds_of_rest(std::size_t lane) const;
  double wanted_weight(std::size_t lane) const;
  bool leaves(std::size_t lane, std::uint32_t p) const;
  bool must_wait(std::size_t lane) const;
  bool crowd_out_others(std::size_t lane);
  std::shared_ptr<Pack> cut(std::size_t lane);
  std::size_t that_fit(const LaneShare& share, std::size_t begin, double most_weight) const;
  static std::chrono::steady_clock::duration remaining(const Pack& pack);
  std::shared_ptr<Pack> steal(std::size_t lane);
  void start(std::size_t lane, const std::shared_ptr<Pack>& pack, bool first);
  void put_back(const std::shared_ptr<Pack>& pack);
  void stop_running(const std::shared_ptr<Pack>& pack);
  void settle(std::uint32_t p, Error error);
  void refuse_what_is_too_large();

  const BatchInput& batch_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<LaneShare> lanes_;
  std::vector<std::uint64_t> bytes_;    ///< bytes that each problem needs by itself
  std::set<std::uint32_t> outgrown_;    ///< problems that need more than their sizes say; each gets a pack of its own
  std::vector<std::uint32_t> waiting_;  ///< largest first
  std::uint64_t waiting_weight_ = 0, weight_ = 0, settled_weight_ = 0, unsettled_ = 0;
  std::list<std::shared_ptr<Pack>> running_;
  std::optional<Error> shortage_;  ///< the last error of too little memory
  std::atomic<bool> cancelled_{false};
};

}  // namespace gcdt
