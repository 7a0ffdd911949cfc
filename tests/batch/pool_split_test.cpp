// SPDX-License-Identifier: Apache-2.0
// Crossings split in batches: problems that cross have the bytes that they would have alone, beside those that do not.
#include "pool_cases.hpp"
#include "split_graphs.hpp"

#include <cstddef>
#include <cstring>

using namespace gcdt;
using namespace gcdt::test;

namespace {

Workload work_of(const graphs::Graph& graph) {
  Workload work;
  for (const auto& [x, y] : graph.points) work.points.push_back({double(x), double(y)});
  work.constraints = graph.constraints;
  return work;
}

/// With crossings of all kinds: few, many, many in one pixel, and such that routes cross others anew.
std::vector<Workload> crossing_problems() {
  std::vector<Workload> all = {problem({{0, 0}, {4, 4}, {0, 4}, {4, 0}}, {{0, 1}, {2, 3}}),
                               work_of(graphs::lattice(20, 7)), work_of(graphs::star(60, 900)),
                               work_of(graphs::strip(3, 25, 4000, 40))};
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    all.push_back(work_of(graphs::random_graph(seed, 12 + 3 * seed, 10 + 4 * seed, seed % 2 == 0 ? 14 : 900)));
  return all;
}

/// Beside those: problems without crossings, the smallest ones, an invalid one.
std::vector<Workload> all_problems() {
  std::vector<Workload> all = smallest_problems();
  for (const Workload& problem : crossing_problems()) {
    all.push_back(problem);
    all.push_back(workload("random_pslg", 3 + all.size() % 7));
  }
  all.insert(all.begin() + 15, problem({{0, 0}, {9, 9}, {9, 0}, {0, 9}}, {{0, 1}, {2, 3}, {1, 4}}));
  return all;
}

Options splitting_on_any_grid() {
  Options options;
  options.crossing = Crossing::split;
  return options;
}

}  // namespace

TEST_CASE("problems that cross are split as alone: one device, and two sub-devices, on any grid and on a given one") {
  const std::vector<Workload> problems = all_problems();
  const Batch batch = batch_of(problems);
  Pool one(test_device()), two = make_pool(half_devices());
  for (const Options& options : {splitting_on_any_grid(), graphs::splitting()}) {
    const Singles singles(problems, options);
    std::size_t split = 0, failed = 0;
    for (std::size_t p = 0; p < problems.size(); ++p) {
      split += singles.meshes[p].statistics.vertices_added > 0;
      failed += !singles.errors[p].empty();
    }
    CHECK(split >= 10);
    CHECK(failed >= 1);  // and those that are not on the given grid
    CHECK(failed < problems.size() / 2);
    singles.check(one.triangulate(batch, options));
    for (int round = 0; round < 2; ++round) {  // with throughputs unknown and known
      singles.check(two.triangulate(batch, options));
      std::uint64_t done = 0;
      for (const PoolDevice& device : two.devices()) {
        CHECK(!device.lost);
        done += device.problems;
      }
      CHECK(done == problems.size());
    }
  }
}

TEST_CASE("routes that cross others are among the problems, and what is said of moves is what is said alone") {
  std::vector<Workload> problems = crossing_problems();
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    problems.push_back(work_of(graphs::random_graph(seed, 12, 10, 12)));
    problems.push_back(work_of(graphs::random_graph(100 + seed, 40, 24, 60)));
  }
  Pool pool(test_device());
  const BatchResult result = pool.triangulate(batch_of(problems), graphs::splitting());
  std::size_t again = 0, split = 0;  // of the latter, those with a route that another constraint would cross
  for (std::size_t p = 0; p < problems.size(); ++p) {
    CAPTURE(p);
    const Workload& problem = problems[p];
    const Statistics single = solver().triangulate(problem.points, problem.constraints, graphs::splitting()).statistics;
    const SplitReport report = result.split(p);
    CHECK(report.crossings == single.crossings);
    CHECK(report.vertices_added == single.vertices_added);
    CHECK(report.constraints_split == single.constraints_split);
    CHECK(report.constraint_move == single.constraint_move);
    split += report.crossings > 0;
    std::set<std::uint64_t> cross;
    try {
      Options rejecting;
      rejecting.grid = FixedGrid{};
      solver().triangulate(problem.points, problem.constraints, rejecting);
    } catch (const Error& error) {
      cross.insert(error.indices().begin(), error.indices().end());
    }
    again += report.constraints_split > cross.size();
  }
  // As a caller that knows nothing of these numbers asks.
  gcdt_problem earlier;
  std::memset(&earlier, 77, sizeof earlier);
  earlier.struct_size = offsetof(gcdt_problem, crossings);
  // In parentheses: Boost 1.83 would print the enumerator by a library for numbers of 128 bits that is not linked.
  REQUIRE((gcdt_batch_problem(result.handle(), 0, &earlier) == GCDT_OK));
  CHECK(earlier.triangles == result.triangles(0).size());
  CHECK(earlier.crossings == 0x4D4D4D4D4D4D4D4Du);
  CHECK(split > problems.size() / 2);
  CHECK(again > 0);
}

TEST_CASE("the corpus with its crossings split, as one batch") {
  const std::vector<Workload> problems = corpus({"ok", "crossing", "invalid"});
  Pool pool(test_device());
  const Options options = splitting_on_any_grid();
  const Singles singles(problems, options);
  const BatchResult result = pool.triangulate(batch_of(problems), options);
  singles.check(result);
  CHECK(result.statistics().failed == corpus({"invalid"}).size());
}

TEST_CASE("domains and regions of problems that are split") {
  const std::vector<Workload> problems = all_problems();
  Pool two = make_pool(half_devices());
  for (const Domain domain : {Domain::hull, Domain::even_odd, Domain::nonzero, Domain::outer}) {
    Options options = splitting_on_any_grid();
    options.domain = domain;
    options.regions = true;
    options.canonical = false;  // batches are in canonical order all the same
    const BatchResult result = two.triangulate(batch_of(problems), options);
    options.canonical = true;
    Singles(problems, options).check(result);
  }
}

TEST_CASE("all types of coordinates are read where a problem begins") {
  const graphs::Graph graph = graphs::random_graph(9, 20, 30, 400);
  const Triangulation expected = graphs::split(graph);
  REQUIRE(expected.statistics.vertices_added > 0);
  Pool pool(test_device());
  const auto check = [&](auto number) {
    using Number = decltype(number);
    std::vector<std::array<Number, 2>> points = {{7, 7}, {1, 2}, {3, 3}};  // of nobody, and of the first
    for (const auto& [x, y] : graph.points) points.push_back({Number(x), Number(y)});
    std::vector<Constraint> constraints = {{5, 5}, {0, 1}};
    constraints.insert(constraints.end(), graph.constraints.begin(), graph.constraints.end());
    const std::vector<std::uint64_t> offsets = {1, 3, points.size()}, constraint_offsets = {1, 2, constraints.size()};
    const BatchResult result =
        pool.triangulate({points, offsets, constraints, constraint_offsets}, graphs::splitting());
    CHECK(difference(detail::triangulation(result, 1), expected) == "");
    CHECK(!result.error(0));
  };
  check(double{});
  check(float{});
  check(std::int32_t{});
  check(std::int64_t{});
}

TEST_CASE("from and to device memory") {
  const App app;
  Pool pool(test_device());
  const std::vector<Workload> problems = all_problems();
  const RaggedBatch batch(problems);
  const DeviceBatch given = {Points::Type::float64,         problems.size(),
                             app.buffer(batch.vertices),    app.buffer(batch.vertex_offsets),
                             app.buffer(batch.constraints), app.buffer(batch.constraint_offsets)};
  const Options options = splitting_on_any_grid();
  const BatchResult result = triangulate(pool, app.queue, given, options);
  const Singles singles(problems, options);
  singles.check(result);
  std::vector<Constraint> expected;
  for (const Triangulation& mesh : singles.meshes)
    expected.insert(expected.end(), mesh.added_crossing.begin(), mesh.added_crossing.end());
  const cl::Buffer to = app.buffer(8 * expected.size());
  copy(result, GCDT_ADDED_CROSSINGS, app.queue, to, expected.size());
  CHECK(app.read<Constraint>(to, expected.size()) == expected);
}

TEST_CASE("a run of a problem that is split can be stopped, and the pool works on") {
  Pool pool(test_device());
  const std::vector<Workload> problems = {work_of(graphs::lattice(300, 5))};
  Options options = graphs::splitting();
  options.progress = [](const char*, double) { return false; };  // a fast device may be done at the second call
  try {
    pool.triangulate(batch_of(problems), options);
    FAIL("not stopped");
  } catch (const Error& error) {
    CHECK(error.status() == Status::cancelled);
  }
  options.progress = {};
  Singles(problems, options).check(pool.triangulate(batch_of(problems), options));
}

TEST_CASE(
    "what a problem needs to be split, and the device has not, is its own error, whatever larger ones are there") {
  const std::vector<Workload> problems = {uniform(500), problem({{0, 0}, {4, 4}, {0, 4}, {4, 0}}, {{0, 1}, {2, 3}}),
                                          uniform(6)};
  runtime::CallHook hook;
  hook.before = [](const char*, const char* detail) {
    return std::string(detail) == "split_join" ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS;
  };
  DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
  const PoolResult result = pool.triangulate(RaggedBatch(problems).view(), splitting_on_any_grid());
  REQUIRE(result.errors.size() == 1);
  REQUIRE(result.errors.count(1) == 1);
  CHECK(result.errors.at(1).status() == Status::out_of_memory);
  CHECK(!pool.report(0).lost);
  CHECK(pool.report(0).problems == 2);
}

TEST_CASE("a device that fails at its k-th OpenCL call while it splits changes no byte") {
  const std::vector<Workload> problems = {problem({{0, 0}, {4, 4}, {0, 4}, {4, 0}}, {{0, 1}, {2, 3}}), uniform(6),
                                          problem({{0, 0}, {9, 1}, {0, 1}, {9, 0}, {3, 3}}, {{0, 1}, {2, 3}, {0, 4}})};
  const Singles singles(problems, splitting_on_any_grid());
  REQUIRE(singles.meshes[0].statistics.vertices_added + singles.meshes[2].statistics.vertices_added == 3);
  check_failing_calls(problems, splitting_on_any_grid(), 40,
                      {CL_OUT_OF_HOST_MEMORY, CL_INVALID_COMMAND_QUEUE, CL_INVALID_COMMAND_QUEUE}, 2);
}
