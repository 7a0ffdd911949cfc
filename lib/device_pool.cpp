// SPDX-License-Identifier: Apache-2.0
#include "device_pool.hpp"

#include <algorithm>
#include <thread>

#include "grid.hpp"

namespace gcdt {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Vertices and constraints of a pack. A CPU is fastest where a pack stays in its caches (2.0 microseconds a vertex with
// 75,000 vertices, 4.9 with 2.2 million); a GPU where it has so many that launches do not count, and results of one
// pack are not so many that copies of them pile up on the host.
constexpr std::uint64_t cpu_weight = 1u << 17, gpu_weight = 1u << 24;

// Others use the device as well, and what runs need is estimated.
std::uint64_t usable_bytes(const DeviceInfo& info) { return info.memory_bytes / 4 * 3; }

}  // namespace

DevicePool::DevicePool(std::vector<Member> members, runtime::Log log, Trace trace)
    : log_(std::move(log)), trace_(std::move(trace)), workers_(members.size()) {
  if (members.empty()) throw Error(Status::no_device, "a pool without devices");
  const runtime::Log one_log = log_ ? runtime::Log([this](int level, const char* message) {
    const std::lock_guard<std::mutex> lock(callbacks_);
    log_(level, message);
  })
                                    : runtime::Log();
  const Trace one_trace = trace_ ? Trace([this](const TraceSpan& span) {
    const std::lock_guard<std::mutex> lock(callbacks_);
    trace_(span);
  })
                                 : Trace();
  for (std::size_t i = 0; i < members.size(); ++i) {
    Worker& worker = workers_[i];
    try {
      worker.report.info = runtime::describe(members[i].device);
      worker.runtime = std::make_unique<runtime::Runtime>(members[i].context, members[i].device,
                                                          std::move(members[i].hook), one_log, one_trace);
      worker.runtime->build_for_forests();
      worker.runtime->tracer().device_number() = static_cast<std::uint32_t>(i);
      worker.primitives = std::make_unique<Primitives>(*worker.runtime);
    } catch (const Error& error) {
      lose(worker, error);
    }
  }
  if (all_lost()) throw_reasons();
}

bool DevicePool::all_lost() const {
  return std::all_of(workers_.begin(), workers_.end(), [](const Worker& w) { return w.report.lost.has_value(); });
}

void DevicePool::throw_reasons() const {
  Status status = workers_.front().report.lost->status();
  std::int32_t code = workers_.front().report.lost->opencl_code();
  std::string message = "no device of the pool is left:";
  for (const Worker& worker : workers_) {
    if (worker.report.lost->status() != status) status = Status::device_failed;
    if (worker.report.lost->opencl_code() != code) code = 0;
    message +=
        "\n  " + worker.report.info.name + " (" + worker.report.info.platform + "): " + worker.report.lost->what();
  }
  throw Error(status, message, {}, 0, code);
}

void DevicePool::lose(Worker& worker, const Error& error) {
  worker.report.lost = error;
  worker.primitives.reset();
  worker.runtime.reset();
  if (!log_) return;
  const std::lock_guard<std::mutex> lock(callbacks_);
  log_(GCDT_LOG_WARNING, (worker.report.info.name + " is taken out of the pool: " + error.what()).c_str());
}

PoolResult DevicePool::triangulate(const BatchInput& batch, const Options& options) {
  const auto start = Clock::now();
  // What is wrong with the options is no device's fault.
  if (!options.hole_seeds.empty() || !options.region_seeds.empty())
    throw Error(Status::invalid_argument, "hole and region seeds are of one problem: a batch takes none");
  if (options.grid) fixed_grid(*options.grid);
  if (all_lost()) throw_reasons();
  std::vector<DeviceShare> shares;
  for (Worker& worker : workers_) {
    worker.report.problems = worker.report.vertices = worker.report.runs = 0;
    worker.report.milliseconds = 0;
    shares.push_back({usable_bytes(worker.report.info), worker.report.info.is_gpu ? gpu_weight : cpu_weight,
                      worker.speed, worker.report.lost.has_value()});
  }
  Schedule schedule(batch, std::move(shares));
  std::vector<std::thread> threads;
  const auto join = [&] {
    for (std::thread& thread : threads) thread.join();
  };
  bool wanted = true;
  try {
    for (std::size_t i = 0; i < workers_.size(); ++i)
      if (!workers_[i].report.lost) threads.emplace_back([&, i] { work(i, schedule, batch, options); });
    for (double done = 0; done < 1 && wanted;) {
      done = schedule.wait();
      if (options.progress) wanted = options.progress("batch", done);
    }
    if (!wanted) schedule.cancel();
  } catch (...) {
    schedule.cancel();
    join();
    throw;
  }
  join();
  for (std::size_t i = 0; i < workers_.size(); ++i) workers_[i].speed = schedule.speed(i);
  if (!wanted) throw Error(Status::cancelled, "cancelled during batch");
  if (schedule.unsettled() > 0) throw_reasons();
  PoolResult result;
  result.results = std::move(schedule.results);
  result.places = std::move(schedule.places);
  result.errors = std::move(schedule.errors);
  result.milliseconds = milliseconds_since(start);
  return result;
}

// Ends with the schedule, or with the device.
void DevicePool::work(std::size_t device, Schedule& schedule, const BatchInput& batch, const Options& options) {
  Worker& worker = workers_[device];
  while (const std::shared_ptr<Pack> pack = schedule.take(device)) {
    try {
      run(device, schedule, pack, batch, options);
      continue;
    } catch (const Error& error) {
      settle(worker);
      if (error.status() == Status::cancelled) {
        schedule.drop(pack);
        continue;
      }
      if (error.status() == Status::out_of_memory) {
        worker.runtime->memory().trim();
        schedule.too_large(device, pack, error);
        continue;
      }
      lose(worker, error);
    } catch (const std::exception& error) {
      lose(worker, Error(Status::device_failed, std::string("the host failed it: ") + error.what()));
    }
    schedule.lose(device, pack);
  }
}

// Whatever has happened, nothing is left in the queue.
void DevicePool::settle(Worker& worker) {
  runtime::Runtime& runtime = *worker.runtime;
  runtime.attempt("clFinish", "after an error", [&] { return runtime.try_finish(); });
  runtime.tracer().clear();
  worker.primitives->release();
}

// Problems with errors of their own are taken out and the rest is run again, which ends: there are fewer each time.
void DevicePool::run(std::size_t device, Schedule& schedule, const std::shared_ptr<Pack>& pack, const BatchInput& batch,
                     const Options& options) {
  Worker& worker = workers_[device];
  Options own = options;
  own.progress = [&](const char*, double) { return !schedule.needless(pack); };
  std::vector<std::uint32_t> numbers = pack->problems;
  std::vector<std::pair<std::uint32_t, Error>> errors;
  const auto start = Clock::now();
  const double built = worker.runtime->build_ms();
  ForestResult result;
  while (!numbers.empty()) {
    try {
      result = triangulate_forest(*worker.runtime, *worker.primitives, batch, numbers, own);
      break;
    } catch (const InvalidProblems& invalid) {
      settle(worker);
      std::vector<bool> out(numbers.size(), false);
      for (const auto& [place, error] : invalid.errors) {
        errors.emplace_back(numbers[place], error);
        out[place] = true;
      }
      std::size_t kept = 0;
      for (std::size_t i = 0; i < numbers.size(); ++i)
        if (!out[i]) numbers[kept++] = numbers[i];
      numbers.resize(kept);
    }
  }
  const double ms = milliseconds_since(start) - (worker.runtime->build_ms() - built);
  if (!schedule.finish(device, pack, std::move(result), std::move(errors), ms)) return;
  DeviceReport& report = worker.report;
  report.problems += pack->problems.size();
  for (const std::uint32_t p : pack->problems) report.vertices += batch.n(p);
  ++report.runs;
  report.milliseconds += ms;
}

}  // namespace gcdt
