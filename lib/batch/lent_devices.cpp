// SPDX-License-Identifier: Apache-2.0
// The devices of a pool, lent to who makes something of their own on them.
#include <algorithm>
#include <thread>
#include <utility>

#include "batch/device_pool.hpp"

namespace gcdt {

namespace {

/// As long as it lives, the worker's transfers may use all of the device's link, and it reads as often as a solver
/// does: no other worker's launches go before its own.
class Alone {
 public:
  Alone(runtime::Runtime& runtime, std::uint32_t rounds_per_read)
      : runtime_(runtime), rounds_(std::exchange(runtime.tuning().rounds_per_read, rounds_per_read)) {
    runtime_.set_alone(true);
  }
  Alone(const Alone&) = delete;
  ~Alone() {
    runtime_.set_alone(false);
    runtime_.tuning().rounds_per_read = rounds_;
  }

 private:
  runtime::Runtime& runtime_;
  std::uint32_t rounds_;
};

}  // namespace

bool DevicePool::is_first_of(const Worker& worker, Who who) const {
  const auto is_gpu = [](const Worker& other) { return other.runtime && other.runtime->kind() == DeviceKind::gpu; };
  const auto is_one = [&](const Worker& other) {
    return other.number == 0 && !reports_[other.device].lost &&
           (who == Who::all || is_gpu(other) || std::none_of(workers_.begin(), workers_.end(), is_gpu));
  };
  return is_one(worker) && (who != Who::first || &worker == &*std::find_if(workers_.begin(), workers_.end(), is_one));
}

std::size_t DevicePool::count_of(Who who) const {
  return static_cast<std::size_t>(
      std::count_if(workers_.begin(), workers_.end(), [&](const Worker& worker) { return is_first_of(worker, who); }));
}

PoolResult DevicePool::make_each(const BatchInput& sizes, const Options& options, Who who, const MakeOne& make) {
  return run({sizes, options, &make, who});
}

bool DevicePool::on_each(Who who, const std::function<void(Lent& lent)>& use) {
  const std::vector<DevicePlan> plans = current_plans();
  std::vector<std::thread> threads;
  std::atomic<bool> all{true};
  std::optional<Error> spill_failed;  // no fault of a device; under mutex_
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    if (!is_first_of(workers_[i], who)) continue;
    threads.emplace_back([&, i] {
      Worker& worker = workers_[i];
      Lent lent = {worker.device, *worker.runtime, *worker.primitives, plans[worker.device].capacity,
                   worker.side.get()};
      const Alone alone(*worker.runtime, worker.rounds_alone);
      try {
        use(lent);
        return;
      } catch (const Error& error) {
        settle(worker);
        if (error.status() == Status::spill_failed) {
          const std::lock_guard<std::mutex> lock(mutex_);
          spill_failed = error;
          return;
        }
        lose(worker.device, error);
      } catch (const std::exception& error) {
        settle(worker);
        lose(worker.device, host_failed(error));
      }
      all = false;
    });
  }
  for (std::thread& thread : threads) thread.join();
  rest_sides();
  forget_lost();
  if (spill_failed) throw *spill_failed;
  if (all_lost()) throw_reasons();
  return all;
}

DevicePool::Made DevicePool::make_on_lent(Worker& worker, const std::vector<std::uint32_t>& numbers,
                                          const MakeOne& make, std::uint64_t capacity) {
  Lent lent = {worker.device, *worker.runtime, *worker.primitives, capacity, worker.side.get()};
  const Alone alone(*worker.runtime, worker.rounds_alone);
  return make_one_by_one(worker, numbers, [&](std::uint32_t p) {
    ForestResult one = make(lent, p);
    one.problems = {p};
    return one;
  });
}

DevicePool::Made DevicePool::make_one_by_one(Worker& worker, const std::vector<std::uint32_t>& numbers,
                                             const std::function<ForestResult(std::uint32_t problem)>& make) {
  Made made;
  for (const std::uint32_t p : numbers) {
    try {
      made.result.add(make(p));
    } catch (const Error& error) {
      if (error.status() == Status::out_of_memory) throw Shortage{p, error};
      if (!is_of_problem(error.status())) throw;
      settle(worker);
      made.errors.emplace_back(p, error);
    }
  }
  return made;
}

}  // namespace gcdt
