// SPDX-License-Identifier: Apache-2.0
// Devices of a pool that fail, at any call: no byte changes, nothing hangs, and who is lost says why.
#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// A pool of one such device; what it answers is right or an error. Whether it was one.
bool fails_single(const std::shared_ptr<std::atomic<std::uint64_t>>& calls, std::uint64_t k, bool for_good, cl_int code,
                  const RaggedBatch& batch, const std::vector<Triangulation>& expected) {
  *calls = 0;
  try {
    DevicePool single({{cl::Context(), app_device(), failing(calls, k, for_good, code)}}, {}, {});
    const Outcome outcome = outcome_of(single, batch, expected);
    CHECK((outcome.right || !outcome.message.empty() || outcome.refused));
    return !outcome.right;
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find("no device of the pool is left") == 0);
    return true;
  }
}

}  // namespace

TEST_CASE("a device that fails at its k-th OpenCL call, for every k, changes no byte and hangs nothing") {
  std::vector<Workload> problems = {problem({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}, {3, 2}, {1, 2}},
                                            {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {6, 4}}),
                                    uniform(6), problem({{0.1, 0.2}})};
  const RaggedBatch batch(problems);
  const std::vector<Triangulation> expected = Singles(problems).meshes;
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  {
    DevicePool pool({{cl::Context(), app_device(), failing(calls, 0, false, 0)}}, {}, {});
    REQUIRE(outcome_of(pool, batch, expected).right);
  }
  const std::uint64_t all = *calls;
  MESSAGE(all << " calls");
  REQUIRE(all > 100);
  std::uint64_t failed = 0, lost = 0;
  for (std::uint64_t k = 1; k <= all; ++k) {
    CAPTURE(k);
    const bool for_good = k % 2 == 0;  // lost, or failed once
    const cl_int code = k % 3 == 0 ? CL_OUT_OF_HOST_MEMORY : CL_INVALID_COMMAND_QUEUE;
    if (k % 5 == 0) failed += fails_single(calls, k, for_good, code, batch, expected);
    *calls = 0;
    DevicePool pool(
        {{cl::Context(), app_device(), failing(calls, k, for_good, code)}, {cl::Context(), app_device(), healthy()}},
        {}, {});
    const Outcome outcome = outcome_of(pool, batch, expected);
    CAPTURE(outcome.message);
    CHECK(outcome.right);
    CHECK(!pool.report(1).lost);
    lost += pool.report(0).lost.has_value();
    if (pool.report(0).lost) CHECK(std::string(pool.report(0).lost->what()).find("OpenCL code") != std::string::npos);
    CHECK(pool.report(0).problems + pool.report(1).problems == problems.size());
  }
  CHECK(failed > all / 15);
  CHECK(lost > all / 4);  // it may have got the problem without constraints, which takes half as many calls
  MESSAGE(failed << " of " << all / 5 << " failed without another device, " << lost << " were lost beside one");
}

TEST_CASE("when all devices fail, the error has every device's reason") {
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  const runtime::CallHook broken = failing(calls, 1, true, CL_OUT_OF_RESOURCES);
  try {
    DevicePool pool({{cl::Context(), app_device(), broken}, {cl::Context(), app_device(), broken}}, {}, {});
    FAIL("a pool of broken devices");
  } catch (const Error& error) {
    const std::string message = error.what();
    CHECK(error.opencl_code() == CL_OUT_OF_RESOURCES);
    const std::size_t first = message.find("clCreateContext");
    CHECK(first != std::string::npos);
    CHECK(message.find("clCreateContext", first + 1) != std::string::npos);
  }
}

TEST_CASE("two workers on one device give the bytes of one, also when a call of either fails") {
  std::vector<Workload> problems = valid_problems();
  problems.push_back(uniform(40000));
  const RaggedBatch batch(problems);
  const std::vector<Triangulation> expected = Singles(problems).meshes;
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  const auto two_workers = [&](std::uint64_t k, bool for_good, cl_int code) {
    runtime::CallHook hook = failing(calls, k, for_good, code);
    hook.tuning.workers = 2;
    hook.tuning.job_overhead = 0;                                          // so that there is more than one job
    hook.tuning.prepares_host_memory = hook.tuning.shares_context = true;  // as on a GPU
    hook.tuning.rounds_per_read = 16;
    return hook;
  };
  *calls = 0;
  DevicePool pool({{cl::Context(), app_device(), two_workers(0, false, 0)}}, {}, {});
  REQUIRE(pool.size() == 1);
  for (int round = 0; round < 2; ++round) {  // with throughputs unknown and known
    CHECK(outcome_of(pool, batch, expected).right);
    CHECK(pool.report(0).problems == problems.size());
    if (round == 0) CHECK(pool.report(0).runs >= 2);  // later a fast worker may take all
  }
  const std::uint64_t all = *calls / 2;
  for (std::uint64_t k = 1; k < all; k += 1 + all / 40) {
    CAPTURE(k);
    *calls = 0;
    // Once without memory, which may be the other worker's fault; or lost.
    const bool for_good = k % 2 == 0;
    const cl_int code = for_good ? CL_INVALID_COMMAND_QUEUE : CL_MEM_OBJECT_ALLOCATION_FAILURE;
    DevicePool both(
        {{cl::Context(), app_device(), two_workers(k, for_good, code)}, {cl::Context(), app_device(), healthy()}}, {},
        {});
    const Outcome outcome = outcome_of(both, batch, expected);
    CAPTURE(outcome.message);
    CHECK(outcome.right);
    CHECK(both.report(0).problems + both.report(1).problems == problems.size());
  }
}
