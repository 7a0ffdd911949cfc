// SPDX-License-Identifier: Apache-2.0
// Refinement through the interface: what is refused and by which name, the arrays and values of added vertices, the
// statistics. What a refined mesh is, refine_test knows.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include <gcdt/gcdt_pool.hpp>

#include "refine_options.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Doubles = std::vector<std::array<double, 2>>;

// A square, halved by a constraint from (3, 0) to (3, 8); its border is constraints, too.
const Doubles halves = {{0, 0}, {3, 0}, {8, 0}, {8, 8}, {3, 8}, {0, 8}};
const std::vector<Constraint> walls = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}, {4, 1}};

std::array<double, 2> place(const Doubles& points, const Triangulation& mesh, std::uint32_t v) {
  return v < points.size() ? points[v] : mesh.added[v - points.size()];
}

double doubled_area(const Doubles& points, const Triangulation& mesh, std::size_t t) {
  const auto& c = mesh.triangles[t];
  const auto p = place(points, mesh, c[0]), q = place(points, mesh, c[1]), r = place(points, mesh, c[2]);
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/// What the call says that is refused.
std::string refused(const Options& options, Constraints constraints = walls) {
  try {
    solver().solve(halves, constraints, options);
  } catch (const Error& error) {
    return error.status() == Status::invalid_argument ? error.what() : "another status";
  }
  return "nothing";
}

bool names(const std::string& what, const std::string& member) { return what.find(member) != std::string::npos; }

}  // namespace

TEST_CASE("every bad value is refused by the name of its member") {
  const double bad_numbers[] = {-1, std::nan(""), -HUGE_VAL};
  for (const double bad : bad_numbers) {
    Options options = refining();
    options.refine->least_angle = bad;
    CHECK(names(refused(options), "refine.least_angle must be"));
    options = refining();
    options.refine->most_area = bad;
    CHECK(names(refused(options), "refine.most_area must be above 0"));
    options = refining();
    options.refine->least_length = bad;
    CHECK(names(refused(options), "refine.least_length must be"));
    options = refining();
    const std::vector<double> sizes = {1, 1, bad, 1, 1, 1};
    options.refine->sizes = sizes;
    CHECK(names(refused(options), "refine.sizes[2] must be above 0"));
    options = refining();
    const std::vector<double> areas = {1, bad};
    options.region_seeds = {{1, 1}, {7, 7}};
    options.refine->region_areas = areas;
    CHECK(names(refused(options), "refine.region_areas[1] must be above 0"));
  }
  for (const double angle : {0.5, 34.5, 60.0}) CHECK(names(refused(refining(angle)), "from 1 to 34 degrees, not "));
  Options options = refining();
  options.refine->most_area = 0;
  CHECK(names(refused(options), "refine.most_area must be above 0, not 0"));
  options = refining();
  const std::vector<double> two = {1, 2}, six(6, 1.0);
  options.refine->sizes = two;
  CHECK(names(refused(options), "refine.sizes has 2 lengths for 6 vertices"));
  options.refine->sizes = six;
  options.crossing = Crossing::split;
  CHECK(names(refused(options), "refine.sizes do not go with crossings that are split"));
  options = refining();
  options.refine->region_areas = two;
  CHECK(names(refused(options), "refine.region_areas has 2 areas for 0 region seeds"));
  options = refining();
  options.refine->splits = static_cast<Splits>(3);
  CHECK(names(refused(options), "gcdt_refinement.splits"));
  options.refine->splits = static_cast<Splits>(-1);
  CHECK(names(refused(options), "gcdt_refinement.splits"));
}

TEST_CASE("the C structure: its size, null pointers, and options of before") {
  const gcdt_input input = detail::input(halves, walls);
  gcdt_refinement refine = GCDT_REFINEMENT_INIT;
  gcdt_options options = GCDT_OPTIONS_INIT;
  options.refine = &refine;
  gcdt_result* result = nullptr;
  const auto call = [&] { return gcdt_triangulate(solver().handle(), &input, &options, &result); };
  const auto message = [] {
    gcdt_error error = GCDT_ERROR_INIT;
    gcdt_last_error(nullptr, &error);
    return std::string(error.message);
  };
  refine.struct_size = 8;
  CHECK(call() == GCDT_ERROR_STRUCT_SIZE);
  CHECK(names(message(), "gcdt_refinement"));
  refine.struct_size = sizeof refine;
  refine.size_count = 6;
  CHECK(call() == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(names(message(), "gcdt_refinement.sizes is null"));
  refine.size_count = 0;
  refine.region_area_count = 1;
  CHECK(call() == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(names(message(), "gcdt_refinement.region_areas is null"));
  refine.region_area_count = 0;
  REQUIRE(call() == GCDT_OK);
  CHECK(gcdt_result_count(result, GCDT_ADDED_ORIGINS) == gcdt_result_count(result, GCDT_ADDED));
  gcdt_result_release(result);
  options.struct_size = offsetof(gcdt_options, refine);  // of a version that had no refinement
  refine.least_angle = 99;
  REQUIRE(call() == GCDT_OK);
  CHECK(gcdt_result_count(result, GCDT_ADDED) == 0);
  gcdt_result_release(result);
}

TEST_CASE("what cannot be refined says so") {
  const Options options = refining();
  CHECK_THROWS_WITH_AS(solver().adopt(halves, std::vector<std::array<std::uint32_t, 3>>{{0, 1, 5}}, {}, options),
                       doctest::Contains("gcdt_options.refine must be null"), Error);
  Pool pool(test_device());
  Batch batch;
  batch.add(halves, walls);
  Options in_tiles = options;
  in_tiles.tiles = 2;
  CHECK_THROWS_WITH_AS(pool.triangulate(batch, in_tiles), doctest::Contains("a problem in tiles is not refined"),
                       Error);
}

TEST_CASE("added vertices: what they stand on, and values there") {
  Options options = refining(30);
  options.refine->most_area = 0.5;
  const Triangulation mesh = solver().triangulate(halves, walls, options);
  const Statistics& s = mesh.statistics;
  REQUIRE(mesh.added.size() == s.vertices_added);
  REQUIRE(s.refine.added == mesh.added.size());
  REQUIRE(mesh.added_origin.size() == mesh.added.size());
  REQUIRE(mesh.added_crossing.size() == mesh.added.size());
  CHECK(mesh.representative.size() == halves.size() + mesh.added.size());
  CHECK(s.refine.bent == 0);  // the grid has room
  CHECK(s.refine.move == 0);
  CHECK(s.refine.complete);
  CHECK(s.ms.refine > 0);
  const auto& ms = s.ms;
  CHECK(ms.full ==
        doctest::Approx(ms.order + ms.insert + ms.constrain + ms.flip + ms.check + ms.output + ms.domain + ms.refine));
  std::uint64_t on_constraints = 0;
  for (std::size_t i = 0; i < mesh.added.size(); ++i) {
    CHECK(mesh.added_crossing[i] == Constraint{UINT32_MAX, UINT32_MAX});
    if (i > 0) CHECK(mesh.added_on_grid[i - 1] < mesh.added_on_grid[i]);
    const auto& [x, y] = mesh.added[i];
    const std::uint32_t constraint = mesh.added_origin[i][3];
    if (constraint == UINT32_MAX) continue;
    ++on_constraints;
    REQUIRE(constraint < walls.size());
    const auto &a = halves[walls[constraint][0]], &b = halves[walls[constraint][1]];
    CHECK((b[0] - a[0]) * (y - a[1]) == (b[1] - a[1]) * (x - a[0]));
    CHECK(mesh.added_origin[i][2] == UINT32_MAX);
  }
  CHECK(on_constraints == s.refine.on_subsegments);
  CHECK(on_constraints > 10);
  std::vector<double> heights;
  const auto height = [](double x, double y) { return 3 * x - 2 * y + 1; };
  for (const auto& [x, y] : halves) heights.push_back(height(x, y));
  const auto values = added_values(halves, walls, mesh.added, mesh.added_crossing, mesh.added_origin, heights);
  for (std::size_t i = 0; i < values.size(); ++i)
    CHECK(values[i] == doctest::Approx(height(mesh.added[i][0], mesh.added[i][1])));
}

TEST_CASE("values at vertices that stand on crossings, and origins that are none") {
  const std::vector<Constraint> crossing = {{0, 3}, {2, 5}};
  Options options = refining();
  options.crossing = Crossing::split;
  options.refine->most_area = 2;
  const Triangulation mesh = solver().triangulate(halves, crossing, options);
  REQUIRE(mesh.statistics.refine.added + 1 == mesh.added.size());
  CHECK(mesh.added_crossing[0] == Constraint{0, 1});
  CHECK(mesh.added_origin[0] == std::array<std::uint32_t, 4>{UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX});
  std::vector<double> ones(halves.size(), 1.0);
  auto origins = mesh.added_origin;
  const auto values = [&] { return added_values(halves, crossing, mesh.added, mesh.added_crossing, origins, ones); };
  for (const double value : values()) CHECK(value == doctest::Approx(1));
  origins[1] = {0, std::uint32_t(halves.size() + mesh.added.size()), UINT32_MAX, UINT32_MAX};
  CHECK_THROWS_WITH_AS(values(), "added vertex 1 stands on a vertex that does not exist", Error);
  const auto second = std::uint32_t(halves.size() + 1), third = second + 1;
  origins[1] = {0, third, UINT32_MAX, UINT32_MAX};
  origins[2] = {second, 0, UINT32_MAX, UINT32_MAX};
  CHECK_THROWS_WITH_AS(values(), doctest::Contains("stands on one that stands on it"), Error);
  auto pairs = mesh.added_crossing;
  pairs[0] = {0, 7};
  CHECK_THROWS_WITH_AS(added_values(halves, crossing, mesh.added, pairs, mesh.added_origin, ones),
                       "added vertex 0: there is no constraint 7", Error);
}

TEST_CASE("regions have areas of their own") {
  Options options = refining();
  options.region_seeds = {{1, 1}, {7, 7}};
  const std::vector<double> areas = {0.25, HUGE_VAL};
  options.refine->region_areas = areas;
  options.refine->most_area = 4;
  const Triangulation mesh = solver().triangulate(halves, walls, options);
  REQUIRE(mesh.region_seed.size() == mesh.triangles.size());
  double largest[2] = {0, 0};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    REQUIRE(mesh.region_seed[t] >= 0);
    double& most = largest[mesh.region_seed[t]];
    most = std::max(most, doubled_area(halves, mesh, t) / 2);
  }
  CHECK(largest[0] <= 0.25);
  CHECK(largest[1] <= 4);
  CHECK(largest[1] > 0.5);
}

TEST_CASE("without an angle only areas count, and it ends") {
  for (std::size_t n = 5; n < 60; n += 9) {
    const Workload work = random_pslg(n, 1000, n, n);
    Options plain = refining(0);
    const Triangulation same = solver().triangulate(work.points, work.constraints, plain);
    CHECK(same.added.empty());
    CHECK(same.statistics.refine.complete);
    plain.refine->most_area = 1000;
    const Triangulation mesh = solver().triangulate(work.points, work.constraints, plain);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      CHECK(doubled_area(work.points, mesh, t) <= 2000.0 * (1 + 1e-6));
    CHECK(mesh.statistics.refine.left_grid == 0);
    CHECK(mesh.added.size() > 100);
  }
}

TEST_CASE("a limit that is reached is no error") {
  Options options = refining();
  options.refine->most_area = 0.01;
  options.refine->most_added = 100;
  const Triangulation mesh = solver().triangulate(halves, walls, options);
  CHECK(mesh.added.size() == 100);
  CHECK(!mesh.statistics.refine.complete);
  CHECK(mesh.statistics.refine.left_limit > 0);
  REQUIRE(mesh.statistics.notes.size() == 1);
  CHECK(names(mesh.statistics.notes[0], "the limit of added vertices ended the refinement"));
  options.refine->most_added = 0;
  CHECK(solver().triangulate(halves, walls, options).triangles == solver().triangulate(halves, walls).triangles);
}

TEST_CASE("a grid too coarse for what is wanted is said before the work") {
  std::string first_phase_after, said;
  bool told = false;
  Solver talking(test_device(), [&](int level, const char* message) {
    if (level == GCDT_LOG_WARNING && names(message, "too coarse")) told = true, said = message;
  });
  Options options = refining();
  options.grid = FixedGrid{0, 0, "0.125"};
  options.refine->most_area = 0.5;
  options.progress = [&](const char* phase, double) {
    if (told && first_phase_after.empty()) first_phase_after = phase;
    return true;
  };
  const Triangulation mesh = talking.triangulate(halves, walls, options);
  CHECK(names(said, "those with a side below 8 cells, 1, are left as they are"));
  CHECK(first_phase_after == "insert");
  REQUIRE(mesh.statistics.notes.size() == 1);
  CHECK(names(mesh.statistics.notes[0], "the grid is too coarse for triangles with sides of about 1.07457"));
  CHECK(mesh.statistics.refine.left_grid > 0);
  options.refine->most_area = 5;
  CHECK(talking.triangulate(halves, walls, options).statistics.notes.empty());
}

TEST_CASE("a call that is cancelled while it refines leaves the solver as it was") {
  Options options = refining();
  options.refine->most_area = 1e-3;
  bool reached = false;
  options.progress = [&](const char* phase, double) {
    reached |= std::string(phase) == "refine";
    return !reached;
  };
  CHECK_THROWS_AS(solver().solve(halves, walls, options), Error);
  CHECK(reached);
  options.progress = {};
  options.refine->most_area = 1;
  CHECK(solver().triangulate(halves, walls, options).statistics.refine.complete);
}

TEST_CASE("nothing to refine is nothing added") {
  for (const Doubles& points : {Doubles{}, Doubles{{1, 1}}, Doubles{{0, 0}, {1, 1}, {5, 5}}}) {
    const Triangulation mesh = solver().triangulate(points, {}, refining());
    CHECK(mesh.triangles.empty());
    CHECK(mesh.added.empty());
    CHECK(mesh.added_origin.empty());
    CHECK(mesh.statistics.refine.complete);
  }
}

TEST_CASE("the memory that is said for a limit of vertices is enough, and more than without one it is not") {
  CHECK(required_bytes_refined(1000, 10, UINT64_MAX) == UINT64_MAX);
  CHECK(required_bytes_refined(1000, 10, 0) >= required_bytes(1000, 10));
  for (const std::size_t n : {2000u, 20000u}) {
    const Workload work = n == 2000 ? random_pslg(n, 1 << 20, n, 1) : uniform(n);
    for (const std::uint64_t limit : {std::uint64_t{n} / 4, 4 * std::uint64_t{n}, 20 * std::uint64_t{n}}) {
      CAPTURE(n);
      CAPTURE(limit);
      Options options = refining(20);
      options.refine->most_area = std::ldexp(1.0, 2 * 20) / double(20 * n);
      if (n != 2000) options.refine->most_area = HUGE_VAL, options.refine->least_angle = 33;
      options.refine->most_added = limit;
      options.regions = true;
      solver().trim();
      const Statistics s = solver().solve(work.points, work.constraints, options).statistics();
      const std::uint64_t m = std::max(s.m, s.constraints_pieces);
      CHECK(s.peak_device_bytes <= required_bytes_refined(n, m, limit, s.crossed_pairs) - required_bytes(0, 0, 0));
    }
  }
}
