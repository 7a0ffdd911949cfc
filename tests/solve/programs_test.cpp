// SPDX-License-Identifier: Apache-2.0
// Programs that threads build while a call is under way (device/built_programs.hpp): on PoCL, treated as a GPU whose
// driver compiles programs when they are built.
#include <doctest/doctest.h>

#include <set>

#include "api/state.hpp"
#include "cache_folder.hpp"
#include "device_list.hpp"
#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "solve/programs.hpp"

using namespace gcdt;
using namespace gcdt::test;
using runtime::Meshes;

namespace {

const cl::Device pocl_device = device_of(DeviceKind::threads);

runtime::CallHook compiles_programs(std::uint32_t at_once) {
  runtime::CallHook hook;
  hook.tuning.kind = DeviceKind::gpu;
  hook.tuning.builds_at_once = at_once;
  hook.keep_programs = true;
  return hook;
}

std::string in_order(const std::vector<const char*>& names) {
  std::string all;
  for (const std::string& name : std::set<std::string>(names.begin(), names.end())) all += name + " ";
  return all;
}

/// What is built while it lives, of a log.
struct Listener {
  std::set<std::string> built;
  runtime::Log log() {
    return [this](int, const char* message) {
      const std::string text = message;
      if (text.rfind("built ", 0) == 0) built.insert(text.substr(6, text.find(' ', 6) - 6));
    };
  }
  std::string in_order() const {
    std::string all;
    for (const std::string& name : built) all += name + " ";
    return all;
  }
};

// What a call builds itself, but for the self-test's.
std::string built_by(const Workload& input, std::uint32_t most_merged,
                     std::uint32_t least_patched = Tuning().least_patched,
                     std::uint32_t least_grouped = Tuning().least_grouped) {
  Listener listener;
  auto handle = std::make_unique<gcdt_solver>();
  runtime::CallHook hook = compiles_programs(1);
  hook.tuning.most_merged = most_merged;
  hook.tuning.least_patched = least_patched;
  hook.tuning.least_grouped = least_grouped;
  handle->state = std::make_shared<api::State>(cl::Context(), pocl_device, listener.log(), Trace(), hook);
  Solver solver(handle.release());
  listener.built.clear();
  solver.triangulate(input.points, input.constraints);
  listener.built.erase("decimals");  // which inputs need whose coordinates may be decimals
  return listener.in_order();
}

// What a solver and its first call build where work-items are loops of threads. `here`: the calling thread does what it
// can.
std::string built_on_threads(const Workload& input, bool here) {
  Listener listener;
  auto handle = std::make_unique<gcdt_solver>();
  runtime::CallHook hook;
  hook.tuning.works_here = here;
  handle->state = std::make_shared<api::State>(cl::Context(), pocl_device, listener.log(), Trace(), hook);
  Solver(handle.release()).triangulate(input.points, input.constraints);
  return listener.in_order();
}

std::string built_by(const std::vector<Workload>& problems) {
  Listener listener;
  runtime::CallHook hook = compiles_programs(1);
  hook.tuning.workers = 1;
  Pool pool(hooked_pool({hook}, listener.log()).release());
  pool.triangulate(batch_of(problems));
  listener.built.erase("selftest");
  listener.built.erase("holes");  // which graphs have hexagons
  listener.built.erase("gates");  // which graphs cross much
  return listener.in_order();
}

}  // namespace

TEST_CASE("the programs that a call is said to need are those that it builds") {
  // More than are merged are sorted by digits; and so are levels where isolated vertices come early, of any number, as
  // they do in letters and rows.
  constexpr std::uint32_t fewer_merged = 1 << 14;
  CallShape points, graph;
  graph.constrained = true;
  CHECK(built_by(workload("uniform", 20000), fewer_merged) == in_order(programs_of_call(points)));
  CHECK(built_by(random_pslg(20000, 1 << 20, 3000, 2), fewer_merged) == in_order(programs_of_call(graph)));
  // One vertex has most of the triangles, more than a group sorts.
  points.merged = true;
  std::vector<const char*> of_row = programs_of_call(points);
  of_row.insert(of_row.end(), {"sort_left", "sort64_group"});
  CHECK(built_by(workload("row", 20000), Tuning().most_merged) == in_order(of_row));
  points.patched = true;
  CHECK(built_by(workload("uniform", 20000), Tuning().most_merged, 60000) == in_order(programs_of_call(points)));
  graph.patched = graph.grouped = true;
  CHECK(built_by(workload("letters", 20000), Tuning().most_merged, 60000, 50000) == in_order(programs_of_call(graph)));
  std::vector<Workload> clouds, graphs;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    clouds.push_back(uniform(100, seed));
    graphs.push_back(random_pslg(100, 1 << 10, 30, seed));
  }
  CHECK(built_by(clouds) == in_order(programs_of_call({Meshes::many})));
  CHECK(built_by(graphs) == in_order(programs_of_call({Meshes::many, true})));
}

TEST_CASE("on CPUs a call builds three programs at most") {
  for (const bool here : {false, true}) {
    CHECK(built_on_threads(workload("uniform", 1000), here) == (here ? "" : "core "));
    CHECK(built_on_threads(random_pslg(1000, 1 << 20, 100, 2), here) == (here ? "" : "core enforce "));
    CHECK(built_on_threads(workload("uniform", 40000), here) == "core flips ");
    CHECK(built_on_threads(random_pslg(40000, 1 << 20, 3000, 2), here) == "constraints core flips ");
  }
}

TEST_CASE("calls whose programs are built by threads give the same, the first one without those that only save time") {
  const NoCache none;
  const Workload input = workload("letters", 98000);
  const Triangulation expected = solver().triangulate(input.points, input.constraints);
  CallShape first;
  first.constrained = first.merged = first.swept = first.spares = true;
  CallShape second = first;
  second.spares = false;
  REQUIRE(3 * input.points.size() > Tuning().least_sweep);
  auto handle = std::make_unique<gcdt_solver>();
  handle->state =
      std::make_shared<api::State>(cl::Context(), pocl_device, runtime::Log(), Trace(), compiles_programs(4));
  runtime::Runtime& runtime = handle->state->runtime;
  Solver gpu(handle.release());
  REQUIRE(runtime.most_builds() == 4);
  CHECK(difference(gpu.triangulate(input.points, input.constraints), expected) == "");
  for (const char* program : programs_of_call(first)) CHECK(!runtime.would_compile(program));
  for (const char* program : {"sort64_group", "buckets", "insert_few", "flip_few", "sweeps"})
    CHECK(runtime.would_compile(program));
  CHECK(!runtime.spares_programs());
  CHECK(difference(gpu.triangulate(input.points, input.constraints), expected) == "");
  for (const char* program : programs_of_call(second)) CHECK(!runtime.would_compile(program));
}

TEST_CASE("a chain of flips in a first call has the program compiled that follows it") {
  const NoCache none;
  const Workload comb = workload("comb", 20000);
  const Triangulation expected = solver().triangulate(comb.points, comb.constraints);
  auto handle = std::make_unique<gcdt_solver>();
  handle->state =
      std::make_shared<api::State>(cl::Context(), pocl_device, runtime::Log(), Trace(), compiles_programs(4));
  runtime::Runtime& runtime = handle->state->runtime;
  Solver gpu(handle.release());
  const Triangulation made = gpu.triangulate(comb.points, comb.constraints);
  CHECK(difference(made, expected) == "");
  CHECK(made.statistics.rounds.flip > Tuning::rounds_without_few);
  CHECK(made.statistics.rounds.flip < 3 * Tuning::rounds_without_few);  // thousands without it
  CHECK(!runtime.would_compile("flip_few"));
  CHECK(runtime.would_compile("insert_few"));
}

TEST_CASE("threads share what they build, at most so many at once, and one that fails is tried again") {
  runtime::BuiltPrograms programs;
  std::atomic<int> made{0}, under_way{0}, most{0};
  const auto build = [&] {
    const int now = ++under_way;
    for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ++made, --under_way;
    return cl::Program();
  };
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 10; ++i) programs.get({"program " + std::to_string(i), runtime::Meshes::one}, 3, build);
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(made == 10);
  CHECK(most <= 3);
  const runtime::BuiltPrograms::Key bad = {"bad", runtime::Meshes::one};
  CHECK_THROWS_AS(
      programs.get(bad, 1, []() -> cl::Program { throw Error(Status::device_failed, "it does not compile"); }), Error);
  CHECK(!programs.has(bad));
  programs.get(bad, 1, build);
  CHECK(programs.has(bad));
  CHECK(made == 11);
}

TEST_CASE("a program that does not compile is told by the call, and threads end with it") {
  runtime::CallHook hook = compiles_programs(4);
  hook.options = "-DFOR_EACH=this does not compile";
  const runtime::Log silent;
  CHECK_THROWS_AS(runtime::Runtime(cl::Context(), pocl_device, hook, silent), Error);
}
