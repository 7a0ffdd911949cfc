// SPDX-License-Identifier: Apache-2.0
// How a pool uses its devices: the plan as a table.
#include "batch/pool_plan.hpp"

#include <doctest/doctest.h>

using namespace gcdt;

namespace {

constexpr std::uint64_t gib = std::uint64_t{1} << 30;

PooledDevice device(DeviceKind kind, std::uint64_t memory_bytes = 8 * gib) {
  return {kind, memory_bytes, 16, false, false, {}};
}

const PooledDevice gpu = device(DeviceKind::gpu, 128 * gib), threads = device(DeviceKind::threads),
                   lanes = device(DeviceKind::lanes), accelerator = device(DeviceKind::accelerator);

DevicePlan plan_of(const PooledDevice& one) { return plan_pool({one}).at(0); }

}  // namespace

TEST_CASE("what a pool does with a device, by its kind") {
  struct Row {
    const char* name;
    PooledDevice device;
    std::uint32_t workers;
    bool shares_context, polls;
    std::uint32_t rounds_per_read;
    std::uint64_t capacity, job_bytes, job_weight;
    double job_overhead;
  };
  const Row rows[] = {
      {"GPU", gpu, 3, true, true, 16, 96 * gib, 32 * gib, 1u << 24, 2},
      {"threads", threads, 2, true, false, 4, 6 * gib, 3 * gib, 1u << 17, 0},
      {"lanes", lanes, 1, false, false, 4, 6 * gib, 6 * gib, 1u << 17, 0},
      {"accelerator", accelerator, 1, false, false, 4, 6 * gib, 6 * gib, 1u << 17, 0},
  };
  for (const Row& row : rows) {
    CAPTURE(row.name);
    const DevicePlan plan = plan_of(row.device);
    CHECK(plan.workers == row.workers);
    CHECK(plan.shares_context == row.shares_context);
    CHECK(plan.polls == row.polls);
    CHECK(plan.rounds_per_read == row.rounds_per_read);
    CHECK(plan.capacity == row.capacity);
    CHECK(plan.job_bytes == row.job_bytes);
    CHECK(plan.job_weight == row.job_weight);
    CHECK(plan.job_overhead == row.job_overhead);
    CHECK(!plan.beside_gpus);
    CHECK(!plan.warms_up);
    CHECK(plan.cores_left == 0);
  }
}

TEST_CASE("devices beside GPUs warm up, and CPUs leave two compute units to each worker of a GPU") {
  PooledDevice given = threads, lost = gpu;
  given.given_context = lost.lost = true;
  struct Row {
    const char* name;
    std::vector<PooledDevice> devices;  // of which the first one is checked
    bool beside_gpus, warms_up;
    std::uint32_t cores_left;
  };
  const Row rows[] = {
      {"threads beside a GPU", {threads, gpu}, true, true, 6},
      {"threads beside two GPUs", {threads, gpu, gpu}, true, true, 12},
      {"lanes beside a GPU", {lanes, gpu}, true, true, 6},
      {"an accelerator has cores of its own", {accelerator, gpu}, true, true, 0},
      {"the application's context stays as it is", {given, gpu}, true, true, 0},
      {"a GPU beside a GPU", {gpu, gpu}, false, false, 0},
      {"a GPU beside a CPU", {gpu, threads}, false, false, 0},
      {"a CPU beside a CPU", {threads, lanes}, false, false, 0},
      {"beside a lost GPU", {threads, lost}, false, false, 6},
      {"beside a lost GPU and another", {threads, lost, gpu}, true, true, 12},
  };
  for (const Row& row : rows) {
    CAPTURE(row.name);
    const std::vector<DevicePlan> plans = plan_pool(row.devices);
    REQUIRE(plans.size() == row.devices.size());
    CHECK(plans[0].beside_gpus == row.beside_gpus);
    CHECK(plans[0].warms_up == row.warms_up);
    CHECK(plans[0].cores_left == row.cores_left);
  }
}

TEST_CASE("a CPU has two workers if it has two cores, and no GPU beside it that wants them") {
  PooledDevice one = threads, lost = gpu, given = threads;
  one.compute_units = 1;
  given.given_context = true;
  CHECK(plan_of(given).workers == 1);
  lost.lost = true;
  CHECK(plan_of(one).workers == 1);
  one.compute_units = 2;
  CHECK(plan_of(one).workers == 2);
  CHECK(plan_pool({threads, gpu})[0].workers == 1);
  CHECK(plan_pool({threads, lost})[0].workers == 1);  // workers are made once
  CHECK(plan_pool({threads, lanes})[0].workers == 2);
}

TEST_CASE("tuning decides where it says something") {
  PooledDevice tuned = gpu;
  tuned.tuning.workers = 0;
  CHECK(plan_of(tuned).workers == 1);
  CHECK(!plan_of(tuned).shares_context);  // there is nobody to share it with
  tuned.tuning.workers = 5;
  CHECK(plan_of(tuned).job_bytes == 96 * gib / 5);
  CHECK(plan_of(tuned).capacity == 96 * gib);
  tuned.tuning.rounds_per_read = 100;
  CHECK(plan_of(tuned).rounds_per_read == 100);
  tuned.tuning.shares_context = false;
  CHECK(!plan_of(tuned).shares_context);
  tuned.given_context = true;  // is the one that there is
  CHECK(plan_of(tuned).shares_context);
  tuned.tuning.job_overhead = 0.5;
  CHECK(plan_of(tuned).job_overhead == 0.5);
  tuned.tuning.warms_up = true;
  CHECK(plan_of(tuned).warms_up);
  PooledDevice cpu = threads;
  cpu.tuning.workers = 2;
  CHECK(plan_of(cpu).shares_context);
  CHECK(!plan_of(cpu).polls);
  cpu.tuning.shares_context = true;
  CHECK(plan_of(cpu).polls);
  cpu.tuning.shares_context = false;
  CHECK(!plan_of(cpu).shares_context);
  CHECK(plan_pool({cpu, tuned})[0].cores_left == 10);
  cpu.tuning.warms_up = false;
  CHECK(!plan_pool({cpu, gpu})[0].warms_up);
  CHECK(plan_pool({cpu, gpu})[0].beside_gpus);
}

TEST_CASE("a plan in words names its ways") {
  const auto text = [](const std::vector<PooledDevice>& devices) { return plan_pool(devices)[0].text(); };
  const auto has = [](const std::string& all, const char* words) { return all.find(words) != std::string::npos; };
  CHECK(
      has(text({gpu}), "3 workers in one context, which poll; jobs of weight 16777216 and 34359738368 bytes at most"));
  CHECK(has(text({gpu}), "16 rounds between reads"));
  CHECK(!has(text({gpu}), "warms up"));
  CHECK(has(text({threads}), "2 workers in one context; jobs of weight 131072"));
  CHECK(has(text({threads, gpu}), "1 worker; jobs of weight 131072"));
  CHECK(!has(text({threads}), "beside GPUs"));
  CHECK(has(text({threads, gpu}), "beside GPUs; 6 compute units left to the threads that feed GPUs; warms up"));
}
