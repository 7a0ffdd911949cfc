// SPDX-License-Identifier: Apache-2.0
// Batches on pools of devices: the bytes of one device, whatever the devices are.
#include <doctest/doctest.h>

#include <fstream>
#include <set>

#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

TEST_CASE("offsets into arrays that are null are of problems without vertices, wherever they say that these begin") {
  const Pool pool(test_device());
  const std::uint64_t offsets[] = {12, 12, 12};
  gcdt_batch_input input = GCDT_BATCH_INPUT_INIT;
  input.problem_count = 2, input.vertex_offsets = input.constraint_offsets = offsets;
  gcdt_batch* batch = nullptr;
  REQUIRE(gcdt_pool_triangulate(pool.handle(), &input, nullptr, &batch) == GCDT_OK);
  const BatchResult result(batch);
  CHECK(result.size() == 2);
  for (std::size_t p = 0; p < 2; ++p) {
    CHECK(!result.error(p));
    CHECK(result.representative(p).size() == 0);
  }
  CHECK(result.statistics().vertices == 0);
}

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
  const std::vector<std::uint64_t> two = {0, 3, 3};  // of which problem would they be?
  CHECK_THROWS_AS(pool.triangulate({points, two, {}, {}}, seeds), Error);
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
