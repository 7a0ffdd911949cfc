// SPDX-License-Identifier: Apache-2.0
// Whole calls on devices that are treated as GPUs (batches: gpu_pool_test.cpp): the bytes are those of a CPU's ways,
// with thresholds so low that small inputs take every way that large ones take.
#include <doctest/doctest.h>

#include <map>

#include "kinds.hpp"
#include "pool_cases.hpp"
#include "query/imported.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

// Before any test lists devices.
const std::vector<cl::Device> all_of_them = every_device();

/// A solver on PoCL, or on llvmpipe, that treats it as a GPU, or as what is given.
Solver as_gpu(DeviceKind really, Tuning tuning = {}, Trace trace = {}) {
  tuning.kind = tuning.kind.value_or(DeviceKind::gpu);
  tuning.states_one_group = tuning.kind == DeviceKind::gpu && really == DeviceKind::threads;  // as on NVIDIA's
  return tuned_solver(really, tuning, std::move(trace));
}

// All that a call can be asked for, with problems that take it to every phase.
std::vector<std::pair<Workload, Options>> calls() {
  std::vector<std::pair<Workload, Options>> all;
  for (const char* name : {"uniform", "grid", "clusters", "hub", "letters", "spiral", "near_circle"})
    all.push_back({workload(name, 1000), {}});
  all.push_back({workload("uniform", 10000), {}});  // sorted by buckets
  Workload decimals = random_pslg(200, 1000, 60, 2);
  for (Point& p : decimals.points) p = {p[0] / 100, p[1] / 100};
  all.push_back({decimals, {}});
  Options domain;
  domain.regions = true;
  for (const Domain d : {Domain::even_odd, Domain::nonzero, Domain::outer}) {
    domain.domain = d;
    all.push_back({workload("random_pslg", 60), domain});
    all.push_back({workload("nested_squares", 400), domain});
  }
  Options drop, split;
  drop.crossing = Crossing::drop, split.crossing = Crossing::split;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    all.push_back({random_crossing(120, 1000, 40, seed), drop});
    all.push_back({random_crossing(120, 1000, 40, seed), split});
  }
  return all;
}

}  // namespace

TEST_CASE("calls on a device treated as a GPU give a CPU's bytes, with usual thresholds and with small ones") {
  Solver usual_gpu = as_gpu(DeviceKind::threads), small_gpu = as_gpu(DeviceKind::threads, small_thresholds());
  for (const auto& [problem, options] : calls()) {
    CAPTURE(problem.points.size());
    const Triangulation expected = solver().triangulate(problem.points, problem.constraints, options);
    for (Solver* gpu : {&usual_gpu, &small_gpu})
      CHECK(difference(gpu->triangulate(problem.points, problem.constraints, options), expected) == "");
  }
}

TEST_CASE("what is asked of a result, and a mesh that is adopted, are the same on a device treated as a GPU") {
  Solver usual_gpu = as_gpu(DeviceKind::threads), small_gpu = as_gpu(DeviceKind::threads, small_thresholds());
  const Workload problem = random_pslg(300, 1000, 60, 3);
  std::vector<Point> queries;
  for (int x = -1; x <= 40; ++x)
    for (int y = -1; y <= 40; ++y) queries.push_back({25.0 * x, 25.0 * y});
  const auto same = [&](const Result& found, const Result& expected) {
    CHECK(difference(found.download(), expected.download()) == "");
    CHECK(found.vertex_triangles() == expected.vertex_triangles());
    CHECK(found.hull() == expected.hull());
    CHECK(found.edge_pieces() == expected.edge_pieces());
    std::vector<std::array<double, 3>> weights, expected_weights;
    CHECK(found.locate(queries, &weights) == expected.locate(queries, &expected_weights));
    CHECK(weights == expected_weights);
    const Quality quality = found.quality(), expected_quality = expected.quality();
    CHECK(quality.least_angle == expected_quality.least_angle);
    CHECK(quality.least_angle_triangle == expected_quality.least_angle_triangle);
    CHECK(quality.largest_angle_triangle == expected_quality.largest_angle_triangle);
    CHECK(quality.triangles == expected_quality.triangles);
    CHECK(quality.doubled == expected_quality.doubled);
  };
  Options domain;
  domain.domain = Domain::outer;
  domain.hole_seeds = {{500.5, 500.5}};
  const Result hull = solver().solve(problem.points, problem.constraints);
  const Result of_domain = solver().solve(problem.points, problem.constraints, domain);
  const auto triangles = hull.triangles();
  const Result adopted = solver().adopt(problem.points, triangles, problem.constraints);
  for (Solver* gpu : {&usual_gpu, &small_gpu}) {
    same(gpu->solve(problem.points, problem.constraints), hull);
    same(gpu->solve(problem.points, problem.constraints, domain), of_domain);
    same(gpu->adopt(problem.points, triangles, problem.constraints), adopted);
  }
}

TEST_CASE("a device treated as a GPU sorts thousands of vertices that are close together") {
  Tuning tuning;
  tuning.most_merged = 1u << 12;  // more are sorted by their first digits, in which these agree
  Workload problem = random_pslg(17000, 1 << 30, 0, 4);
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y) problem.points.push_back({double(x), double(y)});
  Solver gpu = as_gpu(DeviceKind::threads, tuning);
  CHECK(difference(gpu.triangulate(problem.points), solver().triangulate(problem.points)) == "");
}

TEST_CASE("a device treated as neither CPU nor GPU gives a CPU's bytes") {
  Tuning tuning;
  tuning.kind = DeviceKind::accelerator;
  const Workload problem = workload("uniform", 3000);
  CHECK(difference(as_gpu(DeviceKind::threads, tuning).triangulate(problem.points),
                   solver().triangulate(problem.points)) == "");
}

TEST_CASE("a device treated as a GPU gives the same triangles in any order, and finds a fault in a mesh from outside") {
  Solver gpu = as_gpu(DeviceKind::threads);
  const Workload problem = random_pslg(300, 1000, 60, 3);
  const Triangulation expected = solver().triangulate(problem.points, problem.constraints);
  Options any_order;
  any_order.canonical = false;
  auto triangles = gpu.triangulate(problem.points, problem.constraints, any_order).triangles;
  const auto sorted = [](Array<std::array<std::uint32_t, 3>> all) {
    for (auto& t : all) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(all.begin(), all.end());
    return all;
  };
  CHECK(sorted(triangles) == sorted(expected.triangles));
  Triangulation wrong = expected;
  std::swap(wrong.neighbours[0], wrong.neighbours[1]);
  api::State& state = *gpu.handle()->state;
  const auto check = [&](const Triangulation& mesh) {
    check_imported(state.runtime, state.primitives, problem.points, mesh.pieces, view(mesh), {});
  };
  check(expected);
  CHECK_THROWS_AS(check(wrong), Error);
}

TEST_CASE("a problem too large for a work-group beside small ones, on a device treated as a GPU") {
  runtime::CallHook hook;
  hook.tuning.kind = DeviceKind::gpu;
  runtime::Runtime runtime(app_device(), hook);
  Primitives primitives(runtime);
  Staging staging(runtime);
  const std::vector<Workload> problems = {workload("uniform", 60), workload("letters", 3000), workload("grid", 64)};
  const ForestResult forest =
      triangulate_forest(runtime, primitives, RaggedBatch(problems).view(), {0, 1, 2}, {}, staging);
  for (std::size_t p = 0; p < problems.size(); ++p)
    CHECK(difference(part_of(forest, p), solver().triangulate(problems[p].points, problems[p].constraints)) == "");
}

TEST_CASE("llvmpipe treated as a GPU gives PoCL's bytes, by sweeps of a mesh that is large enough for them") {
  const Workload problem = workload("uniform", 45000);
  REQUIRE(3 * problem.points.size() > Tuning().least_sweep);
  for (const std::uint32_t most_merged : {Tuning().most_merged, 1u << 15}) {  // vertices sorted by blocks, by digits
    Tuning tuning;
    tuning.most_merged = most_merged;
    CHECK(difference(as_gpu(DeviceKind::lanes, tuning).triangulate(problem.points),
                     solver().triangulate(problem.points)) == "");
  }
}

TEST_CASE("a device treated as a GPU cleans constraints along the curve where they cross much, and only there") {
  std::map<std::string, int> launches;
  Solver gpu = as_gpu(DeviceKind::threads, {}, [&](const TraceSpan& span) {
    if (span.on_device) ++launches[span.name];
  });
  Workload across = uniform(4000, 5), along;  // 60 lines over all of it, side by side; as many short ones
  along.points = across.points;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const double y = (i + 1) / 64.0;
    across.points.push_back({-0.5, y}), across.points.push_back({1.5, y});
    along.points.push_back({-0.5, y}), along.points.push_back({-0.5, y + 1.0 / 128});
    const auto first = static_cast<std::uint32_t>(across.points.size() - 2);
    // Neighbours on the curve do not stand side by side, so that their order changes.
    across.constraints.push_back({first + (i % 2), first + 1 - (i % 2)}),
        along.constraints.push_back({first, first + 1});
  }
  std::swap(across.constraints[3], across.constraints[50]);
  for (const Workload* problem : {&across, &along}) {
    launches.clear();
    CHECK(difference(gpu.triangulate(problem->points, problem->constraints),
                     solver().triangulate(problem->points, problem->constraints)) == "");
    CHECK(launches["clean_walk"] > 0);
    CHECK(launches["clean_to_cells"] == (problem == &across ? 1 : 0));
  }
}

// Flips and steps: as in statistics_test.cpp, by levels.
TEST_CASE(
    "rounds are counted as they are launched, where none is inside a work-group; flips and steps as theory expects") {
  std::map<std::string, std::uint64_t> launches;
  Tuning wide;
  wide.one_group_vertices = wide.one_group_edges = 0;
  wide.least_sweep = 3000;
  Solver gpu = as_gpu(DeviceKind::threads, wide, [&](const TraceSpan& span) {
    if (span.on_device) ++launches[span.name];
  });
  const std::uint64_t n = 10000;
  const Workload problem = uniform(n);
  const Statistics s = gpu.solve(problem.points).statistics();
  CHECK(launches["flip_sweep"] > 0);
  CHECK(launches["flip_test"] > 0);
  CHECK(s.rounds.flip == launches["flip_sweep"] + launches["flip_test"]);
  CHECK(s.rounds.insert == launches["insert_split"]);
  CHECK(s.flips > 1.3 * n);
  CHECK(s.flips < 3.6 * n);
  CHECK(s.location_steps > n);
  CHECK(s.location_steps < 6 * n);
  // A round makes a vertex's path at most one longer; some vertex of the last level waits for another.
  CHECK(s.history_depth > 0);
  CHECK(s.history_depth <= s.rounds.insert);
}
