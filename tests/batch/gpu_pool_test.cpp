// SPDX-License-Identifier: Apache-2.0
// Batches on pools with a device that is treated as a GPU: the bytes are those of each problem alone. Apart from
// gpu_test.cpp, since PoCL keeps the code of 128 kernels in a process.
#include <doctest/doctest.h>

#include "kinds.hpp"
#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// There are more jobs than one.
runtime::CallHook as_gpu(const Tuning& tuning) {
  runtime::CallHook hook;
  hook.tuning = tuning;
  hook.tuning.kind = DeviceKind::gpu;
  hook.tuning.job_overhead = 0;
  return hook;
}

}  // namespace

// Which leaves cores to the GPU's workers, and which warms up while the GPU works.
TEST_CASE("a CPU beside a device treated as a GPU, in one pool") {
  std::vector<Workload> problems = smallest_problems();
  for (std::uint64_t seed = 1; seed <= 200; ++seed) problems.push_back(random_pslg(150, 1000, 40, seed));
  const runtime::CallHook hook = as_gpu(Tuning());
  DevicePool pool({{cl::Context(), app_device(), hook}, {cl::Context(), app_device(), {}}}, {}, {});
  const RaggedBatch batch(problems);
  const Singles singles(problems);
  for (int round = 0; round < 3; ++round) {
    singles.check(pool.triangulate(batch.view(), {}));
    CHECK(pool.report(0).problems + pool.report(1).problems == problems.size());
  }
}

// Of a pool's GPU: workers in one context, memory of the driver's own, results through it.
TEST_CASE("batches on a device treated as a GPU, whose problems are work-groups', give each problem's bytes alone") {
  std::vector<Workload> problems = smallest_problems();
  for (const std::string& name : workload_names()) problems.push_back(workload(name, 60));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) problems.push_back(random_pslg(150, 9, 150, seed));
  problems.push_back(random_crossing(200, 1000, 60, 5));
  const std::size_t group_sized = problems.size();
  problems.push_back(workload("uniform", 40000));  // one more than a group takes, and all go through rounds together
  for (const std::size_t count : {group_sized, problems.size()})
    for (const Tuning& tuning : {Tuning(), small_thresholds()}) {
      CAPTURE(count);
      CAPTURE(tuning.most_stamps);
      const std::vector<Workload> some(problems.begin(), problems.begin() + std::ptrdiff_t(count));
      DevicePool pool({{cl::Context(), app_device(), as_gpu(tuning)}}, {}, {});
      const RaggedBatch batch(some);
      Options regions;
      regions.regions = true;
      for (const Options& options : {Options(), regions})
        Singles(some, options).check(pool.triangulate(batch.view(), options));
    }
}
