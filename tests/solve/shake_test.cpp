// SPDX-License-Identifier: Apache-2.0
// Bytes do not depend on the schedule: a mixed corpus, under a layer that permutes groups and work-items and lets
// groups wait (tests/support/shake_layer.cpp), launch by launch. GCDT_SHAKE_RUNS says how often (default 2, and 1000 in
// scripts/slow.sh shake), GCDT_SHAKE_FIRST which seed is the first (default 1).
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <gcdt/gcdt_pool.hpp>

#include "api/state.hpp"
#include "device_list.hpp"
#include "kinds.hpp"
#include "pool_cases.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// While it lives, launches are shaken by the layer.
class Shaken {
 public:
  explicit Shaken(int seed) { setenv("GCDT_SHAKE", std::to_string(seed).c_str(), 1); }
  ~Shaken() { unsetenv("GCDT_SHAKE"); }
  Shaken(const Shaken&) = delete;
  Shaken& operator=(const Shaken&) = delete;
};

int number(const char* variable, int usual) {
  const char* given = std::getenv(variable);
  return given ? std::atoi(given) : usual;
}

/// The seeds of the shaken runs.
int first_seed() { return number("GCDT_SHAKE_FIRST", 1); }
int end_of_seeds() { return first_seed() + number("GCDT_SHAKE_RUNS", 2); }

/// For who looks at a long run.
void tell(const char* what, int seed) {
  if ((seed - first_seed()) % 50 == 49) std::fprintf(stderr, "shake: %s: seeds %d to %d\n", what, first_seed(), seed);
}

struct Call {
  Workload work;
  Options options;
};

std::vector<Call> corpus() {
  std::vector<Call> all;
  for (const char* name : {"uniform", "grid", "clusters", "hub", "letters", "near_circle", "nested_squares"})
    all.push_back({workload(name, 800), {}});
  all.push_back({workload("uniform", 9000), {}});
  for (const Domain domain : {Domain::even_odd, Domain::nonzero, Domain::outer}) {
    Options options;
    options.domain = domain;
    all.push_back({workload("random_pslg", 60), options});
  }
  for (const Crossing crossing : {Crossing::drop, Crossing::split}) {
    Options options;
    options.crossing = crossing;
    all.push_back({random_crossing(150, 1000, 60, 7), options});
  }
  Options refined;
  refined.refine = Refinement{};
  refined.refine->most_added = 400;
  all.push_back({random_pslg(80, 1000, 30, 5), refined});
  return all;
}

Solver pocl_as(DeviceKind kind, const Tuning& given = {}) {
  Tuning tuning = given;
  tuning.kind = kind;
  tuning.works_here = false;  // launches alone are shaken
  return tuned_solver(DeviceKind::threads, tuning);
}

/// Every call once as it is, then shaken so many times.
void shake(const char* what, Solver& solver) {
  const std::vector<Call> calls = corpus();
  std::vector<Triangulation> expected;
  for (const Call& call : calls)
    expected.push_back(solver.triangulate(call.work.points, call.work.constraints, call.options));
  for (int seed = first_seed(); seed < end_of_seeds(); ++seed) {
    for (std::size_t i = 0; i < calls.size(); ++i) {
      CAPTURE(seed);
      CAPTURE(i);
      const Shaken shaken(seed);
      CHECK(difference(solver.triangulate(calls[i].work.points, calls[i].work.constraints, calls[i].options),
                       expected[i]) == "");
    }
    tell(what, seed);
  }
}

}  // namespace

TEST_CASE("the layer is there: shaken numbers are the usual ones in another order, group by group") {
  for (const cl::Device& d : every_device()) {
    if (runtime::kind_of(runtime::describe(d), {}) != DeviceKind::threads) continue;
    const cl::Context context(d);
    const cl::CommandQueue queue(context, d);
    // Behind #undef a name is what the driver says, the offset included.
    cl::Program program(context, std::string("uint shaken_id(void) { return get_global_id(0); }\n"
                                             "#undef get_global_id\n"
                                             "kernel void numbers(global uint* of) {"
                                             "  of[get_global_id(0) - get_global_offset(0)] = shaken_id();"
                                             "}"));
    REQUIRE(program.build({d}) == CL_SUCCESS);
    constexpr std::size_t groups = 13, size = 7;
    const cl::Buffer buffer(context, CL_MEM_READ_WRITE, groups * size * sizeof(cl_uint));
    cl::Kernel kernel(program, "numbers");
    kernel.setArg(0, buffer);
    std::vector<cl_uint> numbers(groups * size), usual(groups * size);
    const auto run = [&] {
      queue.enqueueNDRangeKernel(kernel, cl::NullRange, groups * size, size);
      queue.enqueueReadBuffer(buffer, CL_TRUE, 0, groups * size * sizeof(cl_uint), numbers.data());
    };
    for (std::size_t i = 0; i < usual.size(); ++i) usual[i] = static_cast<cl_uint>(i);
    run();
    CHECK(numbers == usual);
    int others = 0;
    for (int seed = 0; seed < 40; ++seed) {
      const Shaken shaken(seed);
      run();
      others += numbers != usual;
      for (std::size_t i = 0; i < numbers.size(); ++i) CHECK(numbers[i] / size == numbers[i / size * size] / size);
      std::sort(numbers.begin(), numbers.end());
      CHECK(numbers == usual);
    }
    CHECK(others > 35);
  }
}

TEST_CASE("threads: bytes do not depend on the schedule") {
  Solver solver = pocl_as(DeviceKind::threads);
  shake("threads", solver);
}

TEST_CASE("a device treated as a GPU, with usual thresholds and with small ones: neither do they there") {
  // Without patches: with shaken numbers PoCL 3.1 makes a kernel of flip_patches that crashes (docs/devices.md).
  Tuning small = small_thresholds();
  small.least_patched = 0xFFFFFFFFu;
  Solver usual = pocl_as(DeviceKind::gpu), few = pocl_as(DeviceKind::gpu, small);
  shake("GPU", usual);
  shake("GPU, small thresholds", few);
}

TEST_CASE("neither do those of batches and tiles") {
  Pool pool(test_device());
  std::vector<Workload> problems;
  Batch batch;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Workload work = random_crossing(4 + seed * 7 % 90, seed % 2 == 0 ? 12 : 1000, 20, seed);
    batch.add(work.points, work.constraints);
  }
  for (const Crossing crossing : {Crossing::drop, Crossing::split}) {
    Options options;
    options.crossing = crossing;
    for (const std::uint32_t tiles : {0u, 3u}) {
      options.tiles = tiles;
      const BatchResult expected = pool.triangulate(batch, options);
      for (int seed = first_seed(); seed < end_of_seeds(); ++seed) {
        CAPTURE(seed);
        const Shaken shaken(seed);
        const BatchResult found = pool.triangulate(batch, options);
        for (std::size_t p = 0; p < found.size(); ++p)
          CHECK(difference(gcdt::detail::triangulation(found, p), gcdt::detail::triangulation(expected, p)) == "");
        tell(tiles == 0 ? "batches" : "tiles", seed);
      }
    }
  }
}
