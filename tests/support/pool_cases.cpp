// SPDX-License-Identifier: Apache-2.0
#include "pool_cases.hpp"

#include <chrono>
#include <thread>

namespace gcdt::test {

namespace {

template <class Part>
void check_one(const Singles& singles, std::size_t p, const std::string& error, const Part& part) {
  CAPTURE(p);
  CHECK(error == singles.errors[p]);
  if (singles.errors[p].empty()) CHECK(difference(part(), singles.meshes[p]) == "");
}

}  // namespace

Singles::Singles(const std::vector<Workload>& problems, const Options& options) {
  for (const Workload& problem : problems) {
    meshes.emplace_back();
    errors.emplace_back();
    try {
      meshes.back() = solver().triangulate(problem.points, problem.constraints, options);
    } catch (const Error& error) {
      errors.back() = error.what();
    }
  }
}

void Singles::check(const BatchResult& result) const {
  REQUIRE(result.size() == meshes.size());
  std::uint64_t failed = 0;
  for (std::size_t p = 0; p < meshes.size(); ++p) {
    const std::optional<Error> error = result.error(p);
    if (error) ++failed;
    check_one(*this, p, error ? error->what() : "", [&] { return detail::triangulation(result, p); });
  }
  CHECK(result.statistics().failed == failed);
}

void Singles::check(const PoolResult& result) const {
  REQUIRE(result.places.size() == meshes.size());
  for (std::uint32_t p = 0; p < meshes.size(); ++p) {
    const auto error = result.errors.find(p);
    const Schedule::Place place = result.places[p];
    check_one(*this, p, error != result.errors.end() ? error->second.what() : "",
              [&] { return test::part_of(result.results.at(place.result), place.place); });
  }
}

Batch batch_of(const std::vector<Workload>& problems) {
  Batch batch;
  for (const Workload& problem : problems) batch.add(problem.points, problem.constraints);
  return batch;
}

std::vector<cl::CommandQueue> half_devices() {
  cl::Device whole = app_device();
  static std::vector<cl::Device> halves;  // for good: PoCL's contexts do not keep their sub-devices
  const cl_device_partition_property parts[] = {CL_DEVICE_PARTITION_BY_COUNTS, 1, 1,
                                                CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
  if (halves.empty() && whole.createSubDevices(parts, &halves) != CL_SUCCESS) halves = {whole, whole};
  std::vector<cl::CommandQueue> queues;
  for (const cl::Device& half : halves) queues.emplace_back(cl::Context(half), half);
  return queues;
}

runtime::CallHook healthy() {
  runtime::CallHook hook;
  hook.keep_programs = true;  // hundreds of runtimes, each of which would compile
  return hook;
}

runtime::CallHook failing(std::shared_ptr<std::atomic<std::uint64_t>> calls, std::uint64_t k, bool for_good,
                          cl_int code) {
  runtime::CallHook hook = healthy();
  hook.before = [=](const char*, const char*) {
    const std::uint64_t call = ++*calls;
    return call == k || (for_good && call > k) ? code : CL_SUCCESS;
  };
  return hook;
}

runtime::CallHook behind(std::shared_ptr<std::atomic<std::uint64_t>> calls, std::uint64_t k) {
  runtime::CallHook hook = healthy();
  hook.before = [=](const char* call, const char*) {
    if (std::string(call) == "clEnqueueNDRangeKernel")
      for (int waits = 0; *calls < k && waits < 500; ++waits) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return CL_SUCCESS;
  };
  return hook;
}

Outcome outcome_of(DevicePool& pool, const RaggedBatch& batch, const std::vector<Triangulation>& expected,
                   const Options& options) {
  try {
    const PoolResult result = pool.triangulate(batch.view(), options);
    Outcome outcome{true, false, ""};
    for (std::size_t p = 0; p < expected.size(); ++p) {
      const Schedule::Place place = result.places[p];
      outcome.refused = outcome.refused || result.errors.count(p) > 0;
      outcome.right = outcome.right && result.errors.count(p) == 0 &&
                      difference(test::part_of(result.results[place.result], place.place), expected[p]).empty();
    }
    return outcome;
  } catch (const Error& error) {
    return {false, false, error.what()};
  }
}

void check_failing_calls(const std::vector<Workload>& problems, const Options& options, std::uint64_t samples,
                         const std::vector<cl_int>& codes, std::uint32_t most_workers) {
  const RaggedBatch batch(problems);
  const std::vector<Triangulation> expected = Singles(problems, options).meshes;
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  {
    runtime::CallHook counted = failing(calls, 0, false, 0);
    counted.tuning.workers = 1;
    DevicePool pool({{cl::Context(), app_device(), counted}}, {}, {});
    REQUIRE(outcome_of(pool, batch, expected, options).right);
  }
  const std::uint64_t all = *calls;
  std::uint64_t lost = 0, tried = 0;
  for (std::uint64_t k = 1; k <= all; k += 1 + all / samples, ++tried) {
    CAPTURE(k);
    *calls = 0;
    runtime::CallHook broken = failing(calls, k, tried % 2 == 0, codes[tried % codes.size()]);
    broken.tuning.workers = 1 + static_cast<std::uint32_t>(tried / 2 % most_workers);
    DevicePool pool({{cl::Context(), app_device(), broken}, {cl::Context(), app_device(), behind(calls, k)}}, {}, {});
    const Outcome outcome = outcome_of(pool, batch, expected, options);
    CAPTURE(outcome.message);
    CHECK(outcome.right);
    CHECK(!pool.report(1).lost);
    lost += pool.report(0).lost.has_value();
    CHECK(pool.report(0).problems + pool.report(1).problems == problems.size());
  }
  CHECK(lost > tried / 2);  // the others lack memory once, which loses no device
}

std::vector<Workload> valid_problems() {
  std::vector<Workload> valid = corpus({"ok"});
  for (int i = 0; i < 40; ++i) valid.push_back(workload("random_pslg", 4 + std::size_t(i) % 5));
  return valid;
}

}  // namespace gcdt::test
