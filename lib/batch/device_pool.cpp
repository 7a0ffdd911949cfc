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

// A rehearsal runs so many problems that each is one work-item's; so few that all have less than Tuning::few_vertices;
// one; and one beside which others count for nothing, so that they go through all phases together, small and so large
// that no work-group sorts it by itself.
constexpr std::uint32_t least_rehearsed = 512, large_rehearsed = 20000;

// Others use the device as well, and what runs need is estimated.
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

// The threads that feed GPUs, and those that make room for what comes from them (forest_copy.hpp), need cores, which a
// CPU of the same pool would take from them.
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
    lane.runtime->build_for_forests();
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
  if (report.lost) return;  // another lane has said why
  report.lost = error;
  if (log_) log_(GCDT_LOG_WARNING, (report.info.name + " is taken out of the pool: " + error.what()).c_str());
}

// The lanes of a device share its memory, as long as there is enough for more than one run.
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
  // What is wrong with the options is no device's fault.
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

// Ends with the schedule, or with the device.
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

// The lane's device is out, and the pack, if there is one, is others'.
void DevicePool::give_up(std::size_t number, Schedule& schedule, const std::shared_ptr<Pack>& pack,
                         const Error& error) {
  lose(lanes_[number].device, error);
  schedule.lose(number, pack);
}

// Whatever has happened, nothing is left in the queue.
void DevicePool::settle(Lane& lane) {
  runtime::Runtime& runtime = *lane.runtime;
  runtime.attempt("clFinish", "after an error", [&] { return runtime.try_finish(); });
  runtime.tracer().clear();
  lane.primitives->release();
}

// Others do the work until the lane has launched what it will need. What it has no memory for, packs tell.
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
    if (options.crossing == Crossing::split) {  // large ones that cross go alone: of decimals, and to be rounded
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
    make(lane, crossing.view(), {7}, own);  // few pieces, each against each
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

// Problems with errors of their own, and those to be run alone, are taken out and the rest is run again, which ends:
// there are fewer each time.
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
