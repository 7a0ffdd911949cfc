// SPDX-License-Identifier: Apache-2.0
// Lives of objects and of the library: many threads, many creations, loading and unloading without growth.
#include <doctest/doctest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "cache_folder.hpp"
#include "opencl_app.hpp"

#ifdef __linux__
#include <dlfcn.h>
#include <unistd.h>
#endif

using namespace gcdt;
using namespace gcdt::test;

TEST_CASE("eight threads with solvers of their own get the same bytes as one") {
  std::vector<Integers> inputs;
  std::vector<Triangulation> expected;
  for (std::uint64_t i = 0; i < 8; ++i) {
    inputs.push_back(integer_input(200, i + 1));
    expected.push_back(from_host(inputs.back()));
  }
  std::atomic<int> right{0};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < 8; ++i)
    threads.emplace_back([&, i] {
      try {
        Options options;
        options.grid = FixedGrid{};
        Solver own(test_device());
        for (std::size_t k = 0; k < 8; ++k) {
          const std::size_t which = (i + k) % 8;
          right +=
              same_bytes(own.triangulate(inputs[which].points, inputs[which].constraints, options), expected[which]);
          try {
            own.triangulate(inputs[which].points, std::vector<Constraint>{{0, 1000000 + std::uint32_t(i)}}, options);
          } catch (const Error& error) {  // details are each thread's own
            right += std::string(error.what()).find("constraint 0") != std::string::npos;
          }
        }
      } catch (const std::exception& error) {
        MESSAGE(error.what());
      }
    });
  for (auto& thread : threads) thread.join();
  CHECK(right == 2 * 8 * 8);
}

TEST_CASE("exceptions of a progress function come through, and the solver works on") {
  Options options;
  options.progress = [](const char*, double) -> bool { throw std::logic_error("mine"); };
  CHECK_THROWS_WITH_AS(solver().triangulate(integer_input().points, {}, options), "mine", std::logic_error);
  CHECK(solver().triangulate(integer_input().points).triangles.size() > 0);
}

#ifdef __linux__

namespace {

// Resident bytes of this process.
std::size_t resident() {
  std::size_t total = 0, pages = 0;
  std::ifstream("/proc/self/statm") >> total >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Bytes by which the process grows while `step` runs `times` times, after as many runs again to warm up.
template <class Step>
std::size_t growth(int times, Step&& step) {
  for (int i = 0; i < times; ++i) step();
  const std::size_t before = resident();
  for (int i = 0; i < times; ++i) step();
  const std::size_t after = resident();
  return after > before ? after - before : 0;
}

// What only creating and releasing a context and a queue costs a driver.
void only_a_context() {
  const cl::Context context(app_device());
  const cl::CommandQueue queue(context, app_device());
}

#ifdef __SANITIZE_ADDRESS__
constexpr std::size_t noise = std::size_t{1} << 30;  // the sanitizer keeps freed memory for a while
#else
constexpr std::size_t noise = std::size_t{4} << 20;  // of the allocator: 4 KiB a solver
#endif

}  // namespace

TEST_CASE("creating and destroying 1000 solvers grows no more than creating 1000 contexts") {
  CacheFolder cache;
  { Solver warm(test_device()); }  // the device's self-test is made once
  const std::size_t contexts = growth(1000, only_a_context);
  const std::size_t solvers = growth(1000, [] { Solver solver(test_device()); });
  MESSAGE("contexts " << contexts << " solvers " << solvers);
  CHECK(solvers <= contexts + noise);
}

TEST_CASE("loading, using and unloading the library 100 times leaves nothing and grows no more than contexts") {
  CacheFolder cache;
  const auto use = [](bool triangulate) {
    void* library = dlopen(GCDT_SHARED_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    REQUIRE_MESSAGE(library != nullptr, dlerror());
    const auto create = reinterpret_cast<decltype(&gcdt_solver_create)>(dlsym(library, "gcdt_solver_create"));
    const auto release = reinterpret_cast<decltype(&gcdt_solver_release)>(dlsym(library, "gcdt_solver_release"));
    const auto run = reinterpret_cast<decltype(&gcdt_triangulate)>(dlsym(library, "gcdt_triangulate"));
    const auto drop = reinterpret_cast<decltype(&gcdt_result_release)>(dlsym(library, "gcdt_result_release"));
    gcdt_solver_options options = GCDT_SOLVER_OPTIONS_INIT;
    const std::string device = test_device();
    options.device = device.c_str();
    gcdt_solver* solver = nullptr;
    REQUIRE(create(&options, &solver) == GCDT_OK);
    if (triangulate) {
      const double corners[] = {0, 0, 1, 0, 0, 1};
      gcdt_input input = GCDT_INPUT_INIT;
      input.vertices = corners, input.vertex_count = 3;
      gcdt_result* result = nullptr;
      CHECK(run(solver, &input, nullptr, &result) == GCDT_OK);
      drop(result);
      CHECK(run(solver, nullptr, nullptr, &result) == GCDT_ERROR_INVALID_ARGUMENT);
    }
    release(solver);
    CHECK(dlclose(library) == 0);
    // Really unloaded, so nothing of it is registered with this thread or the process.
    CHECK(dlopen(GCDT_SHARED_LIBRARY, RTLD_NOW | RTLD_NOLOAD) == nullptr);
  };
  use(true);
  const std::size_t contexts = growth(100, only_a_context);
  const std::size_t loads = growth(100, [&] { use(false); });
  MESSAGE("contexts " << contexts << " loads " << loads);
  CHECK(loads <= contexts + noise);
}

#endif
