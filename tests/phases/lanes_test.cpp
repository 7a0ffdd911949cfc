// SPDX-License-Identifier: Apache-2.0
// Devices whose work-items may end their loops after 65535 rounds in all, and say nothing: Mesa's llvmpipe does, up to
// some version (docs/devices.md). The library minds all of them. Tests ask the device what it does.
#include <numeric>

#include "device_list.hpp"
#include "mesh_fixture.hpp"
#include "phases/clean.hpp"

using namespace fixture;
using runtime::Runtime;

namespace {

using Words = std::vector<cl_uint>;

// Before any test lists devices.
const std::vector<cl::Device> all_of_them = test::every_device();

constexpr char count_rounds[] = R"(
kernel void count_rounds(uint rounds, volatile global uint* done) {
  for (uint i = 0; i < rounds; ++i) *done = i + 1u;
}
)";

// Whether a loop of the device's ends before it has done its rounds.
bool ends_loops_early(const cl::Device& device) {
  constexpr cl_uint rounds = 70000;
  cl_uint done = 0;
  const cl::Context context(device);
  const cl::CommandQueue queue(context, device);
  cl::Program program(context, count_rounds);
  REQUIRE(program.build({device}, "-cl-std=CL1.2") == CL_SUCCESS);
  const cl::Buffer buffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof done, &done);
  cl::Kernel kernel(program, "count_rounds");
  REQUIRE(kernel.setArg(0, rounds) == CL_SUCCESS);
  REQUIRE(kernel.setArg(1, buffer) == CL_SUCCESS);
  REQUIRE(queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1)) == CL_SUCCESS);
  REQUIRE(queue.enqueueReadBuffer(buffer, CL_TRUE, 0, sizeof done, &done) == CL_SUCCESS);
  REQUIRE(done > 0);
  REQUIRE(done <= rounds);
  return done < rounds;
}

std::vector<cl_ulong> random_keys(std::size_t count) {
  Random random{17};
  std::vector<cl_ulong> keys(count);
  for (cl_ulong& key : keys) key = random.next() >> 2;
  return keys;
}

}  // namespace

TEST_CASE(
    "lanes, whose loops may end early, scan and sort more than their work-groups may walk, and refuse what is too "
    "much") {
  const auto lanes = std::find_if(all_of_them.begin(), all_of_them.end(), [](const cl::Device& device) {
    return runtime::kind_of(runtime::describe(device), {}) == DeviceKind::lanes;
  });
  REQUIRE_MESSAGE(lanes != all_of_them.end(), "this needs Mesa's llvmpipe (Debian and Ubuntu: mesa-opencl-icd)");
  Runtime runtime(*lanes);
  runtime.geometry().max_groups = 1;  // as if there were many elements
  Primitives primitives(runtime);
  constexpr std::size_t count = 300000;
  const std::vector<cl_ulong> keys = random_keys(count);
  Words values(count);
  std::iota(values.begin(), values.end(), 0u);
  auto key_buffer = runtime.allocate<cl_ulong>("keys", count);
  auto value_buffer = runtime.allocate<cl_uint>("values", count);
  const auto sums = runtime.allocate<cl_uint>("sums", count + 1);
  runtime.write(key_buffer, keys.data(), count);
  runtime.write(value_buffer, values.data(), count);
  primitives.exclusive_scan(value_buffer, sums, count);
  primitives.sort(key_buffer, value_buffer, count, 62);
  Words found(count), found_sums(count + 1), order = values;
  runtime.read(value_buffer, found.data(), count);
  runtime.read(sums, found_sums.data(), count + 1);
  std::sort(order.begin(), order.end(), [&](cl_uint a, cl_uint b) { return keys[a] < keys[b]; });
  CHECK(found == order);
  Words expected_sums(count + 1, 0);
  std::partial_sum(values.begin(), values.end(), expected_sums.begin() + 1);
  CHECK(found_sums == expected_sums);
  try {
    primitives.exclusive_scan(value_buffer, sums, std::size_t{1} << 29);
    FAIL("a scan of more than the loops of lanes can walk");
  } catch (const Error& error) {
    CHECK(error.status() == Status::device_failed);
    CHECK(std::string(error.what()).find("65535") != std::string::npos);
  }
}

TEST_CASE("a walk that meets more than its loop may have rounds fails where loops end early, and only there") {
  const std::vector<Point> all = make_points("collinear", 70000, 1);
  for (const cl::Device& device : all_of_them) {
    runtime::CallHook hook;
    hook.tuning.part_pool = 0;  // one work-item a constraint
    runtime::Runtime runtime(device, hook);
    CAPTURE(runtime.info().platform);
    CAPTURE(runtime.info().driver);
    const bool early = ends_loops_early(device);
    if (early)
      REQUIRE_MESSAGE(runtime.kind() == DeviceKind::lanes, "its loops end early, and the library does not mind");
    MeshOnDevice made(runtime, all, 256);
    made.insert_all(true);
    made.history = freeze_all(runtime, made.vertices, made.mesh, made.counters);
    const auto end = [&](const Point& p) {
      return std::uint32_t(std::find(made.points.begin(), made.points.end(), p) - made.points.begin());
    };
    Primitives primitives(runtime);
    made.counters.zero();
    const std::vector<Constraint> constraint = {{end(all.front()), end(all.back())}};
    const runtime::Buffer<cl_uint2> staged = stage(runtime, constraint);
    Cleaner cleaner(runtime, primitives, made.vertices, staged, made.n());
    const auto clean = [&] {
      return cleaner.clean(made.walked(), cleaner.keep(made.plan, {}), made.counters).pieces.count;
    };
    if (early)
      CHECK_THROWS_WITH_AS(clean(), "clean: a walk along a constraint left the mesh", Error);
    else
      CHECK(clean() == all.size() - 1);
  }
}
