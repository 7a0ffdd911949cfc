// SPDX-License-Identifier: Apache-2.0
// Few vertices on CPUs, whose phases are launched one behind the other (solve/at_once.hpp): the same bytes and errors
// as phase by phase, no wait in between, and nothing done on what turns out not to be there.
#include <doctest/doctest.h>

#include <chrono>
#include <cstring>
#include <limits>

#include "answer.hpp"
#include "batch_cases.hpp"
#include "faulty_device.hpp"
#include "forest_fixture.hpp"
#include "phases/check.hpp"
#include "phases/grow.hpp"
#include "phases/order.hpp"
#include "phases/output.hpp"
#include "solver_fixture.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

Solver& at_once() {
  static Solver instance = tuned_solver(DeviceKind::threads, {});
  return instance;
}
/// With a trace, each phase ends with a wait.
Solver& in_steps() {
  static Solver instance = tuned_solver(DeviceKind::threads, {}, [](const TraceSpan&) {});
  return instance;
}

void check_same(const std::vector<Point>& points, const Options& options = {}) {
  const Answer once = ask(at_once(), {points, {}}, options), steps = ask(in_steps(), {points, {}}, options);
  CHECK(once.error == steps.error);
  CHECK(once.indices == steps.indices);
  if (!once.error.empty() || !steps.error.empty()) return;
  CHECK(difference(once.mesh, steps.mesh) == "");
  const Statistics &a = once.mesh.statistics, &b = steps.mesh.statistics;
  CHECK(a.vertices_merged == b.vertices_merged);
  CHECK(a.notes == b.notes);
  if (points.size() > Tuning::most_grown_by_one) return;  // threads decide by the way who of them does what
  CHECK(a.flips == b.flips);
  CHECK(a.location_steps == b.location_steps);
  CHECK(a.cases.edge_splits == b.cases.edge_splits);
  CHECK(a.rounds.insert == b.rounds.insert);
  if (a.vertices_merged == 0 && a.triangles > 0) CHECK(a.launches == b.launches);
}

/// The OpenCL calls of a call, but those that only prepare others.
std::string queued(const Workload& work) {
  std::string calls, last;
  bool wanted = false;
  runtime::CallHook hook;
  hook.before = [&](const char* call, const char* detail) {
    const std::string name = call;
    const bool waits = name == "clEnqueueReadBuffer" || name == "clFinish" || name == "clWaitForEvents";
    if (!wanted || !(waits || name == "clEnqueueNDRangeKernel")) return CL_SUCCESS;
    const std::string next = waits ? "wait" : detail;
    if (next != last) calls += next + " ";
    last = next;
    return CL_SUCCESS;
  };
  Solver solver = hooked_solver(hook);
  solver.triangulate(work.points, work.constraints);
  wanted = true;
  solver.triangulate(work.points, work.constraints);
  return calls;
}

/// A launched order on threads, and what is launched behind it.
struct Launched {
  std::unique_ptr<runtime::Runtime> on = fixture::threads_runtime(runtime::Meshes::one);
  runtime::Runtime& runtime = *on;
  Primitives primitives{runtime};
  PhaseCounters counters{runtime};
  Plan plan;
  LaunchedOrder order;
  Mesh mesh;
  WorkLists lists;
  Pieces pieces;

  explicit Launched(const std::vector<Point>& points) {
    const auto n = static_cast<cl_uint>(points.size());
    plan = make_plan(runtime, {1, n, n});
    dirty_memory(device::make_levels(n, plan.coarsest_level));
    order = launch_order(runtime, plan, stage(runtime, points), {});
    mesh = make_mesh(runtime, n);
    lists = make_work_lists(runtime, n);
    pieces.ends = runtime.allocate<cl_uint2>("pieces", 0);
    pieces.source_offsets = runtime.allocate<cl_uint>("source offsets", 1);
    set_counters({});
  }
  /// What is free for levels then holds these.
  void dirty_memory(const device::Levels& levels) {
    std::vector<runtime::Buffer<device::Levels>> used;
    for (int i = 0; i < 32; ++i) used.push_back(runtime.upload_one("levels", levels));
    runtime.finish();
  }
  void set_counters(const device::Counters& to) { runtime.write(counters.buffer(), &to, 1); }
  void grow() { launch_grow(runtime, plan, order.vertices, mesh, lists, counters); }
  LaunchedMesh output() { return launch_output(runtime, primitives, mesh, order.vertices, &counters); }
  std::uint32_t triangles() { return runtime.read_one(output().triangles); }
  template <class T>
  std::vector<T> read(const runtime::Buffer<T>& from) {
    std::vector<T> all(from.size());
    runtime.read(from, all.data(), all.size());
    return all;
  }
};

const std::vector<Point> square = {{0, 0}, {5, 0}, {5, 5}, {0, 5}, {2, 1}, {3, 4}};

}  // namespace

TEST_CASE("the same as phase by phase: shapes up to the limit and beyond it, with vertices that coincide or not") {
  const auto few = static_cast<std::size_t>(Tuning().one_item_vertices);
  for (const char* name : {"uniform", "parabola", "row", "grid", "near_circle", "letters", "hub"})
    for (const std::size_t n : {std::size_t{10}, std::size_t{1000}, few, few + 1, 2 * few, 2 * few + 1}) {
      CAPTURE(name);
      CAPTURE(n);
      std::vector<Point> points = workload(name, n).points;
      check_same(points);
      points.push_back(points[points.size() / 2]);
      check_same(points);
      Options distinct;
      distinct.distinct = true;
      check_same(points, distinct);
    }
}

// Keys agree in as many first bits as a sort by one work-item looks at before all others (sort_by_prefix): in runs that
// it sorts by insertion, and in longer ones, of distinct keys and of equal ones, whose order is that of the input.
TEST_CASE("vertices in clusters are put in the same order by one work-item as by many") {
  runtime::CallHook hook;
  hook.tuning = shared_out();
  Solver many = hooked_solver(hook);
  Random random(3);
  for (const std::uint32_t n : {1000u, 5000u, 12000u})
    for (const std::uint32_t each : {3u, 63u, 64u, 65u, 700u, 12000u}) {
      CAPTURE(n);
      CAPTURE(each);
      std::vector<Point> points = {{0, 0}, {1, 1}};
      while (points.size() < n) {
        const Point middle = {random.unit(), random.unit()};
        for (std::uint32_t i = 0; i < each && points.size() < n; ++i) {
          const double size = i % 3 == 0 ? 0 : std::ldexp(1.0, -13);  // a third of a cluster is one point
          points.push_back({middle[0] + size * random.unit(), middle[1] + size * random.unit()});
        }
      }
      const Answer by_one = ask(at_once(), {points, {}}), by_many = ask(many, {points, {}});
      CHECK(by_one.error == "");
      CHECK(difference(by_one.mesh, by_many.mesh) == "");
    }
}

TEST_CASE("the same of hardly any vertices, of a line, of what is asked for besides, and of what is refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<Point>& points : std::vector<std::vector<Point>>{{},
                                                                          {{1, 2}},
                                                                          {{1, 2}, {1, 2}},
                                                                          {{1, 2}, {3, 4}},
                                                                          {{0, 0}, {4, 0}, {0, 4}},
                                                                          {{0, 0}, {1, 1}, {2, 2}, {7, 7}},
                                                                          {{0, 0}, {1, 1}, {2, 2}, {2, 2}},
                                                                          square,
                                                                          {{0, 0}, {4, 0}, {0, 4}, {1, nan}}}) {
    CAPTURE(points.size());
    check_same(points);
    Options options;
    options.canonical = false;
    check_same(points, options);
    options = {};
    options.check = false;
    check_same(points, options);
    options = {};
    options.regions = true;
    check_same(points, options);
    options = {};
    options.grid = FixedGrid{0, 0, "1"};
    check_same(points, options);
    options.grid = FixedGrid{3, 3, "1"};
    check_same(points, options);
  }
}

TEST_CASE("the host waits once, for what it has to know and for the result together") {
  Workload work;
  work.points = workload("uniform", 1000).points;
  CHECK(at_once().triangulate(work.points).statistics.read_backs == 1);
  CHECK(at_once().triangulate(work.points, Constraints({{0, 1}, {1, 2}})).statistics.read_backs == 4);
  CHECK(queued(work) == "order_by_one_item grow_insert output_by_one_item check_by_one_item number_by_one_item wait ");
  work.constraints = {{0, 1}, {1, 2}};
  CHECK(
      queued(work) ==
      "order_by_one_item grow_insert wait enforce_problems wait scan_serial enforce_pieces mark_first scan_serial wait "
      "compact_indices enforce_ends output_by_one_item check_by_one_item number_by_one_item wait ");
}

TEST_CASE("phases launched at once are timed all the same") {
  for (const std::vector<Constraint>& constraints : {std::vector<Constraint>{}, {{0, 1}, {1, 2}}}) {
    const auto begin = std::chrono::steady_clock::now();
    const Statistics s = at_once().triangulate(workload("uniform", 2000).points, constraints).statistics;
    const double call = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    for (const double ms : {s.ms.order, s.ms.insert, s.ms.gather, s.ms.check, s.ms.output}) CHECK(ms > 0);
    CHECK(s.ms.gather < s.ms.output);
    CHECK(s.ms.core < s.ms.full);
    CHECK(s.ms.full < call);
  }
}

TEST_CASE("behind an order of points that are not distinct, or not numbers, nothing is done") {
  std::vector<Point> twice = square, none = square;
  twice.push_back(square[3]);
  none.push_back({1, std::numeric_limits<double>::infinity()});
  for (const std::vector<Point>& points : {twice, none}) {
    Launched behind(points);
    device::Counters before = {};
    before.edge_splits = 77;
    behind.set_counters(before);
    const std::vector<cl_uint4> faces(2 * std::size_t{behind.mesh.faces()}, cl_uint4{{7, 7, 7, 7}});
    behind.runtime.write(behind.mesh.face_data, faces.data(), faces.size());
    behind.grow();
    CHECK(behind.counters.read().edge_splits == 77);
    const std::vector<cl_uint4> after = behind.read(behind.mesh.face_data);
    CHECK(std::memcmp(after.data(), faces.data(), faces.size() * sizeof faces[0]) == 0);
    behind.set_counters({});
    CHECK(behind.triangles() == 0);
  }
}

TEST_CASE("behind a growth that left a vertex or an edge there are no triangles") {
  Launched behind(square);
  behind.grow();
  const device::Counters grown = behind.counters.read();
  CHECK(behind.triangles() == 6);  // 2 * 6 - 2 - 4
  device::Counters left = grown;
  left.list_insert[0] = 1;
  behind.set_counters(left);
  CHECK(behind.triangles() == 0);
  left = grown;
  left.list_test[0] = 1;
  behind.set_counters(left);
  CHECK(behind.triangles() == 0);
}

TEST_CASE("numbers wait for the check: of a mesh with a fault corners stay vertices") {
  Launched behind(square);
  behind.grow();
  const LaunchedMesh mesh = behind.output();
  const std::uint32_t count = behind.runtime.read_one(mesh.triangles);
  std::vector<cl_uint> corners = behind.read(mesh.mesh.corners);
  corners.resize(3 * std::size_t{count});
  const std::vector<cl_uint> inputs = behind.read(behind.order.vertices.vertex_input);
  std::swap(corners[0], corners[1]);
  behind.runtime.write(mesh.mesh.corners, corners.data(), corners.size());
  auto numbers = [&] {
    const auto report = launch_check(behind.runtime, behind.plan, mesh, behind.order.vertices, behind.pieces);
    const auto representatives = launch_numbers(behind.runtime, behind.order.vertices, mesh, behind.pieces, report);
    const bool passed = gcdt_check_passed(behind.runtime.read_one(report), 6, 0);
    std::vector<cl_uint> now = behind.read(mesh.mesh.corners);
    now.resize(corners.size());
    return std::make_pair(passed, now);
  };
  CHECK(numbers() == std::make_pair(false, corners));
  std::swap(corners[0], corners[1]);
  behind.runtime.write(mesh.mesh.corners, corners.data(), corners.size());
  for (cl_uint& v : corners) v = inputs[v];
  CHECK(numbers() == std::make_pair(true, corners));
}

TEST_CASE("arrays that the result has come with need no read, others one together; both are the same") {
  const Workload work = random_pslg(600, 1 << 20, 40, 5);
  Options options;
  options.crossing = Crossing::drop;
  const Result once = at_once().solve(work.points, work.constraints, options),
               steps = in_steps().solve(work.points, work.constraints, options);
  const auto reads = [](const Result& result) {
    const std::uint64_t before = result.statistics().read_backs;
    const Triangulation all = result.download();
    CHECK(all.triangles == result.triangles());
    return all.statistics.read_backs - before;
  };
  CHECK(reads(once) == 0);
  CHECK(reads(steps) == 1);
  CHECK(difference(once.download(), steps.download()) == "");
}

TEST_CASE("edges that growth leaves are flipped, and output is launched again") {
  const std::vector<Point> points = workload("uniform", 500).points;
  const TextEdit leave = {"  if (grown.on_edges > 0u) atomic_add(&counters->edge_splits, grown.on_edges);",
                          "  if (begin == 0u) queue[0] = 0u, counters->list_test[0] = 1u;"};
  Solver leaving = hooked_solver(editing({leave}));
  const Answer left = ask(leaving, {points, {}}), usual = ask(at_once(), {points, {}});
  CHECK(*leave.matched > 0);
  CHECK(left.error == "");
  CHECK(difference(left.mesh, usual.mesh) == "");
  CHECK(left.mesh.statistics.launches > usual.mesh.statistics.launches + 3);
}

TEST_CASE("a check has passed if nothing is noted and every number fits") {
  device::CheckReport right = {};
  std::fill(std::begin(right.first), std::end(right.first), GCDT_NONE);
  right.hull_vertices = 4, right.least_corners = 1, right.constrained_edges = 3, right.triangles = 6;
  CHECK(gcdt_check_passed(right, 6, 3));
  CHECK(!gcdt_check_passed(right, 7, 3));
  CHECK(!gcdt_check_passed(right, 6, 4));
  for (const auto number : {&device::CheckReport::hull_vertices, &device::CheckReport::least_corners,
                            &device::CheckReport::constrained_edges, &device::CheckReport::triangles})
    for (const cl_uint wrong : {right.*number + 1, right.*number - 1}) {
      device::CheckReport other = right;
      other.*number = wrong;
      CHECK(!gcdt_check_passed(other, 6, 3));
    }
  for (cl_uint& first : right.first) {
    first = 0;
    CHECK(!gcdt_check_passed(right, 6, 3));
    first = GCDT_NONE;
  }
  // None at all, with as many on the hull as would fit: whether that is right, another kernel finds out.
  right.triangles = 0, right.hull_vertices = 10, right.constrained_edges = 0;
  CHECK(!gcdt_check_passed(right, 6, 0));
}

TEST_CASE("a fault is told as phase by phase") {
  const std::vector<Point> points = workload("uniform", 500).points;
  const TextEdit left = {"t = split_at(mesh, o, v, t, zero);",
                         "t = split_at(mesh, o, v, t, zero); if (v > 400u) return t;"};
  runtime::CallHook hook = editing({left});
  Solver once = hooked_solver(hook);
  hook.tuning = shared_out();
  Solver steps = hooked_solver(hook);
  const Answer a = ask(once, {points, {}}), b = ask(steps, {points, {}});
  CHECK(*left.matched > 0);
  CHECK(a.error.find("check: ") == 0);
  CHECK(!a.indices.empty());
  CHECK(a.error == b.error);
  CHECK(a.indices == b.indices);
}
