// SPDX-License-Identifier: Apache-2.0
// Small calls that launch kernels on a device treated as one kind, for tools that look at each launch (Oclgrind):
//   race_cases DEVICE KIND [CASE]...
//     KIND   gpu, few (a GPU with small thresholds), lanes, threads, or shares (threads of which none takes a whole
//     call) CASE   default: all
// Prints a line "hash KIND CASE HASH" for each, and "kernel NAME" for each kernel that was launched.
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <functional>
#include <mutex>
#include <set>

#include "api/state.hpp"
#include "result_hash.hpp"
#include "workloads.hpp"

namespace {

using namespace gcdt;
using namespace gcdt::test;

struct Case {
  const char* name;
  std::function<std::uint64_t(Solver&)> run;
};

std::uint64_t solved(Solver& on, const Workload& work, const Options& options = {}) {
  return result_hash(on.triangulate(work.points, work.constraints, options));
}

Options with(Crossing crossing, Domain domain = Domain::hull) {
  Options options;
  options.crossing = crossing;
  options.domain = domain;
  return options;
}

/// Vertices on a line, and some on either side: most wait on edges, while others claim the faces beside these.
Workload beside_line() {
  Workload work;
  for (int i = 0; i < 20; ++i) work.points.push_back({double(i), 0});
  for (int i = 0; i < 10; ++i) {
    work.points.push_back({2.0 * i, 5.0 + i % 3});
    work.points.push_back({2.0 * i + 1, -5.0 - i % 3});
  }
  return work;
}

/// Vertices on a circle: cavities of nearly all faces, which triangles draw lots for; and a chord, which a vertex on
/// either side asks to be split.
Workload outline() {
  constexpr std::uint32_t n = 24;
  Workload work;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / n;
    work.points.push_back({std::round(1000 * std::cos(angle)), std::round(1000 * std::sin(angle))});
    work.constraints.push_back({i, (i + 1) % n});
  }
  work.constraints.push_back({0, n / 3});
  work.points.insert(work.points.end(), {{270, 468}, {230, 398}});  // beside its middle
  return work;
}

std::uint64_t queried(Solver& on) {
  const Workload work = random_pslg(24, 100, 16, 3);
  const Result result = on.solve(work.points, work.constraints);
  Hash hash;
  const std::vector<Point> points = {{0, 0}, {31.5, 40}, {99, 12}, {200, 200}};
  for (const std::int32_t triangle : result.locate(points)) hash.add(triangle);
  for (const std::uint32_t vertex : result.hull()) hash.add(vertex);
  hash.add(result.quality().least_angle_triangle);
  hash.add(result_hash(result.download()));
  return hash.value();
}

std::vector<Case> all_cases() {
  Options refined, regions = with(Crossing::drop, Domain::even_odd);
  refined.refine = Refinement{};
  refined.refine->most_added = 8;
  regions.regions = true;
  regions.region_seeds = {{5, 5}};
  return {
      {"vertices", [](Solver& on) { return solved(on, uniform(30)); }},
      {"lattice", [](Solver& on) { return solved(on, workload("grid", 100)); }},
      {"line", [](Solver& on) { return solved(on, beside_line()); }},
      {"hub", [](Solver& on) { return solved(on, workload("hub", 40)); }},
      {"pslg", [](Solver& on) { return solved(on, random_pslg(30, 60, 20, 3)); }},
      {"regions", [=](Solver& on) { return solved(on, random_crossing(14, 12, 5, 7), regions); }},
      {"crossing", [](Solver& on) { return solved(on, random_crossing(16, 16, 4, 11), with(Crossing::drop)); }},
      {"split", [](Solver& on) { return solved(on, random_crossing(12, 12, 4, 11), with(Crossing::split)); }},
      {"refine", [=](Solver& on) { return solved(on, random_pslg(14, 100, 12, 3), refined); }},
      {"outline", [=](Solver& on) { return solved(on, outline(), refined); }},
      {"queries", queried},
  };
}

/// Levels, groups, lists and patches of a few, sweeps from the start: as kinds.hpp has them for tests.
Tuning small_thresholds() {
  Tuning tuning;
  tuning.coarsest_level = 8;
  tuning.one_group_vertices = 4;
  tuning.one_group_edges = 4;
  tuning.least_sweep = 20;
  tuning.least_patched = 40;
  tuning.patch_vertices = 8;
  tuning.least_divided = 80;
  tuning.district_vertices = 6;
  tuning.most_stamps = 3;
  tuning.rounds_of_group = 2;
  tuning.rows_read = 3, tuning.rows_folded = 4;
  tuning.least_grouped = 0, tuning.grouped_crossings = UINT32_MAX;
  return tuning;
}

runtime::CallHook hook_of(const std::string& kind) {
  runtime::CallHook hook;
  if (kind == "few") hook.tuning = small_thresholds();
  if (kind == "shares") hook.tuning.one_item_vertices = 0;
  if (kind == "gpu" || kind == "few") {
    hook.tuning.kind = DeviceKind::gpu;
    hook.options = "-DGCDT_SLIDE_SHARE=0xFFFFFFFFu -DGCDT_SLIDE_PAUSE=0u";  // else few slides meet
  } else if (kind == "lanes" || kind == "threads" || kind == "shares") {
    hook.tuning.kind = kind == "lanes" ? DeviceKind::lanes : DeviceKind::threads;
  } else {
    throw std::runtime_error("no kind is called " + kind);
  }
  hook.tuning.works_here = false;
  hook.tuning.builds_at_once = 1;  // Oclgrind crashes when threads build programs at once
  return hook;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) {
    std::fprintf(stderr, "usage: race_cases DEVICE KIND [CASE]...\n");
    return 2;
  }
  std::mutex mutex;
  std::set<std::string> kernels;
  const Trace trace = [&](const TraceSpan& span) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (span.on_device) kernels.insert(span.name);
  };
  const std::set<std::string> wanted(arguments + 3, arguments + count);
  std::size_t made = 0;
  {
    auto handle = std::make_unique<gcdt_solver>();
    handle->state = std::make_shared<api::State>(cl::Context(), runtime::all_devices().at(select_device(arguments[1])),
                                                 runtime::Log(), trace, hook_of(arguments[2]));
    Solver solver(handle.release());
    for (const Case& one : all_cases()) {
      if (!wanted.empty() && wanted.count(one.name) == 0) continue;
      ++made;
      std::printf("hash %s %s %016" PRIx64 "\n", arguments[2], one.name, one.run(solver));
      std::fflush(stdout);
    }
  }
  if (made < wanted.size()) throw std::runtime_error("no such case");
  for (const std::string& name : kernels) std::printf("kernel %s\n", name.c_str());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "race_cases: %s\n", error.what());
  return 1;
}
