// SPDX-License-Identifier: Apache-2.0
// pool_crossings_test.cpp for a device treated as a GPU, where all constraints are enforced at once.
#include "crossing_cases.hpp"
#include "kinds.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

runtime::CallHook as_gpu(std::uint32_t workers) {
  runtime::CallHook hook;
  hook.tuning.kind = DeviceKind::gpu;
  hook.tuning.workers = workers;
  hook.tuning.job_overhead = 0;
  return hook;
}

}  // namespace

TEST_CASE("random batches with many crossings, and with one or all, are as alone under all policies") {
  DevicePool pool({{cl::Context(), app_device(), as_gpu(2)}}, {}, {});
  for (const Crossing policy : crossing_policies)
    for (const std::size_t every : {1, 2, 40}) {
      CAPTURE(every);
      const auto problems = random_problems(40, every, [&](std::size_t p) { return p % every == 0; });
      check_as_alone(pool, problems, with_policy(policy));
    }
}

TEST_CASE("problems that cross are no reason to insert the others again, nor to list crossings problem by problem") {
  CountingPool counting(as_gpu(1));
  for (const Crossing policy : {Crossing::reject, Crossing::drop})
    check_launches(counting, policy, 90, "insert_problems");
}
