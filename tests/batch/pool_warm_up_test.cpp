// SPDX-License-Identifier: Apache-2.0
// Devices of a pool that warm up while others work.
#include <mutex>
#include <set>
#include <thread>

#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Of a device: which kernels were made, and how many launches. Each launch may take longer.
struct Watch {
  std::mutex mutex;
  std::set<std::string> kernels;
  std::atomic<std::uint64_t> launches{0};
  std::chrono::milliseconds delay{0};

  runtime::CallHook hook() {
    runtime::CallHook hook;
    hook.keep_programs = true;
    hook.tuning.warms_up = true;
    hook.tuning.workers = 1;  // as beside GPUs, where devices warm up
    hook.before = [this](const char* call, const char* detail) {
      const std::string name = call;
      if (name == "clCreateKernel") {
        const std::lock_guard<std::mutex> lock(mutex);
        kernels.insert(detail);
      } else if (name == "clEnqueueNDRangeKernel") {
        ++launches;
        std::this_thread::sleep_for(delay);
      }
      return CL_SUCCESS;
    };
    return hook;
  }
};

std::vector<Workload> sketches(std::size_t count, bool crossing) {
  std::vector<Workload> all;
  for (std::size_t i = 0; i < count; ++i) {
    all.push_back(workload("random_pslg", 4 + i % 5));
    if (crossing && i == 0) {  // one that is large
      all.push_back(uniform(5000));
      all.back().points.insert(all.back().points.end(), {{-1, -1}, {2, 2}, {-1, 2}, {2, -1}});
      all.back().constraints = {{5000, 5001}, {5002, 5003}};
    }
    if (crossing && i % 3 == 0) all.push_back(problem({{0, 0}, {4, 4}, {0, 4}, {4, 1}}, {{0, 1}, {2, 3}}));
  }
  return all;
}

void check_call(DevicePool& pool, const std::vector<Workload>& problems, const Options& options) {
  Singles(problems, options).check(pool.triangulate(RaggedBatch(problems).view(), options));
}

}  // namespace

TEST_CASE("a device that warms up has launched all kernels of jobs in the first call with such options") {
  Watch watch;
  DevicePool pool({{cl::Context(), app_device(), watch.hook()}}, {},
                  {});  // no other device: the same jobs in every run
  const RaggedBatch nothing(std::vector<Workload>{});
  for (const Crossing crossing : {Crossing::reject, Crossing::drop, Crossing::split})
    for (const Domain domain : {Domain::hull, Domain::nonzero}) {
      CAPTURE(int(crossing));
      CAPTURE(int(domain));
      Options options;
      options.crossing = crossing;
      options.domain = domain;
      const std::uint64_t launches = watch.launches;
      pool.triangulate(nothing.view(), options);
      CHECK(watch.launches > launches);
      const std::set<std::string> before = watch.kernels;
      std::vector<Workload> problems = sketches(300, true);
      for (const std::size_t n : {30000, 12000, 3000, 900}) problems.push_back(uniform(n));
      problems.push_back(workload("random_pslg", 60));
      problems.push_back(workload("random_pslg", 100));
      check_call(pool, problems, options);
      std::string further;
      for (const std::string& kernel : watch.kernels)
        if (before.count(kernel) == 0) further += " " + kernel;
      CHECK(further == "");
    }
}

TEST_CASE("a warm-up ends when the call is cancelled") {
  Watch watch;
  watch.delay = std::chrono::milliseconds(50);
  DevicePool pool({{cl::Context(), app_device(), healthy()}, {cl::Context(), app_device(), watch.hook()}}, {}, {});
  const RaggedBatch batch(sketches(20, false));
  const std::uint64_t launches = watch.launches;
  Options options;
  options.progress = [](const char*, double) { return false; };
  CHECK_THROWS_AS(pool.triangulate(batch.view(), options), Error);
  CHECK(watch.launches < launches + 10);  // a warm-up has dozens, and the first progress is told after 50 ms
  options.progress = {};
  CHECK(outcome_of(pool, batch, Singles(sketches(20, false)).meshes).right);
}

TEST_CASE("a device that warms up does the work of those that are lost, and may be lost in its warm-up") {
  const std::vector<Workload> problems = sketches(20, false);
  const RaggedBatch batch(problems);
  const std::vector<Triangulation> expected = Singles(problems).meshes;
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  for (const std::uint64_t k : {100, 150, 200, 400}) {
    CAPTURE(k);
    const runtime::CallHook broken = failing(calls, k, true, CL_INVALID_COMMAND_QUEUE);
    runtime::CallHook warming = healthy();
    warming.tuning.warms_up = true;
    *calls = 0;
    DevicePool first({{cl::Context(), app_device(), broken}, {cl::Context(), app_device(), warming}}, {}, {});
    for (int call = 0; call < 8; ++call) CHECK(outcome_of(first, batch, expected).right);  // it fails in one of them
    CHECK(first.report(0).lost);
    CHECK(first.report(1).problems == problems.size());
    warming = broken;
    warming.tuning.warms_up = true;
    *calls = 0;
    DevicePool second({{cl::Context(), app_device(), healthy()}, {cl::Context(), app_device(), warming}}, {}, {});
    CHECK(outcome_of(second, batch, expected).right);
    CHECK(second.report(0).problems == problems.size());
    CHECK(second.report(1).lost);
  }
}
