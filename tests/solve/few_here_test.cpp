// SPDX-License-Identifier: Apache-2.0
// Few vertices on devices whose memory is the host's, which the calling thread triangulates by itself
// (device/host_kernels.hpp): the same bytes and errors as by launches, nothing asked of the device, not even its
// compiler, and results that the device can read.
#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <limits>
#include <map>

#include "answer.hpp"
#include "batch_cases.hpp"
#include "cache_folder.hpp"
#include "device/host_kernels.hpp"
#include "faulty_device.hpp"
#include "mesh/primitives.hpp"
#include "solver_fixture.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

Tuning launching() {
  Tuning tuning;
  tuning.works_here = false;
  return tuning;
}

Solver& here() {
  static Solver instance = tuned_solver(DeviceKind::threads, {});
  return instance;
}
Solver& launched() {
  static Solver instance = tuned_solver(DeviceKind::threads, launching());
  return instance;
}

void check_same(const std::vector<Point>& points, const Options& options = {}) {
  const Answer a = ask(here(), {points, {}}, options), b = ask(launched(), {points, {}}, options);
  CHECK(a.error == b.error);
  CHECK(a.indices == b.indices);
  if (!a.error.empty() || !b.error.empty()) return;
  CHECK(difference(a.mesh, b.mesh) == "");
  const Statistics &s = a.mesh.statistics, &t = b.mesh.statistics;
  CHECK(s.vertices_merged == t.vertices_merged);
  CHECK(s.notes == t.notes);
  if (points.size() > Tuning().one_item_vertices) return;
  CHECK(s.flips == t.flips);
  CHECK(s.location_steps == t.location_steps);
  CHECK(s.cases.edge_splits == t.cases.edge_splits);
  CHECK(s.rounds.insert == t.rounds.insert);
  CHECK(s.launches == t.launches);
}

/// A solver that works here, and the names of the calls that it makes, with how many of each.
struct Watched {
  std::shared_ptr<std::map<std::string, int>> calls = std::make_shared<std::map<std::string, int>>();
  std::shared_ptr<std::string> failing = std::make_shared<std::string>(),
                               launched_first = std::make_shared<std::string>();
  Solver solver;

  Watched() : solver(hooked_solver(hook())) {}
  runtime::CallHook hook() const {
    runtime::CallHook hook;
    hook.tuning.works_here = true;
    hook.before = [calls = calls, failing = failing, first = launched_first](const char* call, const char* detail) {
      ++(*calls)[call];
      if (first->empty() && call == std::string("clEnqueueNDRangeKernel")) *first = detail;
      return *failing == call ? CL_OUT_OF_HOST_MEMORY : CL_SUCCESS;
    };
    return hook;
  }
  int asked_of_device() const {
    int all = 0;
    for (const auto& [name, times] : *calls)
      if (name.find("clEnqueue") == 0 || name.find("clBuild") == 0 || name == "clCreateKernel" ||
          name.find("clCreateProgram") == 0 || name == "clFinish" || name == "clWaitForEvents")
        all += times;
    return all;
  }
};

/// A runtime that works here, with how often it was asked to launch.
struct Here {
  std::shared_ptr<std::map<std::string, int>> calls = std::make_shared<std::map<std::string, int>>();
  std::unique_ptr<runtime::Runtime> made;
  runtime::Runtime& runtime;

  Here() : made(make()), runtime(*made) {}
  std::unique_ptr<runtime::Runtime> make() const {
    runtime::CallHook hook;
    hook.tuning.works_here = true;
    hook.before = [calls = calls](const char* call, const char*) { return ++(*calls)[call], CL_SUCCESS; };
    return std::make_unique<runtime::Runtime>(device_of(DeviceKind::threads), hook);
  }
  int launches() const { return calls->count("clEnqueueNDRangeKernel") ? calls->at("clEnqueueNDRangeKernel") : 0; }
  int here() const { return calls->count("host launch") ? calls->at("host launch") : 0; }
};

/// Sorts n keys, by a kernel that the host has, and says whether they are in order.
bool sorts(runtime::Runtime& runtime, std::vector<cl_ulong> keys) {
  const auto n = static_cast<cl_uint>(keys.size());
  const auto given = runtime.upload("keys", keys);
  const auto values = runtime.filled<cl_uint>("values", n, 0), other_values = runtime.allocate<cl_uint>("values", n);
  const auto other = runtime.allocate<cl_ulong>("keys", n);
  runtime.launch("by_one_item", "sort_by_one_item", runtime::one_item(), n, cl_uint{16}, given, values, other,
                 other_values);  // two digits: they come back to where they were
  runtime.read(given, keys.data(), keys.size());
  return std::is_sorted(keys.begin(), keys.end());
}

const std::vector<cl_ulong> disordered = {9, 7, 8, 300, 1, 0, 40000, 2};
const std::vector<Point> square = {{0, 0}, {5, 0}, {5, 5}, {0, 5}, {2, 1}, {3, 4}};

}  // namespace

TEST_CASE("the same as launched: shapes up to the limit and beyond it, with vertices that coincide or not") {
  const std::size_t few = Tuning().one_item_vertices, most = most_here();
  REQUIRE(most > few);
  for (const char* name : {"uniform", "parabola", "row", "grid", "near_circle", "letters", "hub"})
    for (const std::size_t n : {std::size_t{10}, std::size_t{1000}, few, few + 1, most, most + 1}) {
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
TEST_CASE("vertices in clusters are put in the same order by one work-item, launched or not, as by many") {
  Solver many = tuned_solver(DeviceKind::threads, shared_out());
  Random random(3);
  for (const std::uint32_t n : {1000u, 2000u, 12000u})
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
      const Answer by_many = ask(many, {points, {}});
      CHECK(by_many.error == "");
      CHECK(difference(ask(here(), {points, {}}).mesh, by_many.mesh) == "");
      CHECK(difference(ask(launched(), {points, {}}).mesh, by_many.mesh) == "");
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
                                                                          {{0.1, 0.25}, {1.5, 0.5}, {0.5, 1.75}},
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

TEST_CASE("the same with constraints, whatever becomes of those that cross") {
  for (const Crossing crossing : {Crossing::reject, Crossing::drop, Crossing::split})
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      CAPTURE(seed);
      Options options;
      options.crossing = crossing;
      options.regions = seed % 4 < 2;
      options.domain = seed > 8 ? Domain::even_odd : Domain::hull;
      const Workload work = seed % 2 == 0 ? random_pslg(400, 1 << 16, 150, seed) : random_crossing(300, 60, 40, seed);
      const Answer a = ask(here(), work, options), b = ask(launched(), work, options);
      CHECK(a.error == b.error);
      CHECK(a.indices == b.indices);
      if (a.error.empty() && b.error.empty()) CHECK(difference(a.mesh, b.mesh) == "");
    }
}

TEST_CASE("nothing is asked of the device, and nothing is compiled, until there are many vertices") {
  Watched watched;
  CHECK(watched.asked_of_device() == 0);
  const Workload few = workload("uniform", most_here()), many = workload("uniform", few.points.size() + 1);
  const Statistics s = watched.solver.triangulate(few.points, {}).statistics;
  CHECK(s.launches <= 8);
  CHECK(s.read_backs == 0);
  CHECK(s.ms.build == 0);
  CHECK(watched.solver.triangulate(few.points, Constraints({{0, 1}, {1, 2}})).statistics.read_backs == 0);
  Options any;
  any.grid = FixedGrid{0, 0, "0.25"};
  const std::vector<Point> twice = {{0, 0}, {1, 0}, {0, 1}, {1, 0}};
  CHECK(watched.solver.triangulate(twice, {}, any).triangles.size() == 1);
  CHECK((*watched.calls)["host launch"] > 20);
  CHECK(watched.asked_of_device() == 0);
  const CacheFolder empty;  // else it knows that the device computes rightly
  CHECK(watched.solver.triangulate(many.points, {}).statistics.read_backs > 0);
  CHECK(watched.asked_of_device() > 0);
  CHECK(*watched.launched_first == "selftest_words");
}

TEST_CASE("how many are few: more where fewer threads would help, and not with many times as many constraints") {
  Here one;
  const std::uint64_t units = one.runtime.info().compute_units;
  CHECK(one.runtime.most_here() == (units == 1 ? 4 * 8192 : 8192 * units / (units - 1)));
  one.runtime.tuning().here_vertices = 100;
  CHECK(one.runtime.most_here() == (units == 1 ? 400 : 100 * units / (units - 1)));
  one.runtime.tuning().one_item_vertices = 0;
  CHECK(one.runtime.most_here() == 0);
  Watched watched;
  const std::vector<Point> few = workload("uniform", 50).points;
  std::vector<Constraint> constraints(2 * most_here(), Constraint{3, 4});
  const Triangulation last = watched.solver.triangulate(few, constraints);
  CHECK(watched.asked_of_device() == 0);
  constraints.push_back({3, 4});
  const Triangulation first = watched.solver.triangulate(few, constraints);
  CHECK(watched.asked_of_device() > 0);
  CHECK(last.triangles == first.triangles);
  CHECK(last.pieces == first.pieces);
}

TEST_CASE("a device that cannot be used is found when it is needed, and few vertices never need it") {
  Watched watched;
  *watched.failing = "clCreateProgramWithSource";
  const std::vector<Point> many = workload("uniform", most_here() + 1).points;
  for (int time = 0; time < 2; ++time) {
    CHECK(watched.solver.triangulate(square, {}).triangles.size() == 6);
    CHECK_THROWS_AS(watched.solver.triangulate(many, {}), const Error&);
  }
  *watched.failing = "";
  CHECK(watched.solver.triangulate(many, {}).triangles.size() > many.size());
}

TEST_CASE("what was queued is waited for before the host uses the memory") {
  Here one;
  {
    const runtime::WorkHere works(one.runtime, true);
    CHECK(sorts(one.runtime, disordered));
    CHECK(one.here() == 1);
    CHECK(one.launches() == 0);
    const auto large = one.runtime.allocate<cl_uint>("large", Tuning::most_shared / sizeof(cl_uint) + 1);
    CHECK(large.memory().here == nullptr);
    one.runtime.fill<cl_uint>(large, 7, large.size());  // queued
    CHECK(sorts(one.runtime, disordered));              // queued behind it, and read with a wait
    CHECK(one.here() == 1);
    CHECK(one.launches() > 0);
    CHECK(one.runtime.read_one(large, large.size() - 1) == 7);
    const int queued = one.launches();
    CHECK(sorts(one.runtime, disordered));
    CHECK(one.here() == 2);
    CHECK(one.launches() == queued);
    one.runtime.fill<cl_uint>(large, 8, large.size());
    one.runtime.finish();
    CHECK(sorts(one.runtime, disordered));
    CHECK(one.here() == 3);
  }
  CHECK(sorts(one.runtime, disordered));
  CHECK(one.here() == 3);
}

TEST_CASE("a launch here must have the kernel's arguments, as one of a device's must") {
  Here one;
  const runtime::WorkHere works(one.runtime, true);
  const auto keys = one.runtime.filled<cl_ulong>("keys", 4, 1);
  CHECK_THROWS_AS(one.runtime.launch("by_one_item", "sort_by_one_item", runtime::one_item(), cl_uint{4}, keys),
                  const Error&);
  CHECK_THROWS_AS(one.runtime.launch("by_one_item", "sort_by_one_item", runtime::one_item(), cl_ulong{4}, cl_uint{16},
                                     keys, keys, keys, keys),
                  const Error&);
  CHECK(one.here() == 0);
}

TEST_CASE("the host's copies, fills and writes go where the device's would") {
  Here one;
  const runtime::WorkHere works(one.runtime, true);
  const std::vector<cl_uint> numbers = {1, 2, 3, 4, 5, 6, 7, 8};
  const auto from = one.runtime.upload("from", numbers), to = one.runtime.filled<cl_uint>("to", 8, 9);
  one.runtime.copy(from, to, 3, 2);
  const cl_uint two[] = {21, 22};
  one.runtime.write(to, two, 2, 5);
  one.runtime.fill<cl_uint>(to, 77, 1, 7);
  std::vector<cl_uint> all(7);
  one.runtime.read(to, all.data(), 7, 1);
  CHECK(all == std::vector<cl_uint>{4, 5, 9, 9, 21, 22, 77});
  one.runtime.zero(to);
  CHECK(one.runtime.read_one(to, 7) == 0);
  const auto pairs = one.runtime.filled<cl_ulong>("pairs", 1000, 0x0123456789ABCDEF);
  one.runtime.fill<cl_ulong>(pairs, 5, 333, 334);
  std::vector<cl_ulong> seen(1000);
  one.runtime.read(pairs, seen.data(), seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i)
    CHECK(seen[i] == (i >= 334 && i < 667 ? cl_ulong{5} : cl_ulong{0x0123456789ABCDEF}));
  CHECK(one.runtime.rows_of(1u << 20) == 1);  // of tables with a row for each work-item
  CHECK(one.runtime.read_backs() == 0);
  for (const auto& [name, times] : *one.calls) CHECK(name.find("clEnqueue") != 0);
}

// By another queue, and after the runtime has gone: the memory goes with the last reference to a buffer.
TEST_CASE("a device reads what the host has made") {
  const Workload work = workload("letters", 1500);
  const Triangulation host = here().triangulate(work.points, work.constraints);
  cl_mem memory = nullptr;
  {
    Here one;
    const runtime::WorkHere works(one.runtime, true);
    const auto buffer = one.runtime.upload("triangles", host.triangles.data(), host.triangles.size());
    CHECK(buffer.memory().here != nullptr);
    memory = buffer.handle();
    clRetainMemObject(memory);
    const cl::CommandQueue queue(one.runtime.context(), one.runtime.device());
    std::vector<std::array<std::uint32_t, 3>> seen(host.triangles.size());
    CHECK(queue.enqueueReadBuffer(cl::Buffer(memory, true), CL_TRUE, 0, seen.size() * sizeof seen[0], seen.data()) ==
          CL_SUCCESS);
    CHECK(std::equal(seen.begin(), seen.end(), host.triangles.begin()));
  }
  cl_uint references = 0;
  CHECK(clGetMemObjectInfo(memory, CL_MEM_REFERENCE_COUNT, sizeof references, &references, nullptr) == CL_SUCCESS);
  CHECK(references == 1);
  CHECK(clReleaseMemObject(memory) == CL_SUCCESS);
}

TEST_CASE("phases are timed, wherever they are done") {
  for (const std::vector<Constraint>& constraints : {std::vector<Constraint>{}, {{0, 1}, {1, 2}}}) {
    const auto begin = std::chrono::steady_clock::now();
    const Statistics s = here().triangulate(workload("uniform", 2000).points, constraints).statistics;
    const double call = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    for (const double ms : {s.ms.order, s.ms.insert, s.ms.gather, s.ms.check, s.ms.output}) CHECK(ms > 0);
    CHECK(s.ms.gather < s.ms.output);
    CHECK(s.ms.core < s.ms.full);
    CHECK(s.ms.full < call);
  }
}

TEST_CASE("a trace has the launches that the calling thread has done") {
  std::map<std::string, std::uint64_t> spans;
  std::uint64_t until = 0;
  bool ordered = true;
  Solver traced = tuned_solver(DeviceKind::threads, {}, [&](const TraceSpan& span) {
    if (!span.on_device) return;
    ordered = ordered && span.begin_ns >= until && span.end_ns >= span.begin_ns;
    until = span.end_ns;
    ++spans[std::string(span.name)];
  });
  const Triangulation mesh = traced.triangulate(workload("uniform", 1000).points, {});
  CHECK(ordered);
  CHECK(mesh.statistics.launches == 5);
  for (const char* name : {"order_by_one_item", "grow_insert", "output_by_one_item", "check_by_one_item"})
    CHECK(spans[name] == 1);
}

// On numbers that the device's self-test knows the answers of, worked out elsewhere.
TEST_CASE("the host's kernels compute as devices must") {
  const runtime::HostKernel* words = runtime::find_host_kernel("core", "selftest_words");
  REQUIRE(words);
  CHECK(runtime::find_host_kernel("core", "no_such_kernel") == nullptr);
  const std::array<cl_ulong, 4> operands = {0xFFFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF, 0x7FFFFFFFFFFFFFFF,
                                            0x8000000000000001};
  std::array<cl_ulong, 16> results = {};
  const cl_uint rows = 2;
  const void *in = operands.data(), *out = results.data();
  const void* const given[] = {&rows, &in, &out};
  words->run(given);
  CHECK(results[0] == 0xFFFFFFFFFFFFFFFE);  // the high words of products
  CHECK(results[8] == 0x3FFFFFFFFFFFFFFF);
  CHECK(results[1] == 1);  // the low ones
  CHECK(results[9] == 0xFFFFFFFFFFFFFFFF);
  const runtime::HostKernel* atomics = runtime::find_host_kernel("core", "selftest_atomics");
  REQUIRE(atomics);
  const cl_uint none = 0xFFFFFFFF, numbers = 64;
  std::array<cl_uint, 9> after = {0, none, 0, 0, none, 0, 0, none, 0};
  const void* const array = after.data();
  const void* const of_atomics[] = {&numbers, &array};
  atomics->run(of_atomics);
  CHECK(after == std::array<cl_uint, 9>{64 * 63 / 2, 5, 68, none, 0, 64, 64 * 63 / 2, 0, 1});
}
