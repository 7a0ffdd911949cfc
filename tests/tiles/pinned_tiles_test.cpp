// SPDX-License-Identifier: Apache-2.0
// Problems in tiles between arrays that are pinned: the same bytes, from where the input is and to where they stay.
#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::size_t large = 40000;  // vertices for which room is made

/// As on a GPU, of which a further worker's queue is lent.
runtime::CallHook prepared(runtime::CallHook hook = healthy()) {
  hook.tuning.workers = 2;
  hook.tuning.shares_context = hook.tuning.prepares_host_memory = true;
  hook.tuning.least_chunked = 1;
  return hook;
}

std::unique_ptr<DevicePool> pool_of_two(const runtime::CallHook& hook = prepared()) {
  auto pool = std::make_unique<DevicePool>(
      std::vector<DevicePool::Member>{{cl::Context(), app_device(), hook}, {cl::Context(), app_device(), hook}},
      runtime::Log(), Trace());
  pool->pin_results();
  return pool;
}

Options pinned_in_tiles(std::uint32_t tiles) {
  Options options;
  options.tiles = tiles;
  options.pinned = true;
  return options;
}

constexpr int arrays_of_mesh[] = {GCDT_TRIANGLES, GCDT_NEIGHBOURS,     GCDT_CONSTRAINED, GCDT_REPRESENTATIVES,
                                  GCDT_PIECES,    GCDT_SOURCE_OFFSETS, GCDT_SOURCES};

const HostArray& array_of(const PoolResult& made, int array) {
  return made.at(0).first->arrays[static_cast<std::size_t>(array)];
}

}  // namespace

TEST_CASE(
    "results in tiles lie in pinned memory, which serves the next call when they are gone, and outlives the pool") {
  const Workload work = workload("letters", large);
  const RaggedBatch batch({work});
  const Singles expected({work});
  auto pool = pool_of_two();
  REQUIRE(pool->result_memory());
  std::optional<PoolResult> made;
  std::vector<const unsigned char*> places;
  for (int call = 0; call < 3; ++call) {
    CAPTURE(call);
    made.reset();
    made = tiles::triangulate(*pool, batch.view(), pinned_in_tiles(2));
    expected.check(*made);
    for (const int array : arrays_of_mesh) {
      CAPTURE(array);
      const HostArray& host = array_of(*made, array);
      CHECK(pool->pinned().contains(host.bytes.get(), host.size));
      if (call == 0) places.push_back(host.bytes.get());
      CHECK(std::count(places.begin(), places.end(), host.bytes.get()) == 1);
    }
    CHECK(!pool->pinned().contains(work.points.data(), 1));  // no longer
  }
  const PoolResult second = tiles::triangulate(*pool, batch.view(), pinned_in_tiles(2));
  CHECK(array_of(second, GCDT_TRIANGLES).bytes.get() != array_of(*made, GCDT_TRIANGLES).bytes.get());
  pool.reset();
  expected.check(*made);
  expected.check(second);
}

TEST_CASE("the input is sent from where it lies if it is said to be pinned") {
  const Workload work = workload("letters", large);
  const RaggedBatch batch({work});
  const Singles expected({work});
  std::atomic<std::uint64_t> writes{0};
  runtime::CallHook hook = prepared();
  hook.tuning.transfer_chunk = 4096;
  hook.before = [&](const char* call, const char*) -> cl_int {
    writes += call == std::string("clEnqueueWriteBuffer");
    return CL_SUCCESS;
  };
  std::array<std::uint64_t, 2> counts{};
  for (const bool pinned : {false, true}) {
    const auto pool = pool_of_two(hook);
    Options options = pinned_in_tiles(2);
    options.pinned = pinned;
    writes = 0;
    expected.check(tiles::triangulate(*pool, batch.view(), options));
    counts[pinned] = writes;
  }
  const std::uint64_t chunks = 2 * (16 + 8) * large / 4096;  // of vertices and constraints, to each of two devices
  CHECK(counts[0] > counts[1] + chunks * 9 / 10);
}

TEST_CASE("pinned results are right whatever problems come, and where the driver has no such memory") {
  std::vector<Workload> problems = {
      workload("letters", large),         uniform(3000),     problem({}), workload("row", large),
      random_crossing(2000, 5000, 40, 4), uniform(2 * large)};
  const RaggedBatch batch(problems);
  for (const Crossing crossing : {Crossing::reject, Crossing::drop}) {
    Options options = pinned_in_tiles(3);
    options.crossing = crossing;
    Options alone;
    alone.crossing = crossing;
    const Singles expected(problems, alone);
    const auto pool = pool_of_two();
    for (int call = 0; call < 2; ++call) expected.check(tiles::triangulate(*pool, batch.view(), options));
  }
  runtime::CallHook without = prepared();
  without.before = [](const char* call, const char* detail) -> cl_int {
    return call == std::string("clEnqueueMapBuffer") && detail == std::string("host memory") ? CL_OUT_OF_RESOURCES
                                                                                             : CL_SUCCESS;
  };
  const RaggedBatch one({problems[0]});
  const auto pool = pool_of_two(without);
  const PoolResult made = tiles::triangulate(*pool, one.view(), pinned_in_tiles(2));
  Singles({problems[0]}).check(made);
  CHECK(!pool->pinned().contains(array_of(made, GCDT_TRIANGLES).bytes.get(), 1));
}

TEST_CASE("the interface takes both options on any device, of a pool and of a solver") {
  const Workload work = workload("letters", large);
  const Singles expected({work});
  Options options = pinned_in_tiles(2);
  {
    Pool pool(test_device(), {}, {}, 0, "", true);
    for (int call = 0; call < 2; ++call) expected.check(pool.triangulate(batch_of({work}), options));
    options.tiles = 0;
    expected.check(pool.triangulate(batch_of({work}), options));
  }
  Solver plain = hooked_solver(prepared());
  const Triangulation made = plain.triangulate(work.points, work.constraints, options);
  CHECK(difference(made, expected.meshes[0]) == "");
}
