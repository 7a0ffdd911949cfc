// SPDX-License-Identifier: Apache-2.0
#include "batch/device_pool.hpp"

#include <algorithm>
#include <numeric>
#include <thread>

#include "batch/alone.hpp"
#include "device/step.hpp"
#include "mesh/grid.hpp"

namespace gcdt {

namespace {

// A rehearsal has a run of `least_rehearsed` problems or more, so that each problem is one work-item's; one of few
// problems, which have less than Tuning::few_vertices together; one of a single problem; and two in which one problem
// is much larger than the rest, so that all go through the phases together. One of those has `large_rehearsed`
// vertices, too many for one work-group to sort.
constexpr std::uint32_t least_rehearsed = 512, large_rehearsed = 20000;

// Not all of the memory, because others use the device as well, and because the need of a run is an estimate.
std::uint64_t usable_bytes(const DeviceInfo& info) { return info.memory_bytes / 4 * 3; }

DeviceKind kind_of(const DevicePool::Member& member) {
  return runtime::kind_of(runtime::describe(member.device), member.hook.tuning);
}

std::uint32_t lanes_of(const DevicePool::Member& member) {
  const bool gpu = kind_of(member) == DeviceKind::gpu;
  return std::max<std::uint32_t>(1, member.hook.tuning.lanes.value_or(gpu ? Tuning::gpu_lanes : 1));
}

Error host_failed(const std::exception& error) {
  return Error(Status::device_failed, std::string("the host failed it: ") + error.what());
}

// Leaves cores to the threads that feed GPUs and to those that make room for results (forest_copy.hpp). A CPU device of
// the same pool would take those cores from them.
void leave_cores(std::vector<DevicePool::Member>& members) {
  std::uint32_t feeding = 0;
  for (const DevicePool::Member& member : members)
    if (kind_of(member) == DeviceKind::gpu) feeding += 2 * lanes_of(member);
  for (DevicePool::Member& member : members)
    if (feeding > 0 && !member.context() && is_cpu(kind_of(member)))
      member.device = runtime::part_of(member.device, feeding);
}

}  // namespace

DevicePool::DevicePool(std::vector<Member> members, runtime::Log log, Trace trace)
    : log_(std::move(log)), trace_(std::move(trace)), reports_(members.size()) {
  if (members.empty()) throw Error(Status::no_device, "a pool without devices");
  leave_cores(members);
  for (std::size_t i = 0; i < members.size(); ++i) {
    try {
      reports_[i].info = runtime::describe(members[i].device);
      reports_[i].kind = kind_of(members[i]);
      open(std::move(members[i]), i);
    } catch (const Error& error) {
      lose(i, error);
    }
  }
  if (all_lost()) throw_reasons();
}

bool DevicePool::has_gpus() const {
  return std::any_of(reports_.begin(), reports_.end(),
                     [](const DeviceReport& report) { return report.kind == DeviceKind::gpu && !report.lost; });
}

void DevicePool::open(Member member, std::size_t device) {
  const runtime::Log log = log_ ? runtime::Log([this](int level, const char* message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    log_(level, message);
  })
                                : runtime::Log();
  const Trace trace = trace_ ? Trace([this](const TraceSpan& span) {
    const std::lock_guard<std::mutex> lock(mutex_);
    trace_(span);
  })
                             : Trace();
  const std::uint32_t count = lanes_of(member);
  std::uint32_t& rounds = member.hook.tuning.rounds_per_read;
  const bool gpu = reports_[device].kind == DeviceKind::gpu;
  if (gpu) rounds = std::max(rounds, Tuning::gpu_rounds_per_read);
  const auto devices = static_cast<std::uint32_t>(reports_.size()), first = static_cast<std::uint32_t>(device);
  const bool shared = count > 1 && (member.context() || member.hook.tuning.shares_context.value_or(gpu));
  for (std::uint32_t number = 0; number < count; ++number) {
    Lane lane;
    lane.device = device;
    if (shared && number > 0)
      lane.runtime = std::make_unique<runtime::Runtime>(*lanes_.back().runtime, log, trace);
    else
      lane.runtime = std::make_unique<runtime::Runtime>(member.context, member.device, member.hook, log, trace);
    if (shared) lane.runtime->share_context();
    lane.runtime->time_steps(lane.runtime->tracer().on());
    lane.runtime->tracer().set_lane(first + number * devices, number);
    lane.primitives = std::make_unique<Primitives>(*lane.runtime);
    lane.staging = std::make_unique<Staging>(*lane.runtime);
    lanes_.push_back(std::move(lane));
  }
}

bool DevicePool::all_lost() const {
  return std::all_of(reports_.begin(), reports_.end(), [](const DeviceReport& r) { return r.lost.has_value(); });
}

void DevicePool::throw_reasons() const {
  Status status = reports_.front().lost->status();
  std::int32_t code = reports_.front().lost->opencl_code();
  std::string message = "no device of the pool is left:";
  for (const DeviceReport& report : reports_) {
    if (report.lost->status() != status) status = Status::device_failed;
    if (report.lost->opencl_code() != code) code = 0;
    message += "\n  " + report.info.name + " (" + report.info.platform + "): " + report.lost->what();
  }
  throw Error(status, message, {}, 0, code);
}

void DevicePool::lose(std::size_t device, const Error& error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  DeviceReport& report = reports_[device];
  if (report.lost) return;  // another lane has given the reason
  report.lost = error;
  if (log_) log_(GCDT_LOG_WARNING, (report.info.name + " is taken out of the pool: " + error.what()).c_str());
}

// The lanes of a device share its memory: packs of several problems get an equal part each, a single large problem may
// take all of it.
std::vector<LaneShare> DevicePool::shares(bool gpus) const {
  std::vector<LaneShare> all;
  std::vector<std::uint32_t> numbers(reports_.size());
  for (const Lane& lane : lanes_) {
    const DeviceReport& report = reports_[lane.device];
    const bool gpu = report.kind == DeviceKind::gpu;
    const auto siblings =
        std::count_if(lanes_.begin(), lanes_.end(), [&](const Lane& other) { return other.device == lane.device; });
    LaneShare share;
    share.device = lane.device;
    share.capacity = usable_bytes(report.info);
    share.most_bytes = share.capacity / static_cast<std::uint64_t>(siblings);
    share.most_weight = gpu ? Tuning::gpu_weight : Tuning::cpu_weight;
    share.speed = lane.speed;
    if (lane.runtime) share.overhead = lane.runtime->tuning().pack_overhead.value_or(gpu ? Tuning::gpu_overhead : 0);
    share.first_part = ++numbers[lane.device] / static_cast<double>(siblings);
    share.beside_gpus = gpus && !gpu;
    share.started = share.beside_gpus && lane.sitting_out.now();
    share.lost = share.ended = report.lost.has_value();
    all.push_back(share);
  }
  return all;
}

PoolResult DevicePool::triangulate(const BatchInput& batch, const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  // Checked here, so that no device is blamed for it.
  if (!options.hole_seeds.empty() || !options.region_seeds.empty())
    throw Error(Status::invalid_argument, "hole and region seeds are of one problem: a batch takes none");
  if (options.grid) fixed_grid(*options.grid);
  if (all_lost()) throw_reasons();
  for (Lane& lane : lanes_) lane.report = {};
  const bool gpus = has_gpus();
  for (Lane& lane : lanes_)
    lane.rehearses = lane.runtime &&
                     lane.runtime->tuning().rehearses.value_or(gpus && reports_[lane.device].kind != DeviceKind::gpu);
  const std::vector<LaneShare> lanes = shares(gpus);
  Schedule schedule(batch, lanes);
  std::vector<std::thread> threads;
  const auto join = [&] {
    for (std::thread& thread : threads) thread.join();
  };
  bool wanted = true;
  try {
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (!lanes[i].lost) threads.emplace_back([&, i] { work(i, schedule, batch, options); });
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
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    lanes_[i].speed = schedule.speed(i);
    lanes_[i].sitting_out.next_call(schedule.left_out(i));
  }
  add_reports();
  if (!wanted) throw Error(Status::cancelled, "cancelled during batch");
  if (schedule.unsettled() > 0) throw_reasons();
  PoolResult result;
  result.results = std::move(schedule.results);
  result.places = std::move(schedule.places);
  result.errors = std::move(schedule.errors);
  result.milliseconds = milliseconds_since(start);
  return result;
}

void DevicePool::add_reports() {
  for (DeviceReport& report : reports_) {
    report.problems = report.vertices = report.runs = 0;
    report.milliseconds = 0;
  }
  for (Lane& lane : lanes_) {
    DeviceReport& report = reports_[lane.device];
    report.problems += lane.report.problems;
    report.vertices += lane.report.vertices;
    report.runs += lane.report.runs;
    report.milliseconds += lane.report.milliseconds;
    if (!report.lost) continue;
    lane.staging.reset();
    lane.primitives.reset();
    lane.runtime.reset();
  }
}

// A lane's thread. It ends when the schedule has nothing left for the lane, or when the device is lost.
void DevicePool::work(std::size_t number, Schedule& schedule, const BatchInput& batch, const Options& options) {
  Lane& lane = lanes_[number];
  if (lane.rehearses && !lane.sitting_out.now() && !lane.rehearsed.has(options)) rehearse(number, schedule, options);
  while (const std::shared_ptr<Pack> pack = schedule.take(number)) {
    try {
      run(number, schedule, pack, batch, options);
      continue;
    } catch (const Error& error) {
      settle(lane);
      if (error.status() == Status::cancelled) {
        schedule.drop(number, pack);
        continue;
      }
      if (error.status() == Status::out_of_memory) {
        lane.runtime->memory().trim();
        schedule.too_large(number, pack, error);
        continue;
      }
      give_up(number, schedule, pack, error);
    } catch (const std::exception& error) {
      give_up(number, schedule, pack, host_failed(error));
    }
  }
  if (schedule.crowded_out(number)) {
    lane.primitives->release();
    lane.runtime->memory().trim();
  }
  lane.runtime->give_up_when({});
  lane.staging->offsets = {};
  schedule.end(number);
}

// Takes the lane's device out of the pool; its pack, if there is one, goes to other devices.
void DevicePool::give_up(std::size_t number, Schedule& schedule, const std::shared_ptr<Pack>& pack,
                         const Error& error) {
  lose(lanes_[number].device, error);
  schedule.lose(number, pack);
}

// After an error: waits until nothing is left in the queue, and forgets what was under way.
void DevicePool::settle(Lane& lane) {
  runtime::Runtime& runtime = *lane.runtime;
  runtime.attempt("clFinish", "after an error", [&] { return runtime.try_finish(); });
  runtime.tracer().clear();
  lane.primitives->release();
}

// Launches all kernels that the lane may need, while other lanes do the work. Too little memory is no error here: it
// will show when a pack needs it.
void DevicePool::rehearse(std::size_t number, Schedule& schedule, const Options& options) {
  Lane& lane = lanes_[number];
  Options own;
  own.crossing = options.crossing;
  own.domain = options.domain;
  own.regions = options.regions;
  lane.runtime->give_up_when([&schedule] { return schedule.cancelled(); });
  try {
    const std::uint32_t many = std::max(least_rehearsed, 2 * lane.runtime->info().compute_units);
    std::vector<std::vector<std::uint32_t>> runs = {
        std::vector<std::uint32_t>(many, 40), std::vector<std::uint32_t>(8, 40), {40}, {60, 40}, {large_rehearsed, 40}};
    if (options.crossing == Crossing::split) {  // large problems that cross, run alone: with decimals, and rounded
      runs.emplace_back(12, 40);
      runs.back()[7] = runs.back()[11] = large_rehearsed;
    }
    for (const std::vector<std::uint32_t>& vertices : runs) {
      const RehearsalBatch batch(vertices);
      std::vector<std::uint32_t> all(vertices.size());
      std::iota(all.begin(), all.end(), 0u);
      make(lane, batch.view(), std::move(all), own);
    }
    const RehearsalBatch crossing(std::vector<std::uint32_t>(8, 40));
    make(lane, crossing.view(), {7}, own);  // few pieces: all pairs are compared
    lane.rehearsed.add(own);
  } catch (const Shortage&) {
    settle(lane);
    lane.runtime->memory().trim();
  } catch (const Error& error) {
    settle(lane);
    lane.runtime->memory().trim();
    if (error.status() == Status::cancelled || error.status() == Status::out_of_memory) return;
    give_up(number, schedule, nullptr, error);
  } catch (const std::exception& error) {
    give_up(number, schedule, nullptr, host_failed(error));
  }
}

void DevicePool::run(std::size_t number, Schedule& schedule, const std::shared_ptr<Pack>& pack, const BatchInput& batch,
                     const Options& options) {
  Lane& lane = lanes_[number];
  Options own = options;
  own.progress = {};
  lane.runtime->give_up_when([&schedule, pack] { return schedule.needless(*pack); });
  const Stopwatch stopwatch(*lane.runtime);
  Made made;
  try {
    made = make(lane, batch, pack->problems, own);
  } catch (const Shortage& shortage) {
    settle(lane);
    lane.runtime->memory().trim();
    schedule.too_large(number, pack, shortage.error, shortage.problem);
    return;
  }
  const double ms = stopwatch.milliseconds();
  if (!schedule.finish(number, pack, std::move(made.result), std::move(made.errors), ms)) return;
  DeviceReport& report = lane.report;
  report.problems += pack->problems.size();
  for (const std::uint32_t p : pack->problems) report.vertices += batch.n(p);
  ++report.runs;
  report.milliseconds += ms;
}

// Takes out problems with errors of their own, and those that must run alone, and runs the rest again. That ends
// because there are fewer each time.
DevicePool::Made DevicePool::make(Lane& lane, const BatchInput& batch, std::vector<std::uint32_t> numbers,
                                  const Options& options) {
  Made made;
  std::vector<std::uint32_t> crossing;
  while (!numbers.empty()) {
    try {
      made.result = triangulate_forest(*lane.runtime, *lane.primitives, batch, numbers, options, *lane.staging);
      break;
    } catch (const InvalidProblems& invalid) {
      settle(lane);
      std::vector<bool> out(numbers.size(), false);
      for (const auto& [place, error] : invalid.errors) {
        made.errors.emplace_back(numbers[place], error);
        out[place] = true;
      }
      for (const std::uint32_t place : invalid.crossing) {
        crossing.push_back(numbers[place]);
        out[place] = true;
      }
      std::size_t kept = 0;
      for (std::size_t i = 0; i < numbers.size(); ++i)
        if (!out[i]) numbers[kept++] = numbers[i];
      numbers.resize(kept);
    }
  }
  for (const std::uint32_t p : crossing) {
    try {
      made.result.add(triangulate_alone(*lane.runtime, *lane.primitives, batch, p, options));
    } catch (const Error& error) {
      if (error.status() != Status::out_of_memory) throw;
      throw Shortage{p, error};
    }
  }
  return made;
}

}  // namespace gcdt
