// SPDX-License-Identifier: Apache-2.0
// Devices whose work-items end their loops after 65535 rounds in all, and say nothing: Mesa's llvmpipe
// (docs/devices.md).
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

std::vector<cl_ulong> random_keys(std::size_t count) {
  Random random{17};
  std::vector<cl_ulong> keys(count);
  for (cl_ulong& key : keys) key = random.next() >> 2;
  return keys;
}

}  // namespace

TEST_CASE(
    "lanes whose loops end early scan and sort more than their work-groups may walk, and refuse what is too much") {
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
    MeshOnDevice made(runtime, all, 256);
    made.insert_all(true);
    made.history = freeze_all(runtime, made.vertices, made.mesh);
    const auto end = [&](const Point& p) {
      return std::uint32_t(std::find(made.points.begin(), made.points.end(), p) - made.points.begin());
    };
    Primitives primitives(runtime);
    made.counters.zero();
    const std::vector<Constraint> constraint = {{end(all.front()), end(all.back())}};
    const runtime::Buffer<cl_uint2> staged = stage(runtime, constraint);
    Cleaner cleaner(runtime, primitives, made.vertices, staged, made.n());
    const auto clean = [&] { return cleaner.clean(made.walked(), {}, made.counters).pieces.count; };
    if (runtime.kind() == DeviceKind::lanes)
      CHECK_THROWS_WITH_AS(clean(), "clean: a walk along a constraint left the mesh", Error);
    else
      CHECK(clean() == all.size() - 1);
  }
}
