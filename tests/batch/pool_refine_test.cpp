// SPDX-License-Identifier: Apache-2.0
// Refinement in batches: each problem has the bytes that it would have alone, whatever else is in the batch, and an
// error of its own.
#include <cmath>
#include <cstddef>
#include <cstring>

#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

Options refining(double angle = 25) {
  Options options;
  options.refine = Refinement{};
  options.refine->least_angle = angle;
  options.refine->most_added = 400;
  return options;
}

/// Small and larger ones, on several grids; some that cross; one with an index that does not exist, and one that is not
/// finite.
std::vector<Workload> all_problems() {
  std::vector<Workload> all = smallest_problems();
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    all.push_back(random_pslg(10 + 5 * seed, 1000, 40, seed));
    all.push_back(uniform(20 + 20 * seed, seed));
  }
  all.push_back(problem({{0, 0}, {4, 4}, {0, 4}, {4, 0}}, {{0, 1}, {2, 3}}));
  all.insert(all.begin() + 3, problem({{0, 0}, {9, 9}, {9, 0}, {0, 9}}, {{0, 1}, {1, 4}}));
  all.push_back(problem({{0, 0}, {9, std::nan("")}, {9, 0}}));
  return all;
}

}  // namespace

TEST_CASE("problems are refined as alone: one device, and two sub-devices, under each rule for crossings and domains") {
  const std::vector<Workload> problems = all_problems();
  const Batch batch = batch_of(problems);
  Pool one(test_device()), two = make_pool(half_devices());
  std::vector<Options> all(4, refining());
  all[1].crossing = Crossing::split, all[1].domain = Domain::outer, all[1].canonical = false;
  all[2].crossing = Crossing::drop, all[2].regions = true;
  all[3].grid = FixedGrid{};
  all[3].refine->splits = Splits::inner;
  for (Options& options : all) {
    const BatchResult result = one.triangulate(batch, options), shared = two.triangulate(batch, options);
    options.canonical = true;  // as batches are
    const Singles singles(problems, options);
    std::size_t failed = 0, refined = 0;
    for (std::size_t p = 0; p < problems.size(); ++p) {
      failed += !singles.errors[p].empty();
      refined += singles.meshes[p].statistics.refine.added > 0;
    }
    CHECK(failed >= 2);
    CHECK(refined >= 5);
    singles.check(result);
    singles.check(shared);
    for (const PoolDevice& device : two.devices()) CHECK(!device.lost);
  }
}

TEST_CASE("what is said of each problem is what is said alone") {
  const std::vector<Workload> problems = all_problems();
  Options options = refining(33);
  options.refine->most_added = 60;
  Pool pool(test_device());
  const BatchResult result = pool.triangulate(batch_of(problems), options);
  std::size_t limited = 0, left = 0;
  for (std::size_t p = 0; p < problems.size(); ++p) {
    CAPTURE(p);
    const RefinedReport report = result.refined(p);
    if (result.error(p)) {
      CHECK(!report.complete);
      CHECK(report.added == 0);
      continue;
    }
    const Statistics s = solver().triangulate(problems[p].points, problems[p].constraints, options).statistics;
    CHECK(report.complete == s.refine.complete);
    CHECK(report.rounds == s.refine.rounds);
    CHECK(report.added == s.refine.added);
    CHECK(report.left == s.refine.left_input_angle + s.refine.left_beside_angle + s.refine.left_grid +
                             s.refine.left_fixed + s.refine.left_refused + s.refine.left_limit);
    CHECK(result.split(p).vertices_added == s.vertices_added);
    limited += !report.complete;
    left += report.left > 0;
  }
  CHECK(limited > 0);
  CHECK(left > 0);
  // As a caller that knows nothing of these numbers asks.
  gcdt_problem earlier;
  std::memset(&earlier, 77, sizeof earlier);
  earlier.struct_size = offsetof(gcdt_problem, refine_complete);
  REQUIRE((gcdt_batch_problem(result.handle(), 0, &earlier) == GCDT_OK));
  CHECK(earlier.refine_complete == 0x4D4D4D4D4D4D4D4Du);
  // Of a batch that is not refined.
  CHECK(pool.triangulate(batch_of(problems)).refined(0).complete);
}

TEST_CASE("lengths are those of the batch's vertices, wherever its first problem begins") {
  const std::vector<Workload> problems = {uniform(40, 1), uniform(60, 2), uniform(30, 3)};
  std::vector<std::array<double, 2>> vertices = {{7, 7}, {8, 8}};  // of nobody
  std::vector<double> sizes = {1, 1};
  std::vector<std::uint64_t> offsets = {2};
  for (const Workload& work : problems) {
    for (const Point& point : work.points) {
      vertices.push_back(point);
      sizes.push_back(0.02 + point[0] / 5);
    }
    offsets.push_back(vertices.size());
  }
  Options options = refining();
  options.refine->most_added = 100000;
  options.refine->sizes = sizes;
  Pool pool(test_device());
  const BatchResult result = pool.triangulate({vertices, offsets, {}, {}}, options);
  for (std::size_t p = 0; p < problems.size(); ++p) {
    Options own = options;
    own.refine->sizes = {sizes.data() + offsets[p], problems[p].points.size()};
    const Triangulation alone = solver().triangulate(problems[p].points, {}, own);
    CHECK(alone.statistics.refine.added > 100);
    CHECK(difference(detail::triangulation(result, p), alone) == "");
  }
}

TEST_CASE("bad values are the call's, and no device is blamed for them") {
  const std::vector<Workload> problems = {uniform(20), uniform(30, 2)};
  Pool pool(test_device());
  const Batch batch = batch_of(problems);
  Options options = refining(50);
  CHECK_THROWS_WITH_AS(pool.triangulate(batch, options), doctest::Contains("refine.least_angle must be"), Error);
  options = refining();
  const std::vector<double> sizes(20, 1.0), areas = {1};
  options.refine->sizes = sizes;
  CHECK_THROWS_WITH_AS(pool.triangulate(batch, options), doctest::Contains("20 lengths for 50 vertices"), Error);
  options = refining();
  options.refine->region_areas = areas;
  CHECK_THROWS_WITH_AS(pool.triangulate(batch, options), doctest::Contains("1 areas for 0 region seeds"), Error);
  CHECK(!pool.devices()[0].lost);
  CHECK(pool.triangulate(batch, refining()).statistics().failed == 0);
  CHECK(pool.triangulate(Batch{}, refining()).size() == 0);
}

TEST_CASE("from and to device memory") {
  const App app;
  Pool pool(test_device());
  const std::vector<Workload> problems = all_problems();
  const RaggedBatch batch(problems);
  const DeviceBatch given = {Points::Type::float64,         problems.size(),
                             app.buffer(batch.vertices),    app.buffer(batch.vertex_offsets),
                             app.buffer(batch.constraints), app.buffer(batch.constraint_offsets)};
  const BatchResult result = triangulate(pool, app.queue, given, refining());
  const Singles singles(problems, refining());
  singles.check(result);
  std::vector<std::array<std::uint32_t, 4>> expected;
  for (const Triangulation& mesh : singles.meshes)
    expected.insert(expected.end(), mesh.added_origin.begin(), mesh.added_origin.end());
  REQUIRE(expected.size() > 100);
  const cl::Buffer to = app.buffer(16 * expected.size());
  copy(result, GCDT_ADDED_ORIGINS, app.queue, to, expected.size());
  CHECK(app.read<std::array<std::uint32_t, 4>>(to, expected.size()) == expected);
}

TEST_CASE("a run can be stopped, and the pool works on") {
  Pool pool(test_device());
  const std::vector<Workload> problems = {uniform(3000)};
  Options options = refining(30);
  options.refine->most_added = 100000;
  options.progress = [](const char*, double) { return false; };
  CHECK_THROWS_AS(pool.triangulate(batch_of(problems), options), Error);
  options = refining();
  Singles(problems, options).check(pool.triangulate(batch_of(problems), options));
}

TEST_CASE("what a problem needs to be refined, and the device has not, is its own error") {
  const Workload good = problem({{0, 0}, {4, 0}, {0, 4}});  // nothing is inserted there
  const std::vector<Workload> problems = {good, uniform(500), good};
  runtime::CallHook hook;
  hook.before = [](const char*, const char* detail) {
    return std::string(detail) == "refine_insert" ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS;
  };
  DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
  const PoolResult result = pool.triangulate(RaggedBatch(problems).view(), refining(30));
  REQUIRE(result.errors.size() == 1);
  REQUIRE(result.errors.count(1) == 1);
  CHECK(result.errors.at(1).status() == Status::out_of_memory);
  CHECK(!pool.report(0).lost);
  CHECK(pool.report(0).problems == 2);
}

TEST_CASE("a device that fails at its k-th OpenCL call while it refines changes no byte") {
  check_failing_calls({uniform(40), random_pslg(20, 1000, 20, 1), uniform(12, 3)}, refining(), 15,
                      {CL_INVALID_COMMAND_QUEUE}, 1);
}
