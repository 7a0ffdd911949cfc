// SPDX-License-Identifier: Apache-2.0
// A forest on one device: every problem's part of a run is what the problem has alone, byte for byte.
#include <doctest/doctest.h>

#include <numeric>

#include "batch/pipeline.hpp"
#include "batch_cases.hpp"
#include "device_list.hpp"
#include "opencl_app.hpp"
#include "solve/triangulate.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

// Before any test lists devices.
const std::vector<cl::Device> all_of_them = every_device();

struct Device {
  runtime::Runtime runtime;
  Primitives primitives;
  explicit Device(const cl::Device& device, const runtime::CallHook& hook = {})
      : runtime(device, hook), primitives(runtime) {}
  Device(const cl::Device& device, Primitives::Walk walk) : runtime(device), primitives(runtime, walk) {}
};

Device* other_device = nullptr;

Device& device() {
  static Device usual(app_device());
  return other_device ? *other_device : usual;
}

// Forests run on another device for its life.
struct On {
  Device* const before = other_device;
  explicit On(Device& device) { other_device = &device; }
  ~On() { other_device = before; }
};

runtime::Geometry& geometry() { return device().runtime.geometry(); }

ForestResult run(const RaggedBatch& batch, const std::vector<std::uint32_t>& numbers, const Options& options) {
  Staging staging(device().runtime);
  return triangulate_forest(device().runtime, device().primitives, batch.view(), numbers, options, staging);
}

/// What is wrong with a problem alone.
Error error_of(const Workload& problem, const Options& options) {
  try {
    solver().triangulate(problem.points, problem.constraints, options);
  } catch (const Error& error) {
    return error;
  }
  return Error(Status::ok, "nothing");
}

void check_error(const Error& error, const Workload& problem, const Options& options) {
  const Error single = error_of(problem, options);
  CHECK(error.status() == single.status());
  CHECK(std::string(error.what()) == single.what());
  CHECK(error.indices() == single.indices());
  CHECK(error.pair_count() == single.pair_count());
}

/// Runs the problems; those with invalid input, whose errors must be those that they have alone, are taken out until
/// none is left. Those that cross are refused in the last run, likewise. Returns how many have errors.
std::size_t check_same_as_single(const std::vector<Workload>& problems, const Options& options = {}) {
  const RaggedBatch batch(problems);
  std::vector<std::uint32_t> numbers(problems.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  for (std::size_t invalid = 0;;) {
    try {
      const ForestResult forest = run(batch, numbers, options);
      std::vector<bool> refused(numbers.size(), false);
      for (const auto& [place, error] : forest.refused) {
        CAPTURE(numbers[place]);
        check_error(error, problems[numbers[place]], options);
        CHECK(error.status() == Status::constraints_cross);
        refused[place] = true;
      }
      CHECK(forest.to_split.empty());
      std::uint64_t triangles = 0;
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (refused[i]) continue;
        CAPTURE(numbers[i]);
        const Workload& problem = problems[numbers[i]];
        const Triangulation single = solver().triangulate(problem.points, problem.constraints, options);
        CHECK(difference(part_of(forest, i), single) == "");
        triangles += single.triangles.size();
      }
      CHECK(forest.triangles() == triangles);
      return invalid + forest.refused.size();
    } catch (const InvalidProblems& found) {
      REQUIRE(!found.errors.empty());
      for (auto e = found.errors.rbegin(); e != found.errors.rend(); ++e) {
        CAPTURE(numbers[e->first]);
        CHECK(e->second.status() != Status::constraints_cross);
        check_error(e->second, problems[numbers[e->first]], options);
        numbers.erase(numbers.begin() + e->first);
        ++invalid;
      }
    }
  }
}

}  // namespace

TEST_CASE("a forest of one is the problem alone") {
  check_same_as_single({workload("random_pslg", 40)});
  check_same_as_single({uniform(3000)});
}

TEST_CASE("the smallest problems side by side: none, one, two, three vertices, lines, duplicates") {
  check_same_as_single(smallest_problems());
}

TEST_CASE("the corpus in one forest: invalid and crossing problems have their own errors and spoil no other") {
  const std::vector<Workload> all = corpus({"ok", "crossing", "invalid"});
  const std::size_t crossing = corpus({"crossing"}).size(), invalid = corpus({"invalid"}).size();
  CHECK(check_same_as_single(all) == crossing + invalid);
  Options drop;
  drop.crossing = Crossing::drop;
  CHECK(check_same_as_single(all, drop) == invalid);
}

TEST_CASE("under split, a forest names the problems that cross, and has the others") {
  std::vector<Workload> all = corpus({"crossing"});
  std::vector<std::uint32_t> crossing(all.size());
  std::iota(crossing.begin(), crossing.end(), 0);
  for (const Workload& problem : corpus({"ok"})) all.push_back(problem);
  std::vector<std::uint32_t> numbers(all.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  Options options;
  options.crossing = Crossing::split;
  const ForestResult forest = run(RaggedBatch(all), numbers, options);
  CHECK(forest.refused.empty());
  CHECK(forest.to_split == crossing);
  std::uint64_t triangles = 0;
  for (std::size_t i = crossing.size(); i < all.size(); ++i) {
    CAPTURE(i);
    const Triangulation single = solver().triangulate(all[i].points, all[i].constraints, options);
    CHECK(difference(part_of(forest, i), single) == "");
    triangles += single.triangles.size();
  }
  CHECK(forest.triangles() == triangles);
}

TEST_CASE("a grid that is given holds for every problem, and those outside say so") {
  Options options;
  options.grid = FixedGrid{-1000, -1000, "0.001"};
  CHECK(check_same_as_single(smallest_problems(), options) == 0);
  options.grid = FixedGrid{0, 0, "0.001"};
  const std::size_t outside = check_same_as_single(corpus({"ok"}), options);
  CHECK(outside > 0);
  CHECK(outside < corpus({"ok"}).size());
}

TEST_CASE("domains and regions of every problem, side by side with those without any") {
  std::vector<Workload> all = corpus({"ok"});
  for (const Workload& problem : smallest_problems()) all.push_back(problem);
  all.push_back(workload("random_pslg", 40));
  Options options;
  for (const Domain domain : {Domain::hull, Domain::even_odd, Domain::nonzero, Domain::outer}) {
    options.domain = domain;
    options.regions = true;
    CHECK(check_same_as_single(all, options) == 0);
  }
  CHECK(check_same_as_single(std::vector<Workload>(3, problem({})), options) == 0);
}

TEST_CASE("generated problems of all kinds and sizes in one forest, in several levels") {
  check_same_as_single(generated_problems());
}

// On CPUs with few cores each problem's constraints are enforced by one work-item (kernels/constrain/enforce.cl).
TEST_CASE("many problems of one size, with constraints of all kinds") {
  std::vector<Workload> problems;
  for (const std::size_t n : {60, 500})
    for (const std::string& name : workload_names()) {
      problems.push_back(workload(name, n));
      if (problems.back().points.size() > 1000) problems.pop_back();  // some have a least size
    }
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    problems.push_back(random_pslg(150, 9, 150, seed));          // overlaps, vertices on constraints, none of length 0
    problems.push_back(random_pslg(400, 4000, 120, seed + 20));  // across many edges
  }
  Options options;
  options.regions = true;
  options.domain = Domain::even_odd;
  CHECK(check_same_as_single(problems, options) == check_same_as_single(problems));
}

TEST_CASE("problems that are inserted by one work-item each, and too large for their constraints to be") {
  check_same_as_single({workload("fan", 17000), workload("letters", 17000), workload("star", 17000), uniform(17000)});
}

TEST_CASE("crossing constraints in one of many problems") {
  std::vector<Workload> problems(20, random_pslg(200, 1000, 60, 7));
  problems.insert(problems.begin() + 3, random_crossing(200, 1000, 60, 5));
  CHECK(check_same_as_single(problems) == 1);
  Options drop;
  drop.crossing = Crossing::drop;
  CHECK(check_same_as_single(problems, drop) == 0);
}

TEST_CASE("equal problems have equal parts") {
  check_same_as_single(std::vector<Workload>(300, workload("random_pslg", 8)));
}

std::vector<Workload> small_problems() {
  std::vector<Workload> problems = smallest_problems();
  for (const std::string& name : workload_names()) problems.push_back(workload(name, 60));
  for (std::uint64_t seed = 1; seed <= 5; ++seed) problems.push_back(random_pslg(400, 4000, 120, seed));
  problems.push_back(uniform(2048));
  return problems;
}

TEST_CASE("problems that work-groups put in order, as on GPUs: few vertices each, or many") {
  Device by_groups(app_device(), Primitives::Walk::group);
  const On on(by_groups);
  std::vector<Workload> problems = small_problems();
  check_same_as_single(problems);
  problems.push_back(workload("fan", 5000));  // more triangles at a vertex than a group sorts
  problems.push_back(workload("star", 20000));
  check_same_as_single(problems);
}

// As on GPUs, with problems that are small enough for CPUs.
TEST_CASE("problems that a work-group triangulates, on every device whose work-items are not threads' loops") {
  std::vector<Workload> small;
  for (const Workload& problem : small_problems())
    if (problem.points.size() <= 256) small.push_back(problem);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) small.push_back(random_pslg(150, 9, 150, seed));
  REQUIRE(small.size() > 30);
  std::size_t devices = 0;
  for (const cl::Device& each : all_of_them) {
    Device device(each);
    if (device.runtime.contiguous()) continue;
    CAPTURE(device.runtime.info().name);
    ++devices;
    const On on(device);
    check_same_as_single(small);
    device.runtime.geometry().max_groups = 3;  // several launches on CPUs, several problems a group on GPUs
    check_same_as_single(small);
    runtime::CallHook two_rounds;  // a launch: the next goes on with what is left
    two_rounds.tuning.rounds_of_group = 2;
    Device haltingly(each, two_rounds);
    const On then(haltingly);
    check_same_as_single(small);
  }
  REQUIRE_MESSAGE(devices > 0, "this needs a GPU, or Mesa's driver (Debian and Ubuntu: mesa-opencl-icd)");
}

// A launch with a work-item for each vertex and more, as on a CPU with many cores: some work-items of its last group
// have nothing to do, and nothing may be done in their name (PoCL 5: kernels/common/history.h, coarse_vertex_at).
TEST_CASE("a launch wider than the forest") {
  const runtime::Geometry usual = geometry();
  geometry().max_groups = std::size_t{1} << 20;
  check_same_as_single(std::vector<Workload>(65, uniform(1000)));
  check_same_as_single({uniform(65000)});
  geometry() = usual;
}

TEST_CASE("programs that were built for one problem are built anew for forests") {
  runtime::Runtime runtime(app_device());
  Primitives primitives(runtime);
  const Workload problem = workload("random_pslg", 40);
  const Points points = problem.points;
  const Constraints constraints = problem.constraints;
  const InputSource source = {points.size(), constraints.size(), [&] {
                                return DeviceInput{stage(runtime, points), stage(runtime, constraints)};
                              }};
  gcdt::triangulate(runtime, primitives, source, Options());
  const RaggedBatch batch({problem, problem, problem});
  Staging staging(runtime);
  const ForestResult forest = triangulate_forest(runtime, primitives, batch.view(), {0, 1, 2}, {}, staging);
  const Triangulation single = solver().triangulate(problem.points, problem.constraints);
  for (std::size_t i = 0; i < 3; ++i) CHECK(difference(part_of(forest, i), single) == "");
}

TEST_CASE("results are the same in room that was made beforehand, whether it is too large or too small") {
  runtime::CallHook hook;
  hook.tuning.prepares_host_memory = true;
  runtime::Runtime runtime(app_device(), hook);
  Primitives primitives(runtime);
  Staging staging(runtime);
  // Triangles nearly as many as room for them; on a line, none; and more pieces than constraints.
  Workload line, overlapping = uniform(40000);
  for (std::uint32_t i = 0; i < 40000; ++i) line.points.push_back({double(i), 0.0});
  const auto corner = static_cast<std::uint32_t>(overlapping.points.size());
  for (std::uint32_t i = 0; i < 10; ++i) overlapping.points.push_back({2.0 + i, 0.0});
  for (std::uint32_t i = 0; i < 3; ++i) overlapping.constraints.push_back({corner + i, corner + 9 - i});
  for (const Workload& problem : {uniform(40000), line, overlapping, uniform(50000)}) {
    const RaggedBatch batch({problem, problem});
    const ForestResult forest = triangulate_forest(runtime, primitives, batch.view(), {0, 1}, {}, staging);
    const Triangulation single = solver().triangulate(problem.points, problem.constraints);
    for (std::size_t i = 0; i < 2; ++i) CHECK(difference(part_of(forest, i), single) == "");
  }
}
