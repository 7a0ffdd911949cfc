// SPDX-License-Identifier: Apache-2.0
// Who triangulates what: a batch's problems shared out to the lanes of devices, largest first, by measured speed.
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

/// Problems that go to a lane together.
struct Pack {
  std::vector<std::uint32_t> problems;
  std::uint64_t weight = 0;       ///< vertices and constraints, and `problem_weight` for each problem
  std::atomic<bool> done{false};  ///< set under the schedule's lock, but asked before every launch
  // Under the schedule's lock:
  unsigned runners = 0;                              ///< lanes at it
  std::size_t owner = 0;                             ///< the lane that took it first
  std::chrono::steady_clock::time_point began, due;  ///< when the owner did, and should be done; both if nobody knows
};

/// What a lane, one stream of runs on a device, is to the schedule.
struct LaneShare {
  std::size_t device = 0;         ///< lanes of one device are alike, share its memory and are lost together
  std::uint64_t capacity = 0;     ///< bytes; a problem that needs more is not taken
  std::uint64_t most_bytes = 0;   ///< of a pack of several problems
  std::uint64_t most_weight = 0;  ///< likewise
  Speed speed;                    ///< as far as it is known, beside the overhead
  double overhead = 0;            ///< milliseconds that a pack takes whatever is in it
  /// Its first pack is this much of what it would take: lanes of a device that begin with different ones do not stay in
  /// step, all of them on the host or all on the device.
  double first_part = 1;
  bool started = false;             ///< has taken its first pack, or sits out
  bool beside_gpus = false;         ///< of a CPU in a pool with GPUs
  bool left_out = false;            ///< was too slow for more than one pack
  bool lost = false;                ///< takes nothing any more
  bool crowded_out = false;         ///< since another lane of the device needs its memory
  bool ended = false;               ///< is gone, and so is its memory if it was crowded out
  std::set<std::uint32_t> refused;  ///< problems that turned out to need more
};

/// One batch on its way. All members may be called by all workers.
///
/// A lane takes from the front of a list in order of size, most of what it would have of the rest if that were shared
/// out so that all lanes end together (if it is alone, all that it can take at once), so packs shrink towards the end;
/// when the end is near, all of that. A CPU beside a much faster GPU takes one small pack a call, to be measured again,
/// and what the GPU has no memory for. When the list is empty a lane that would be done with a pack before the other
/// device that has it takes it as well; the first result counts, the other run is cancelled. A pack that comes back,
/// since its device is lost or has too little memory, goes into the list again. Every problem is settled once: by the
/// first result of its pack, or by an error of its own.
class Schedule {
 public:
  Schedule(const BatchInput& batch, std::vector<LaneShare> lanes);

  /// The next pack for the lane; null when nothing is left to do for it. Blocks while others may bring work back.
  std::shared_ptr<Pack> take(std::size_t lane);
  /// The lane's result for the pack, with the errors of problems (batch numbers) that it lacks. False if another was
  /// first. `milliseconds`: what the run took.
  bool finish(std::size_t lane, const std::shared_ptr<Pack>& pack, ForestResult result,
              std::vector<std::pair<std::uint32_t, Error>> errors, double milliseconds);
  /// The device has too little memory for it. If other lanes share that, they take nothing any more, and this one goes
  /// on when they have ended; else it takes only smaller ones from now on.
  /// `problem`: the one of the pack that needs so much, whatever its size says; then only that is not taken again.
  void too_large(std::size_t lane, const std::shared_ptr<Pack>& pack, const Error& error,
                 std::optional<std::uint32_t> problem = {});
  /// The device of the lane is lost; the lane may have a pack, and others of the device may end theirs.
  void lose(std::size_t lane, const std::shared_ptr<Pack>& pack);
  /// Given up, since the pack is done or all is cancelled.
  void drop(std::size_t lane, const std::shared_ptr<Pack>& pack);
  /// The last that a lane calls.
  void end(std::size_t lane);
  /// Whether the lane has to give its memory back before it ends.
  bool crowded_out(std::size_t lane);
  /// Whether a run of the pack may stop.
  bool needless(const Pack& pack) const { return cancelled() || pack.done; }
  void cancel();
  bool cancelled() const { return cancelled_; }

  /// Waits for an event, but not long, and returns the share of the work that is settled; 1 when all lanes have ended.
  double wait();
  Speed speed(std::size_t lane);
  /// Whether the lane was left out of the batch, or would have been after its first pack.
  bool left_out(std::size_t lane);

  /// By problem, when all lanes have ended: the result and its place there, unless there is an error.
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
  std::vector<std::uint64_t> bytes_;    ///< that each problem needs alone
  std::set<std::uint32_t> outgrown_;    ///< those that need more than their sizes say: they go by themselves
  std::vector<std::uint32_t> waiting_;  ///< largest first
  std::uint64_t waiting_weight_ = 0, weight_ = 0, settled_weight_ = 0, unsettled_ = 0;
  std::list<std::shared_ptr<Pack>> running_;
  std::optional<Error> shortage_;  ///< the last one
  std::atomic<bool> cancelled_{false};
};

}  // namespace gcdt
