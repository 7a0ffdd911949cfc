// SPDX-License-Identifier: Apache-2.0
#include "batch/device_pool.hpp"

#include <algorithm>
#include <numeric>
#include <thread>
#include <utility>

#include "batch/single.hpp"
#include "device/pinned_store.hpp"
#include "device/step.hpp"
#include "mesh/grid.hpp"
#include "solve/refine.hpp"

namespace gcdt {

DevicePool::DevicePool(std::vector<Member> members, runtime::Log log, Trace trace) : reports_(members.size()) {
  if (members.empty()) throw Error(Status::no_device, "a pool without devices");
  if (log)
    log_ = [this, log = std::move(log)](int level, const char* message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      log(level, message);
    };
  if (trace)
    trace_ = [this, trace = std::move(trace)](const TraceSpan& span) {
      const std::lock_guard<std::mutex> lock(mutex_);
      trace(span);
    };
  for (const Member& member : members) {
    const Tuning& tuning = member.hook.tuning;
    const DeviceInfo info = runtime::describe(member.device, tuning);
    devices_.push_back(
        {runtime::kind_of(info, tuning), info.memory_bytes, info.compute_units, bool(member.context()), false, tuning});
  }
  const std::vector<DevicePlan> plans = plan_pool(devices_);
  for (std::size_t i = 0; i < members.size(); ++i) {
    try {
      Member& member = members[i];
      if (plans[i].cores_left > 0) member.device = runtime::part_of(member.device, plans[i].cores_left);
      reports_[i].info = runtime::describe(member.device, member.hook.tuning);
      devices_[i].memory_bytes = reports_[i].info.memory_bytes;
      open(member, i, plans[i]);
    } catch (const Error& error) {
      lose(i, error);
    }
  }
  if (all_lost()) throw_reasons();
}

void DevicePool::open(Member& member, std::size_t device, const DevicePlan& plan) {
  const std::uint32_t rounds_alone = std::exchange(member.hook.tuning.rounds_per_read, plan.rounds_per_read);
  const auto devices = static_cast<std::uint32_t>(reports_.size()), first = static_cast<std::uint32_t>(device);
  for (std::uint32_t number = 0; number < plan.workers; ++number) {
    Worker worker;
    worker.device = device;
    worker.number = number;
    worker.rounds_alone = rounds_alone;
    if (plan.shares_context && number > 0)
      worker.runtime = std::make_unique<runtime::Runtime>(*workers_.back().runtime, log_, trace_);
    else
      worker.runtime = std::make_unique<runtime::Runtime>(member.context, member.device, member.hook, log_, trace_);
    worker.runtime->know_pinned(pinned_);
    if (plan.polls) worker.runtime->share_context();
    worker.runtime->time_steps(worker.runtime->tracer().on());
    worker.runtime->tracer().set_worker(first + number * devices, number);
    worker.primitives = std::make_unique<Primitives>(*worker.runtime);
    worker.staging = std::make_unique<Staging>(*worker.runtime);
    if (plan.shares_context && number == 1 && runtime::prepares_host_memory(*worker.runtime))
      workers_.back().side = std::make_unique<runtime::SideQueue>(*worker.runtime);
    workers_.push_back(std::move(worker));
  }
}

bool DevicePool::all_lost() const {
  return std::all_of(reports_.begin(), reports_.end(), [](const DeviceReport& r) { return r.lost.has_value(); });
}

/// Of all that are lost; where a call was for GPUs alone, others may be left.
void DevicePool::throw_reasons() const {
  std::optional<Status> status;
  std::int32_t code = 0;
  std::string message = "no device of the pool is left:";
  for (const DeviceReport& report : reports_) {
    if (!report.lost) continue;
    if (!status) status = report.lost->status(), code = report.lost->opencl_code();
    if (report.lost->status() != *status) status = Status::device_failed;
    if (report.lost->opencl_code() != code) code = 0;
    message += "\n  " + report.info.name + " (" + report.info.platform + "): " + report.lost->what();
  }
  throw Error(status.value_or(Status::device_failed), message, {}, 0, code);
}

void DevicePool::lose(std::size_t device, const Error& error) {
  DeviceReport& report = reports_[device];
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (report.lost) return;  // another worker has given the reason
    report.lost = error;
  }
  if (log_) log_(GCDT_LOG_WARNING, (report.info.name + " is taken out of the pool: " + error.what()).c_str());
}

std::vector<DevicePlan> DevicePool::current_plans() const {
  std::vector<PooledDevice> devices = devices_;
  for (std::size_t i = 0; i < devices.size(); ++i) devices[i].lost = reports_[i].lost.has_value();
  return plan_pool(devices);
}

// Tells the plan in the log, and in the trace as a span of no length of each device's first worker.
std::vector<DevicePlan> DevicePool::plan() {
  std::vector<DevicePlan> plans = current_plans();
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    texts.push_back(reports_[i].lost ? "taken out of the pool" : plans[i].text());
    if (log_) log_(GCDT_LOG_INFORMATION, ("pool plan: " + texts[i]).c_str());
  }
  for (const Worker& worker : workers_)
    if (worker.number == 0 && worker.runtime) worker.runtime->tracer().note("plan", texts[worker.device]);
  return plans;
}

std::vector<WorkerState> DevicePool::states(const std::vector<DevicePlan>& plans, const Call& call) const {
  std::vector<WorkerState> all;
  for (const Worker& worker : workers_) {
    const DevicePlan& plan = plans[worker.device];
    WorkerState state;
    state.device = worker.device;
    state.plan = plan;
    state.throughput = worker.throughput;
    state.first_part = (worker.number + 1) / static_cast<double>(plan.workers);
    state.started = plan.beside_gpus && worker.backoff.sits_out();
    state.lost = state.ended = reports_[worker.device].lost || (call.make_one && !is_first_of(worker, call.who));
    if (call.make_one) state.plan.job_weight = 0;  // one problem a job
    all.push_back(state);
  }
  return all;
}

void DevicePool::pin_results() {
  for (const Worker& worker : workers_) {
    if (!worker.runtime || !runtime::prepares_host_memory(*worker.runtime)) continue;
    auto own = std::make_unique<runtime::Runtime>(*worker.runtime, runtime::Log(), Trace());
    result_memory_ = std::make_shared<runtime::PinnedStore>(std::move(own), pinned_);
    return;
  }
}

bool DevicePool::prepares_host_memory() const {
  return std::any_of(workers_.begin(), workers_.end(), [](const Worker& worker) {
    return worker.runtime && runtime::prepares_host_memory(*worker.runtime);
  });
}

std::vector<std::uint64_t> DevicePool::capacities() const {
  const std::vector<DevicePlan> plans = current_plans();
  std::vector<std::uint64_t> all;
  for (std::size_t i = 0; i < plans.size(); ++i)
    if (!reports_[i].lost) all.push_back(plans[i].capacity);
  if (all.empty()) all.push_back(0);
  std::sort(all.begin(), all.end());
  return all;
}

PoolResult DevicePool::triangulate(const BatchInput& batch, const Options& options) {
  // Checked here, so that no device is blamed for it.
  check_seeds(options, batch.problems);
  if (options.grid) fixed_grid(*options.grid);
  if (options.refine)
    check_refinement(*options.refine, options, batch.problems > 0 ? batch.vertex_offsets[batch.problems] : 0);
  return run({batch, options, nullptr, Who::all});
}

PoolResult DevicePool::run(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  if (all_lost()) throw_reasons();
  const std::vector<DevicePlan> plans = plan();
  for (Worker& worker : workers_) {
    worker.warms_up = plans[worker.device].warms_up && !call.make_one;
    if (call.make_one && worker.number > 0 && worker.runtime) {  // the first one needs the memory
      worker.primitives->release();
      worker.runtime->memory().trim();
    }
  }
  for (DeviceReport& report : reports_) report = {report.info, report.lost};
  const std::vector<WorkerState> states = this->states(plans, call);
  Schedule schedule(call.batch, states);
  std::vector<std::thread> threads;
  const auto join = [&] {
    for (std::thread& thread : threads) thread.join();
    rest_sides();
  };
  bool wanted = true;
  try {
    for (std::size_t i = 0; i < workers_.size(); ++i)
      if (!states[i].lost) threads.emplace_back([&, i] { work(i, schedule, call); });
    for (double done = 0; done < 1 && wanted;) {
      done = schedule.wait();
      if (call.options.progress) wanted = call.options.progress("batch", done);
    }
    if (!wanted) schedule.cancel();
  } catch (...) {
    schedule.cancel();
    join();
    throw;
  }
  join();
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    const WorkerState state = schedule.state(i);
    workers_[i].throughput = state.throughput;
    workers_[i].backoff.next_call(state.too_slow);
  }
  forget_lost();
  if (!wanted) throw Error(Status::cancelled, "cancelled during batch");
  if (schedule.unsettled() > 0) throw_reasons();
  return {std::move(schedule.results), std::move(schedule.places), std::move(schedule.errors),
          milliseconds_since(start)};
}

void DevicePool::forget_lost() {
  for (Worker& worker : workers_)
    if (reports_[worker.device].lost)
      worker.side.reset(), worker.staging.reset(), worker.primitives.reset(), worker.runtime.reset();
}

void DevicePool::rest_sides() const {
  for (const Worker& worker : workers_)
    if (worker.side) worker.side->rest();
}

// A worker's thread. It ends when the schedule has nothing left for the worker, or when the device is lost.
void DevicePool::work(std::size_t number, Schedule& schedule, const Call& call) {
  Worker& worker = workers_[number];
  if (worker.warms_up && !call.options.refine && !worker.backoff.sits_out() &&
      worker.warmed_up.count(warmup_key(call.options)) == 0)
    warm_up(number, schedule, call.options);
  while (const std::shared_ptr<Job> job = schedule.take(number)) {
    try {
      run_job(number, schedule, job, call);
    } catch (const Shortage& shortage) {
      settle(worker);
      worker.runtime->memory().trim();
      schedule.too_large(number, job, shortage.error, shortage.problem);
    } catch (const Error& error) {
      settle(worker);
      if (error.status() == Status::cancelled) {
        schedule.drop(number, job);
      } else if (error.status() == Status::out_of_memory) {
        worker.runtime->memory().trim();
        schedule.too_large(number, job, error);
      } else {
        give_up(number, schedule, job, error);
      }
    } catch (const std::exception& error) {
      give_up(number, schedule, job, host_failed(error));
    }
  }
  if (schedule.state(number).evicted) {
    worker.primitives->release();
    worker.runtime->memory().trim();
  }
  worker.runtime->give_up_when({});
  worker.staging->offsets = {};
  schedule.end(number);
}

// Takes the worker's device out of the pool. Its job, if it has one, goes to other devices.
void DevicePool::give_up(std::size_t number, Schedule& schedule, const std::shared_ptr<Job>& job, const Error& error) {
  lose(workers_[number].device, error);
  schedule.lose(number, job);
}

// After an error: waits until nothing is left in the queue, and forgets what was under way.
void DevicePool::settle(Worker& worker) {
  runtime::Runtime& runtime = *worker.runtime;
  runtime.attempt("clFinish", "after an error", [&] { return runtime.try_finish(); });
  runtime.tracer().clear();
  worker.staging->chunks.forget();
  worker.primitives->release();
}

// Launches all kernels that the worker may need, while other workers do the work. Too little memory is no error here,
// because a job that needs it will report it.
void DevicePool::warm_up(std::size_t number, Schedule& schedule, const Options& options) {
  Worker& worker = workers_[number];
  const FewAsMany few_as_many(worker.runtime->tuning());
  Options own;
  own.crossing = options.crossing;
  own.domain = options.domain;
  own.regions = options.regions;
  worker.runtime->give_up_when([&schedule] { return schedule.cancelled(); });
  try {
    for (const std::vector<std::uint32_t>& vertices :
         warmup_runs(worker.runtime->info().compute_units, options.crossing)) {
      const WarmupBatch batch(vertices);
      std::vector<std::uint32_t> all(vertices.size());
      std::iota(all.begin(), all.end(), 0u);
      make(worker, batch.view(), std::move(all), own);
    }
    // Few pieces, of which all pairs are compared; beside a larger problem, so that none is one work-item's.
    const WarmupBatch crossing({80, 40, 40, 40, 40, 40, 40, 40});
    make(worker, crossing.view(), {0, 7}, own);
    worker.warmed_up.insert(warmup_key(own));
  } catch (const Shortage&) {
    settle(worker);
    worker.runtime->memory().trim();
  } catch (const Error& error) {
    settle(worker);
    worker.runtime->memory().trim();
    if (error.status() == Status::cancelled || error.status() == Status::out_of_memory) return;
    give_up(number, schedule, nullptr, error);
  } catch (const std::exception& error) {
    give_up(number, schedule, nullptr, host_failed(error));
  }
}

void DevicePool::run_job(std::size_t number, Schedule& schedule, const std::shared_ptr<Job>& job, const Call& call) {
  Worker& worker = workers_[number];
  Options own = call.options;
  own.progress = {};
  worker.runtime->give_up_when([&schedule, job] { return schedule.needless(*job); });
  const Stopwatch stopwatch(*worker.runtime);
  Made made = call.make_one ? make_on_lent(worker, job->problems, *call.make_one, schedule.state(number).plan.capacity)
                            : make(worker, call.batch, job->problems, own);
  const double ms = stopwatch.milliseconds();
  if (!schedule.finish(number, job, std::move(made.result), std::move(made.errors), ms)) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  DeviceReport& report = reports_[worker.device];
  report.problems += job->problems.size();
  for (const std::uint32_t p : job->problems) report.vertices += call.batch.n(p);
  ++report.runs;
  report.milliseconds += ms;
}

DevicePool::Made DevicePool::make(Worker& worker, const BatchInput& batch, std::vector<std::uint32_t> numbers,
                                  const Options& options) {
  // Refinement numbers added vertices through the whole mesh and judges lengths by the cells of one grid, so problems
  // are refined one by one. Seeds are of one problem.
  if (options.refine || has_seeds(options))
    return make_one_by_one(worker, numbers, [&](std::uint32_t p) { return make_single(worker, batch, p, options); });
  return make_forest(worker, batch, std::move(numbers), options);
}

// Runs the problems. If the input of some is invalid, it takes those out and runs the rest again. That ends because
// there are fewer each time.
DevicePool::Made DevicePool::make_forest(Worker& worker, const BatchInput& batch, std::vector<std::uint32_t> numbers,
                                         const Options& options) {
  Made made;
  while (!numbers.empty()) {
    try {
      made.result = triangulate_forest(*worker.runtime, *worker.primitives, batch, numbers, options, *worker.staging);
      break;
    } catch (const InvalidProblems& invalid) {
      settle(worker);
      std::vector<bool> out(numbers.size(), false);
      for (const auto& [place, error] : invalid.errors) {
        made.errors.emplace_back(numbers[place], error);
        out[place] = true;
      }
      std::size_t kept = 0;
      for (std::size_t i = 0; i < numbers.size(); ++i)
        if (!out[i]) numbers[kept++] = numbers[i];
      numbers.resize(kept);
    }
  }
  for (const auto& [place, error] : made.result.refused) made.errors.emplace_back(numbers[place], error);
  for (const std::uint32_t place : made.result.to_split)
    made.result.add(make_single(worker, batch, numbers[place], options));
  return made;
}

ForestResult DevicePool::make_single(Worker& worker, const BatchInput& batch, std::uint32_t p, const Options& options) {
  try {
    return triangulate_single(*worker.runtime, *worker.primitives, batch, p, options);
  } catch (const Error& error) {
    if (error.status() != Status::out_of_memory) throw;
    throw Shortage{p, error};
  }
}

}  // namespace gcdt
