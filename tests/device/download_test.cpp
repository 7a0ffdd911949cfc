// SPDX-License-Identifier: Apache-2.0
// What runtimes that share a context read, and that they build programs once.
#include <doctest/doctest.h>

#include <map>
#include <numeric>

#include "opencl_app.hpp"

using namespace gcdt;
using namespace gcdt::runtime;
using namespace gcdt::test;

namespace {

constexpr std::size_t mebi = std::size_t{1} << 20;

/// A buffer whose every byte tells its place, read in parts to places of any alignment.
void check_reads(Runtime& runtime) {
  std::vector<cl_uint> words(mebi);
  std::iota(words.begin(), words.end(), 0u);
  const auto buffer = runtime.allocate<cl_uint>("words", words.size());
  runtime.write(buffer, words.data(), words.size());
  const auto* given = reinterpret_cast<const unsigned char*>(words.data());
  for (const std::size_t length : {std::size_t{1}, std::size_t{65535}, std::size_t{65536}, mebi - 1, mebi, mebi + 1,
                                   2 * mebi, 3 * mebi + mebi / 2 + 3})
    for (const std::size_t offset : {std::size_t{0}, std::size_t{12}, mebi / 3}) {
      CAPTURE(length);
      CAPTURE(offset);
      std::vector<unsigned char> found(length + 32, 0xee);
      unsigned char* to = found.data() + 16 + offset % 7;
      runtime.read_bytes(buffer.handle(), offset, to, length);
      const bool same = std::equal(to, to + length, given + offset);
      CHECK(same);
      CHECK(to[-1] == 0xee);
      CHECK(to[length] == 0xee);
    }
}

}  // namespace

TEST_CASE("runtimes that share a context read what is there") {
  Runtime first(cl::Context(), app_device(), {}, {});
  first.share_context();
  Runtime second(first, {}, {});
  second.share_context();
  CHECK(second.context()() == first.context()());
  check_reads(first);
  check_reads(second);
}

TEST_CASE("and so if the driver has no memory of its own for it, of which the log tells") {
  for (const char* refused : {"clCreateBuffer", "clEnqueueMapBuffer"}) {
    CallHook hook;
    hook.before = [refused](const char* call, const char* detail) -> cl_int {
      const bool refuse = std::string(detail) == "host memory" && std::string(call) == refused;
      return refuse ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS;
    };
    std::string told;
    Runtime runtime(cl::Context(), app_device(), hook, [&](int, const char* message) { told += message; });
    runtime.share_context();
    CHECK(told.find("no pinned host memory") != std::string::npos);
    check_reads(runtime);
  }
}

TEST_CASE("a read that failed leaves nothing behind in those after it") {
  int left = -1;
  CallHook hook;
  hook.before = [&](const char* call, const char*) -> cl_int {
    const std::string name = call;
    return (name == "clEnqueueReadBuffer" || name == "clWaitForEvents") && left-- == 0 ? CL_OUT_OF_RESOURCES
                                                                                       : CL_SUCCESS;
  };
  Runtime runtime(cl::Context(), app_device(), hook, {});
  runtime.share_context();
  const auto ones = runtime.allocate<cl_uint>("ones", mebi);
  runtime.fill<cl_uint>(ones, 1, mebi);
  std::vector<cl_uint> found(mebi);
  for (int k = 0; k < 8; ++k) {  // four chunks: a read and a wait each
    left = k;
    CHECK_THROWS_AS(runtime.read(ones, found.data(), mebi), Error);
    left = -1;
    check_reads(runtime);
  }
}

TEST_CASE("a program is built once for all that share a context") {
  std::map<std::string, int> built;
  CallHook hook;
  hook.before = [&](const char* call, const char* detail) {
    if (std::string(call) == "clBuildProgram") ++built[detail];
    return CL_SUCCESS;
  };
  Runtime first(cl::Context(), app_device(), hook, {});
  Runtime second(first, {}, {});
  for (Runtime* runtime : {&first, &second}) {
    const auto marks = runtime->allocate<cl_uint>("marks", 10);
    runtime->launch("primitives", "compact_indices", over(0), cl_uint{0}, marks, marks);
  }
  CHECK(!built.empty());
  for (const auto& [program, times] : built) {
    CAPTURE(program);
    CHECK(times == 1);
  }
}
