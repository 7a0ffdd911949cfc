// SPDX-License-Identifier: Apache-2.0
// Large transfers of a solver, which go through chunks of pinned memory and are copied by several threads.
#include <doctest/doctest.h>

#include "device/transfer_chunks.hpp"
#include "device_list.hpp"
#include "faulty_device.hpp"
#include "fresh_memory.hpp"
#include "random_bytes.hpp"
#include "threads_here.hpp"

using namespace gcdt;
using namespace gcdt::runtime;
using namespace gcdt::test;

namespace {

constexpr std::size_t chunk = 4096;

struct Way {
  std::uint32_t threads, chunks;
};
constexpr Way ways[] = {{1, 2}, {1, 3}, {2, 2}, {3, 8}, {5, 4}};

/// As on a GPU, with chunks so small that few bytes make many.
CallHook hook_of(const Way& way) {
  CallHook hook;
  Tuning& tuning = hook.tuning;
  tuning.prepares_host_memory = true;
  tuning.copy_threads = way.threads, tuning.transfer_chunks = way.chunks;
  tuning.transfer_chunk = chunk, tuning.least_chunked = 1, tuning.copied_by_thread = 1;
  return hook;
}

constexpr std::size_t lengths[] = {0, 1, chunk - 1, chunk, chunk + 1, 2 * chunk, 7 * chunk + 3, 40 * chunk - 1};

/// Writes and reads of all lengths, from and to places of any alignment, and several reads at once.
void check_transfers(Runtime& runtime) {
  constexpr std::size_t room = 16;
  unsigned seed = 0;
  for (const std::size_t length : lengths) {
    CAPTURE(length);
    const std::vector<unsigned char> given = random_bytes(length + room, ++seed);
    const std::size_t shift = seed % room;
    const auto buffer = runtime.allocate<cl_uchar>("bytes", length + room);
    runtime.fill<cl_uchar>(buffer, 0x11, length + room);
    runtime.write(buffer, given.data() + shift, length, 5);
    std::vector<unsigned char> found(length + 2 * room, 0xee);
    runtime.read(buffer, found.data() + shift, length + 10);
    const bool same = std::equal(given.begin() + static_cast<std::ptrdiff_t>(shift),
                                 given.begin() + static_cast<std::ptrdiff_t>(shift + length),
                                 found.begin() + static_cast<std::ptrdiff_t>(shift + 5));
    CHECK(same);
    for (std::size_t i = 0; i < found.size(); ++i)
      if (i < shift || i >= shift + length + 10)
        REQUIRE(found[i] == 0xee);
      else if (i < shift + 5 || i >= shift + 5 + length)
        REQUIRE(found[i] == 0x11);
  }
  std::vector<std::vector<unsigned char>> given, found;
  std::vector<Buffer<cl_uchar>> buffers;
  std::vector<HostRead> reads;
  for (const std::size_t length : lengths) {
    given.push_back(random_bytes(length, ++seed));
    found.emplace_back(length);
    buffers.push_back(runtime.upload("bytes", given.back()));
  }
  for (std::size_t i = 1; i < given.size(); ++i)  // the first is empty
    reads.push_back({buffers[i].handle(), found[i].data(), found[i].size()});
  runtime.read_all(reads);
  CHECK(found == given);
}

}  // namespace

TEST_CASE("large transfers bring every byte to its place, and none elsewhere") {
  for (const cl::Device& device : every_device())
    for (const Way& way : ways) {
      CAPTURE(way.threads);
      CAPTURE(way.chunks);
      Runtime runtime(device, hook_of(way));
      runtime.use_transfer_chunks();
      check_transfers(runtime);
      runtime.release_transfer_chunks();
      check_transfers(runtime);
    }
}

TEST_CASE("a transfer that fails anywhere ends, leaves the caller's memory alone, and harms none after it") {
  const char* const calls[] = {"clEnqueueWriteBuffer", "clEnqueueReadBuffer", "clWaitForEvents", "clFlush"};
  for (const Way& way : ways) {
    CallHook hook = hook_of(way);
    int left = -1;
    hook.before = [&](const char* call, const char*) -> cl_int {
      const bool counted =
          std::any_of(std::begin(calls), std::end(calls), [&](const char* c) { return c == std::string(call); });
      return counted && left-- == 0 ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
    };
    Runtime runtime(app_device(), hook);
    runtime.use_transfer_chunks();
    const std::size_t length = 9 * chunk + 7;
    const std::vector<unsigned char> given = random_bytes(length, 1);
    const auto buffer = runtime.allocate<cl_uchar>("bytes", length);
    const auto make_all_fail = [&](auto&& transfer) {
      int failed = 0;
      for (int k = 0;; ++k, ++failed) {
        left = k;
        try {
          transfer();
          left = -1;
          return failed;
        } catch (const Error& error) {
          left = -1;
          REQUIRE(error.opencl_code() == CL_OUT_OF_RESOURCES);
        }
        check_transfers(runtime);
      }
    };
    CHECK(make_all_fail([&] {
            std::vector<unsigned char> gone = given;  // given back before the next transfer
            try {
              runtime.write(buffer, gone.data(), length);
            } catch (...) {
              std::fill(gone.begin(), gone.end(), static_cast<unsigned char>(0));
              throw;
            }
          }) >= 10);
    CHECK(make_all_fail([&] {
            std::vector<unsigned char> found(length);
            try {
              runtime.read(buffer, found.data(), length);
            } catch (...) {
              std::fill(found.begin(), found.end(), static_cast<unsigned char>(0xee));
              check_transfers(runtime);
              const bool kept = std::all_of(found.begin(), found.end(), [](unsigned char b) { return b == 0xee; });
              CHECK(kept);
              throw;
            }
            CHECK(found == given);
          }) >= 20);
  }
}

TEST_CASE("without memory of the driver's own transfers are as before, and the log says so once") {
  for (const char* refused : {"clCreateBuffer", "clEnqueueMapBuffer"}) {
    CallHook hook = hook_of(ways[3]);
    hook.before = [refused](const char* call, const char* detail) -> cl_int {
      const bool refuse = std::string(detail) == "host memory" && std::string(call) == refused;
      return refuse ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS;
    };
    int told = 0;
    Runtime runtime(cl::Context(), app_device(), hook, [&](int, const char* message) {
      told += std::string(message).find("no pinned host memory") != std::string::npos;
    });
    runtime.use_transfer_chunks();
    check_transfers(runtime);
    CHECK(told == 1);
  }
}

TEST_CASE("a solver keeps its chunks until it is trimmed; one on the application's queue has none") {
  int made = 0;
  CallHook hook = hook_of({3, 4});
  hook.before = [&](const char* call, const char* detail) -> cl_int {
    made += std::string(call) == "clCreateBuffer" && std::string(detail) == "host memory";
    return CL_SUCCESS;
  };
  const Workload work = uniform(3000);
  Solver solver = hooked_solver(hook);
  for (int i = 0; i < 3; ++i) solver.triangulate(work.points);
  CHECK(made == 1);
  solver.trim();
  CHECK(made == 1);
  solver.triangulate(work.points);
  CHECK(made == 2);
  made = 0;
  const App app;
  Solver theirs = hooked_solver(hook, app.queue);
  theirs.triangulate(work.points);
  CHECK(made == 0);
}

#ifdef __linux__
TEST_CASE("the threads that copy are kept from call to call, and end when the solver is trimmed") {
  const Workload work = uniform(3000);
  CallHook hook = hook_of({3, 4});
  hook.tuning.works_here = false;
  Solver solver = hooked_solver(hook);
  for (int i = 0; i < 2; ++i) solver.triangulate(work.points);
  const std::size_t kept = threads_here();
  for (int i = 0; i < 5; ++i) solver.triangulate(work.points);
  CHECK(threads_here() <= kept + 1);  // a second helper, if the first was never late before
  const std::size_t before = threads_here();
  solver.trim();
  if (std::thread::hardware_concurrency() > 1)                   // one core has no helpers
    CHECK(comes_true([&] { return threads_here() < before; }));  // a thread is counted for some time after its end
}
#endif
