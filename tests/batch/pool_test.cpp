// SPDX-License-Identifier: Apache-2.0
// Batches on pools of devices: the bytes of one device whatever the devices are, whichever fails, and when.
#include <doctest/doctest.h>

#include <fstream>
#include <mutex>
#include <set>
#include <thread>

#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

TEST_CASE("batches of nothing, of empty problems, and of equal ones") {
  Pool pool(test_device());
  const BatchResult nothing = pool.triangulate(Batch());
  CHECK(nothing.size() == 0);
  CHECK(nothing.statistics().triangles == 0);
  const std::vector<Workload> empty(1000);
  Singles(empty).check(pool.triangulate(batch_of(empty)));
  const std::vector<Workload> equal(2000, workload("random_pslg", 5));
  const BatchResult result = pool.triangulate(batch_of(equal));
  const Triangulation one = solver().triangulate(equal[0].points, equal[0].constraints);
  for (std::size_t p = 0; p < equal.size(); ++p) CHECK(difference(detail::triangulation(result, p), one) == "");
}

TEST_CASE("one problem of 1,000,000 vertices beside 10,000 of 20") {
  std::vector<Workload> problems;
  for (std::uint64_t i = 0; i < 10000; ++i) problems.push_back(uniform(20, i));
  problems.insert(problems.begin() + 5000, uniform(1000000));
  Pool two = make_pool(half_devices());
  Singles(problems).check(two.triangulate(batch_of(problems)));
}

TEST_CASE("all types of coordinates, and options, as for one problem") {
  const Integers input = integer_input();
  const std::vector<std::uint64_t> offsets = {0, input.points.size()},
                                   constraint_offsets = {0, input.constraints.size()};
  Options options;
  options.grid = FixedGrid{};
  options.crossing = Crossing::drop;
  options.check = false;
  Pool pool(test_device());
  const Triangulation expected = solver().triangulate(input.points, input.constraints, options);
  CHECK(difference(detail::triangulation(
                       pool.triangulate({input.points, offsets, input.constraints, constraint_offsets}, options), 0),
                   expected) == "");
  std::vector<std::array<float, 2>> floats;
  for (const Int2& p : input.points) floats.push_back({float(p[0]), float(p[1])});
  CHECK(difference(detail::triangulation(
                       pool.triangulate({floats, offsets, input.constraints, constraint_offsets}, options), 0),
                   expected) == "");
}

TEST_CASE("domains of a batch on two devices") {
  std::vector<Workload> problems = corpus({"ok"});
  for (const Workload& problem : generated_problems()) problems.push_back(problem);
  Options options;
  options.domain = Domain::nonzero;
  options.crossing = Crossing::drop;
  Pool two = make_pool(half_devices());
  Singles(problems, options).check(two.triangulate(batch_of(problems), options));
}

TEST_CASE("the ragged copy is the problems' arrays one after the other") {
  const std::vector<Workload> problems = smallest_problems();
  Pool pool(test_device());
  const BatchResult result = pool.triangulate(batch_of(problems));
  std::vector<std::uint64_t> offsets(problems.size() + 1);
  for (const auto& [array, name] : arrays()) {
    CAPTURE(name);
    REQUIRE(gcdt_batch_copy(result.handle(), array, nullptr, 0, offsets.data()) == GCDT_OK);
    const std::size_t bytes = gcdt_element_bytes(array);
    std::vector<unsigned char> flat(offsets.back() * bytes + 1, 77);
    if (offsets.back() > 0)
      CHECK(gcdt_batch_copy(result.handle(), array, flat.data(), offsets.back() - 1, nullptr) ==
            GCDT_ERROR_BUFFER_TOO_SMALL);
    CHECK(std::count(flat.begin(), flat.end(), 77) == static_cast<long>(flat.size()));
    CHECK(gcdt_batch_copy(result.handle(), array, flat.data(), offsets.back(), nullptr) == GCDT_OK);
    CHECK(flat.back() == 77);
    for (std::size_t p = 0; p < problems.size(); ++p) {
      const void* data = nullptr;
      std::uint64_t count = 0;
      REQUIRE(gcdt_batch_array(result.handle(), p, array, &data, &count) == GCDT_OK);
      CHECK(count == offsets[p + 1] - offsets[p]);
      if (count > 0) CHECK(std::memcmp(data, flat.data() + offsets[p] * bytes, count * bytes) == 0);
    }
  }
}

TEST_CASE("what makes no sense is refused, and the pool works on") {
  Pool pool(test_device());
  const std::vector<std::array<double, 2>> points = {{0, 0}, {1, 0}, {0, 1}};
  const std::vector<std::uint64_t> right = {0, 3}, falling = {2, 0}, beyond = {0, 4};
  const std::vector<Constraint> constraints = {{0, 1}};
  CHECK_THROWS_AS(pool.triangulate({points, falling, {}, {}}), Error);
  CHECK_THROWS_AS(pool.triangulate({points, beyond, {}, {}}), Error);
  CHECK_THROWS_AS(pool.triangulate({points, right, constraints, {}}), Error);
  CHECK_THROWS_AS(pool.triangulate({points, right, constraints, beyond}), Error);
  Options bad_grid;
  bad_grid.grid = FixedGrid{0, 0, "zero"};
  CHECK_THROWS_AS(pool.triangulate({points, right, {}, {}}, bad_grid), Error);
  Options seeds;
  seeds.hole_seeds = {{0.1, 0.1}};
  CHECK_THROWS_AS(pool.triangulate({points, right, {}, {}}, seeds), Error);
  Options stop;
  stop.progress = [](const char*, double) { return false; };
  try {
    pool.triangulate({points, right, {}, {}}, stop);
    FAIL("not stopped");
  } catch (const Error& error) {
    CHECK(error.status() == Status::cancelled);
  }
  CHECK(pool.triangulate({points, right, {}, {}}).triangles(0).size() == 1);
  CHECK(gcdt_pool_triangulate(nullptr, nullptr, nullptr, nullptr) == GCDT_ERROR_INVALID_ARGUMENT);
  for (const char* none : {"no such device", "cpu,no such device", ",", "99"}) CHECK_THROWS_AS(Pool{none}, Error);
}

TEST_CASE("a trace of a pool has every device's phases and plan, and so has its log") {
  std::set<std::uint32_t> devices;
  std::set<std::string> phases;
  std::size_t traced = 0, logged = 0;
  const auto counts = [](const std::string& text, const char* words) { return text.find(words) == 0; };
  Pool two = make_pool(
      half_devices(), [&](int, const char* message) { logged += counts(message, "pool plan: 1 worker; jobs of "); },
      [&](const TraceSpan& span) {
        devices.insert(span.device_number % 2);  // and workers
        phases.insert(span.phase);
        traced += span.phase == "plan" && counts(span.name, "1 worker; jobs of ");
      });
  two.triangulate(batch_of(std::vector<Workload>(3000, workload("random_pslg", 4))));
  CHECK(devices == std::set<std::uint32_t>{0, 1});
  CHECK(phases == std::set<std::string>{"order", "plan", "insert", "constrain", "flip", "check", "output", "copy"});
  CHECK(traced == 2);
  CHECK(logged == 2);
}

#ifdef __linux__
TEST_CASE("100 batches in one process take no more memory than the first ten") {
  Pool pool(test_device());
  const auto resident = [] {
    std::size_t total = 0, pages = 0;
    std::ifstream("/proc/self/statm") >> total >> pages;
    return pages * 4096;
  };
  std::size_t first = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    pool.triangulate(batch_of(std::vector<Workload>(200 + i % 7, workload("random_pslg", 6))));
    if (i < 10) first = std::max(first, resident());
  }
#ifndef __SANITIZE_ADDRESS__
  CHECK(resident() <= first + (std::size_t{8} << 20));
#endif
}
#endif

// ---- Devices that fail ------------------------------------------------------------------------------

namespace {

struct Outcome {
  bool right = false;    ///< every byte
  bool refused = false;  ///< some problem has an error, all others are right
  std::string message;   ///< of the call, if it failed
};

Outcome outcome_of(DevicePool& pool, const RaggedBatch& batch, const std::vector<Triangulation>& expected) {
  try {
    const PoolResult result = pool.triangulate(batch.view(), {});
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

}  // namespace

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

namespace {

std::vector<Workload> valid_problems() {
  std::vector<Workload> valid = corpus({"ok"});
  for (int i = 0; i < 40; ++i) valid.push_back(workload("random_pslg", 4 + std::size_t(i) % 5));
  return valid;
}

}  // namespace

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

// ---- Devices that warm up --------------------------------------------------------------------------

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

TEST_CASE("launches wider than they need to be give the same bytes, also of meshes with fewer edges") {
  std::vector<Workload> problems = valid_problems();
  problems.push_back(uniform(40000));
  const RaggedBatch batch(problems);
  const std::vector<Triangulation> expected = Singles(problems).meshes;
  runtime::CallHook hook = healthy();
  hook.tuning.width = 1024;
  DevicePool two({{cl::Context(), app_device(), hook}, {cl::Context(), app_device(), hook}}, {}, {});
  for (int round = 0; round < 3; ++round) CHECK(outcome_of(two, batch, expected).right);
  for (std::uint32_t n = 3; n < 40; ++n) {
    CAPTURE(n);
    Workload small = uniform(n);
    small.constraints = {{0, n - 1}};
    const std::vector<Workload> one = {small};
    CHECK(outcome_of(two, RaggedBatch(one), Singles(one).meshes).right);
  }
}

TEST_CASE("tickets of work-items do not run into the stamps, however wide launches are") {
  runtime::CallHook hook = healthy();
  hook.tuning.width = 1000;
  const runtime::Runtime runtime(app_device(), hook);
  CHECK(runtime.most_work_items() >= 1000);
  CHECK((std::uint64_t{1} << Stamps(runtime, runtime.most_work_items()).bits()) >= runtime.most_work_items());
  CHECK(Stamps(runtime, 1).bits() == 1);
  CHECK(Stamps(runtime, 1024).bits() == 10);  // tickets 0 to 1023
  CHECK(Stamps(runtime, 1025).bits() == 11);
}

TEST_CASE("a device may be used but for some of its compute units") {
  const cl::Device whole = app_device();
  const cl_uint units = whole.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  const cl::Device part = runtime::part_of(whole, 1);
  cl::Device other = whole;
  const cl_device_partition_property one[] = {CL_DEVICE_PARTITION_BY_COUNTS, 1, CL_DEVICE_PARTITION_BY_COUNTS_LIST_END,
                                              0};
  std::vector<cl::Device> parts;
  const bool divides = units > 1 && other.createSubDevices(one, &parts) == CL_SUCCESS;
  CHECK(part.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>() == (divides ? units - 1 : units));
  CHECK(runtime::part_of(whole, 1000).getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>() == (divides ? 1 : units));
  CHECK(runtime::part_of(whole, 0)() == whole());
  const std::vector<Workload> problems = valid_problems();
  DevicePool pool({{cl::Context(), part, {}}}, {}, {});
  const Singles singles(problems);
  CHECK(outcome_of(pool, RaggedBatch(problems), singles.meshes).right);
}
