// SPDX-License-Identifier: Apache-2.0
// Crossings in batches are found for all problems together, and what becomes of each is what becomes of it alone; where
// work-items are threads' loops. gpu_crossings_test.cpp has devices treated as GPUs.
#include "crossing_cases.hpp"

#include <limits>

using namespace gcdt;
using namespace gcdt::test;

namespace {

runtime::CallHook with_workers(std::uint32_t workers) {
  runtime::CallHook hook;
  hook.tuning.workers = workers;
  hook.tuning.job_overhead = 0;
  return hook;
}

DevicePool pool_of(const runtime::CallHook& hook) { return {{{cl::Context(), app_device(), hook}}, {}, {}}; }

}  // namespace

TEST_CASE("random batches with many crossings are as alone under all policies, by one worker and by three") {
  DevicePool one = pool_of(with_workers(1)), three = pool_of(with_workers(3));
  for (const Crossing policy : crossing_policies)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(seed);
      const auto problems = random_problems(90, seed, [&](std::size_t p) { return (p + seed) % (seed + 1) == 0; });
      check_as_alone(one, problems, with_policy(policy));
      check_as_alone(three, problems, with_policy(policy));
    }
}

TEST_CASE("the first, the last, all, and all but one of the problems cross; twice in the same pool") {
  DevicePool pool = pool_of(with_workers(1));
  const std::size_t count = 40;
  const std::vector<std::function<bool(std::size_t)>> which = {
      [](std::size_t p) { return p == 0; }, [&](std::size_t p) { return p == count - 1; },
      [](std::size_t) { return true; }, [&](std::size_t p) { return p != count / 2; }};
  for (const Crossing policy : crossing_policies)
    for (std::size_t i = 0; i < which.size(); ++i) {
      CAPTURE(i);
      const auto problems = random_problems(count, 9, which[i]);
      for (int time = 0; time < 2; ++time) check_as_alone(pool, problems, with_policy(policy));
    }
}

TEST_CASE("domains beside problems that cross") {
  DevicePool pool = pool_of(with_workers(1));
  const auto problems = random_problems(60, 5, [](std::size_t p) { return p % 4 == 3; });
  for (const Crossing policy : crossing_policies)
    for (const Domain domain : {Domain::hull, Domain::even_odd, Domain::outer}) {
      Options options = with_policy(policy);
      options.domain = domain;
      options.regions = true;
      check_as_alone(pool, problems, options);
    }
}

TEST_CASE("problems that cross beside some that are invalid, and beside one too large for one work-item") {
  DevicePool pool = pool_of(with_workers(1));
  auto problems = random_problems(60, 3, [](std::size_t p) { return p % 5 == 2; });
  problems[7].constraints.push_back({0, 1000000});
  problems[12].constraints.push_back({1000000, 0});  // which crosses, too
  problems[30].points[1][0] = std::numeric_limits<double>::infinity();
  for (const Crossing policy : crossing_policies) check_as_alone(pool, problems, with_policy(policy));
  problems.push_back(uniform(30000));
  for (const Crossing policy : crossing_policies) check_as_alone(pool, problems, with_policy(policy));
}

TEST_CASE("problems that cross are no reason to insert the others again, nor to list crossings problem by problem") {
  CountingPool counting(with_workers(1));
  check_launches(counting, Crossing::reject, 75, "grow_problems");
  check_launches(counting, Crossing::drop, 1, "grow_problems");
}

TEST_CASE(
    "where many constraints cross the same faces, all pairs of a problem's are tested, and none of two problems") {
  CountingPool counting(with_workers(1));
  std::vector<Workload> problems = random_problems(20, 6, [](std::size_t) { return false; });
  for (std::uint32_t size = 10; size < 30; ++size) {  // two columns, and lines between them that cross all others
    problems.emplace_back();
    for (std::uint32_t i = 0; i < size; ++i) {
      problems.back().points.push_back({0.0, 10.0 * i + i % 3});
      problems.back().points.push_back({1000.0, 10.0 * i + i % 4});
      problems.back().constraints.push_back({2 * i, 2 * (size - 1 - i) + 1});
    }
  }
  for (const Crossing policy : {Crossing::reject, Crossing::drop})
    check_as_alone(counting.pool(), problems, with_policy(policy));
  CHECK(counting.launches(problems, with_policy(Crossing::reject))["crossings_all"] > 0);
}

TEST_CASE("a device without the memory to list crossings takes fewer problems at once") {
  const auto problems = random_problems(90, 2, [](std::size_t p) { return p % 3 == 0; });
  const auto left = std::make_shared<std::atomic<int>>(1);
  runtime::CallHook hook = with_workers(1);
  hook.before = [left](const char*, const char* detail) {
    return std::string(detail) == "crossings_pairs" && --*left >= 0 ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS;
  };
  DevicePool pool = pool_of(hook);
  check_as_alone(pool, problems, with_policy(Crossing::reject));
  CHECK(*left < 0);
  CHECK(pool.report(0).runs > 1);
  CHECK(!pool.report(0).lost);
}
