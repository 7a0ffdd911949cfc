// SPDX-License-Identifier: Apache-2.0
// PoCL before version 6 may end the process where a launch is wider than the first one of its kernel was
// (lib/device/runtime.cpp), so none is: of a solver that is alone, of others beside it, and of pools.
#include <doctest/doctest.h>

#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "width_layer.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

runtime::CallHook hook_for(DeviceKind kind) {
  runtime::CallHook hook;
  hook.tuning.kind = kind;
  hook.tuning.job_overhead = 0;  // there are more jobs than one
  hook.tuning.works_here = false;
  const runtime::Runtime runtime(app_device(), hook);
  if (std::atoi(runtime.info().driver.c_str()) >= 6)
    hook.tuning.width = static_cast<std::uint32_t>(runtime.geometry().max_groups);
  return hook;
}

}  // namespace

TEST_CASE("no launch is wider than the first one of its kernel, on parts of a device or all of it") {
  const cl::Device whole = app_device(), part = runtime::part_of(whole, 1);
  Widths& widths = widths_of(GCDT_WIDTH_LAYER);
  const std::vector<Workload> problems = {uniform(40000), random_pslg(150, 1000, 40, 1), uniform(5000), uniform(50)};
  for (const DeviceKind kind : {DeviceKind::gpu, DeviceKind::threads})
    for (const cl::Device& first : {part, whole}) {
      widths.wider();
      const std::uint64_t launches = widths.launches, narrower = widths.narrower;
      const runtime::CallHook hook = hook_for(kind);
      std::vector<Triangulation> expected(problems.size());
      Solver alone = hooked_solver(hook, {}, first);
      for (std::size_t p = problems.size(); p-- > 0;)  // the smallest first
        expected[p] = alone.triangulate(problems[p].points, problems[p].constraints);
      CHECK(widths.narrower > narrower);  // only first ones are as wide as can be
      DevicePool pool({{cl::Context(), part, hook}, {cl::Context(), whole, hook}}, {}, {});
      CHECK(outcome_of(pool, RaggedBatch(problems), expected).right);
      CHECK(widths.launches > launches + 100);
      CHECK(widths.wider() == std::vector<std::string>());
    }
}
