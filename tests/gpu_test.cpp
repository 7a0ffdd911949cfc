// SPDX-License-Identifier: Apache-2.0
// Whole calls and batches on devices that are treated as GPUs: the bytes are those of a CPU's ways, with thresholds so
// low that small inputs take every way that large ones take.
#include <doctest/doctest.h>

#include <numeric>

#include "agreement.hpp"
#include "alone.hpp"
#include "kinds.hpp"
#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

// Before any test lists devices.
const std::vector<cl::Device> all_of_them = every_device();

// llvmpipe, or PoCL.
runtime::Runtime& as_gpu(bool on_lanes) {
  for (const Treated& device : devices_as_all_kinds())
    if (device.runtime->kind() == DeviceKind::gpu && device.runtime->info().is_cpu &&
        on_lanes == (device.runtime->info().platform == "rusticl"))
      return *device.runtime;
  throw Error(Status::no_device, "no CPU is treated as a GPU");
}

Triangulation on(runtime::Runtime& runtime, const Workload& problem, const Options& options = {}) {
  Primitives primitives(runtime);
  return part_of(triangulate_alone(runtime, primitives, RaggedBatch({problem}).view(), 0, options), 0);
}

// Levels, groups and lists of a few; stamps that run out; sweeps from the start.
Tuning small(const Tuning& usual) {
  Tuning tuning = usual;
  tuning.coarsest_level = 8;
  tuning.one_group_vertices = 16;
  tuning.one_group_edges = 32;
  tuning.least_sweep = 100;
  tuning.most_stamps = 3;
  tuning.rounds_of_group = 2;
  return tuning;
}

// All that a call can be asked for, with problems that take it to every phase.
std::vector<std::pair<Workload, Options>> calls() {
  std::vector<std::pair<Workload, Options>> all;
  for (const char* name : {"uniform", "grid", "clusters", "hub", "letters", "spiral", "near_circle"})
    all.push_back({workload(name, 1000), {}});
  all.push_back({workload("uniform", 10000), {}});  // sorted by buckets
  Options domain;
  domain.regions = true;
  for (const Domain d : {Domain::even_odd, Domain::nonzero, Domain::outer}) {
    domain.domain = d;
    all.push_back({workload("random_pslg", 60), domain});
    all.push_back({workload("nested_squares", 400), domain});
  }
  Options drop, split;
  drop.crossing = Crossing::drop, split.crossing = Crossing::split;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    all.push_back({randomCrossing(120, 1000, 40, seed), drop});
    all.push_back({randomCrossing(120, 1000, 40, seed), split});
  }
  return all;
}

}  // namespace

TEST_CASE("calls on a device treated as a GPU give a CPU's bytes, with usual thresholds and with small ones") {
  runtime::Runtime& gpu = as_gpu(false);
  const Tuning usual = gpu.tuning();
  for (const auto& [problem, options] : calls()) {
    CAPTURE(problem.points.size());
    const Triangulation expected = solver().triangulate(problem.points, problem.constraints, options);
    for (const Tuning& tuning : {usual, small(usual)}) {
      CAPTURE(tuning.coarsest_level);
      const Tuned tuned(gpu, tuning);
      CHECK(difference(on(gpu, problem, options), expected) == "");
    }
  }
}

TEST_CASE("llvmpipe treated as a GPU gives PoCL's bytes, by sweeps of a mesh that is large enough for them") {
  const Workload problem = workload("uniform", 45000);
  REQUIRE(3 * problem.points.size() > Tuning().least_sweep);
  CHECK(difference(on(as_gpu(true), problem), solver().triangulate(problem.points)) == "");
}

// Of a pool's GPU: lanes in one context, memory of the driver's own, results through it.
TEST_CASE("batches on a device treated as a GPU, whose problems are work-groups', give each problem's bytes alone") {
  std::vector<Workload> problems = smallest_problems();
  for (const std::string& name : workloadNames()) problems.push_back(workload(name, 60));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) problems.push_back(randomPslg(150, 9, 150, seed));
  problems.push_back(randomCrossing(200, 1000, 60, 5));
  const std::size_t group_sized = problems.size();
  problems.push_back(workload("uniform", 40000));  // one more than a group takes, and all go through rounds together
  const Tuning usual = as_gpu(false).tuning();
  for (const std::size_t count : {group_sized, problems.size()})
    for (const Tuning& tuning : {usual, small(usual)}) {
      CAPTURE(count);
      CAPTURE(tuning.most_stamps);
      const std::vector<Workload> some(problems.begin(), problems.begin() + std::ptrdiff_t(count));
      runtime::CallHook hook;
      hook.tuning = tuning;
      hook.tuning.pack_overhead = 0;  // so that there are more packs than one
      DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
      const RaggedBatch batch(some);
      const Alone alone(some);
      for (int round = 0; round < 2; ++round) alone.check(pool.triangulate(batch.view(), {}));
    }
}
