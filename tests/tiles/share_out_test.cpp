// SPDX-License-Identifier: Apache-2.0
// Which constraints are no tile's, and which are a tile's: as devices find it, block by block, and as the host does.
#include "tiles/share_out.hpp"
#include <algorithm>

#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "tiles/spiller.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;
using tiles::OpenConstraint;
using tiles::Role;

namespace {

constexpr std::size_t tiles_wanted = 5, small_block = 700;

/// A problem on its grid, as the devices of a pool find it.
struct Given {
  Given(DevicePool& pool, const Workload& work)
      : points(work.points),
        constraints(work.constraints),
        staged(pool, Points(points), tiles_wanted),
        input{{Points(points), 0, {}, points.size()}, {}, {}, {constraints, 0, {}, constraints.size(), {}}, {}} {
    tiles::Team alone;
    Survey surveyed;
    input.chosen = staged.choose({}, surveyed, 0, alone);
    input.box = tiles::box_of(input.chosen, surveyed);
    cuts = tiles::even_cuts(input, tiles_wanted, alone);
  }
  std::vector<Point> points;
  std::vector<Constraint> constraints;
  tiles::Staged staged;
  tiles::GridInput input;
  tiles::Cuts cuts{{}};
};

void check_same(const std::vector<OpenConstraint>& found, const std::vector<OpenConstraint>& expected) {
  REQUIRE(found.size() == expected.size());
  bool same = true;
  for (std::size_t i = 0; i < found.size(); ++i)
    same = same && found[i].number == expected[i].number && found[i].ends == expected[i].ends &&
           found[i].points == expected[i].points;
  CHECK(same);
}

std::vector<Role> some_roles(std::size_t count) {
  std::vector<Role> roles(count, Role::any);
  for (std::size_t c = 0; c < count; ++c)
    if (c % 7 == 3) roles[c] = c % 2 == 0 ? Role::wide : Role::out;
  return roles;
}

std::vector<OpenConstraint> open_of(DevicePool& pool, Given& given, const std::vector<Role>& roles,
                                    std::size_t of_block) {
  tiles::StagedConstraints constraints(pool, given.staged, given.input, roles, tiles_wanted, of_block);
  return tiles::find_open(pool, given.staged, constraints, given.input, given.cuts, roles);
}

/// Room for the vertices of the input, and for those of a tile.
std::uint64_t enough(const Workload& work) {
  return forest_bytes(1, work.points.size() / tiles_wanted, work.constraints.size() / tiles_wanted) +
         16 * work.points.size() + 8 * work.constraints.size();
}

std::vector<DevicePool::Member> two(const runtime::CallHook& one, const runtime::CallHook& other) {
  return {{cl::Context(), app_device(), one}, {cl::Context(), app_device(), other}};
}

}  // namespace

TEST_CASE("devices find the open constraints that the host finds, whatever stays on them") {
  for (const char* name : {"letters", "spiral", "uniform"}) {
    CAPTURE(name);
    const Workload work = workload(name, 6000);
    for (const bool has_room : {true, false}) {
      CAPTURE(has_room);
      runtime::CallHook hook;
      if (!has_room) hook.tuning.memory_bytes = enough(work) / 2 * 4 / 3;  // of which a pool takes three quarters
      DevicePool pool(two(hook, hook), {}, {});
      Given given(pool, work);
      CHECK(given.staged.keeps(0) == has_room);
      for (const auto& roles : {std::vector<Role>(), some_roles(work.constraints.size())})
        for (const std::size_t of_block : {small_block, Tuning::most_constraints_of_block})
          check_same(open_of(pool, given, roles, of_block), tiles::partition(given.input, given.cuts, roles).open);
    }
  }
}

TEST_CASE("the sample of constraints says about how many a tile has") {
  DevicePool pool(two({}, {}), {}, {});
  for (const std::size_t n : {3000, 60000}) {
    CAPTURE(n);
    const Workload work = workload("spiral", n);
    Given given(pool, work);
    const tiles::Partition expected = tiles::partition(given.input, given.cuts, {});
    const tiles::Partition made = tiles::partition_open(given.input, given.cuts, {}, expected.open,
                                                        tiles::expected_constraints(given.input, given.cuts));
    double all = 0;
    for (std::size_t t = 0; t < tiles_wanted; ++t) {
      const auto exact = static_cast<double>(expected.tiles[t].constraints.size());
      CHECK(std::abs(static_cast<double>(made.tiles[t].expected) - exact) <=
            static_cast<double>(expected.open.size()) +
                static_cast<double>(work.constraints.size()) / (4.0 * tiles_wanted) + 1);
      CHECK(made.tiles[t].passages.size() == expected.tiles[t].passages.size());
      CHECK(made.tiles[t].foreign.size() == expected.tiles[t].foreign.size());
      CHECK(made.tiles[t].open_ends == expected.tiles[t].open_ends);
      all += static_cast<double>(made.tiles[t].expected);
    }
    CHECK(all <= 1.25 * static_cast<double>(work.constraints.size()));
  }
}

TEST_CASE("constraints of several blocks are the tiles', with and without room for them, and bytes are the same") {
  const Workload work = workload("spiral", 80000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  for (const double room : {1.5, 0.99}) {
    CAPTURE(room);
    runtime::CallHook hook;
    hook.tuning.memory_bytes = static_cast<std::uint64_t>(room * static_cast<double>(enough(work))) / 3 * 4;
    DevicePool pool(two(hook, hook), {}, {});
    REQUIRE(pool.least_capacity() / Tuning::part_of_constraint_block < work.constraints.size() / 2);
    Options options;
    options.tiles = tiles_wanted;
    expected.check(tiles::triangulate(pool, batch.view(), options));
  }
}

TEST_CASE("a device that fails at its k-th OpenCL call while constraints are shared out changes nothing") {
  const Workload work = workload("letters", 3000);
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  constexpr std::uint64_t never = std::uint64_t{1} << 40;
  std::uint64_t lost = 0, kept = 0;
  for (const cl_int code : {CL_INVALID_COMMAND_QUEUE, CL_OUT_OF_RESOURCES}) {
    std::uint64_t all = 1;
    for (std::uint64_t k = 0; k <= all; k += std::max<std::uint64_t>(1, all / 24)) {
      *calls = 0;  // so that it does not fail before
      DevicePool pool(two(failing(calls, never, false, code), {}), {}, {});
      Given given(pool, work);
      const std::vector<OpenConstraint> expected = tiles::partition(given.input, given.cuts, {}).open;
      *calls = k == 0 ? 0 : never - k;
      check_same(open_of(pool, given, {}, small_block), expected);
      if (k == 0) all = std::max<std::uint64_t>(*calls, 1);
      ++(pool.report(0).lost ? lost : kept);
    }
  }
  CHECK(lost > 0);
  CHECK(kept > 0);
}

TEST_CASE(
    "where there is no room to look at a block of constraints, parts of it are looked at, and no device is lost") {
  const Workload work = workload("letters", 60000);
  constexpr std::uint64_t memory = 64u << 20;
  for (const bool keeps : {true, false})
    for (const std::uint64_t half_megabytes : {keeps ? 3 : 5, 4}) {
      const std::uint64_t left = half_megabytes << 19;
      CAPTURE(keeps);
      CAPTURE(left);
      runtime::CallHook hook;
      hook.tuning.memory_bytes = memory;
      hook.tuning.fresh_buffers = true;
      DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
      Given given(pool, work);
      if (!keeps) given.staged.leave(0);
      runtime::Buffer<cl_uchar> held;
      pool.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) {
        const std::uint64_t maxima = 16 * lent.runtime.row_groups_of(work.points.size());
        held = lent.runtime.allocate<cl_uchar>("held", memory - left - maxima - lent.runtime.meter().held);
      });
      check_same(open_of(pool, given, {}, Tuning::most_constraints_of_block),
                 tiles::partition(given.input, given.cuts, {}).open);
      CHECK(!pool.report(0).lost);
      CHECK(given.staged.keeps(0) == keeps);
    }
}

TEST_CASE("where there is no room for any part beside the vertices, these leave, and no device is lost") {
  const Workload work = workload("letters", 120000);
  constexpr std::uint64_t memory = 64u << 20;  // of vertices a chunk has 98,304, and their codes take 12 bytes each
  runtime::CallHook hook;
  hook.tuning.memory_bytes = memory;
  hook.tuning.fresh_buffers = true;
  DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
  Given given(pool, work);
  REQUIRE(given.staged.of_chunk() < work.points.size());
  runtime::Buffer<cl_uchar> held;
  pool.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) {
    const std::uint64_t codes = 12 * given.staged.of_chunk(),
                        maxima = 16 * lent.runtime.row_groups_of(given.staged.of_chunk());
    held = lent.runtime.allocate<cl_uchar>(
        "held", memory - codes - maxima + (std::uint64_t{1} << 17) - lent.runtime.meter().held);
  });
  check_same(open_of(pool, given, {}, Tuning::most_constraints_of_block),
             tiles::partition(given.input, given.cuts, {}).open);
  CHECK(!pool.report(0).lost);
  CHECK(!given.staged.keeps(0));
}

TEST_CASE("when constraints are shared out again, the tiles of the round before have left the devices") {
  const Workload work = random_crossing(4000, 1 << 20, 60, 4);
  const RaggedBatch batch({work});
  const auto first = std::make_shared<runtime::Runtime*>(nullptr);
  const auto in_use = std::make_shared<std::vector<std::uint64_t>>();
  runtime::CallHook hook;
  hook.before = [=](const char* call, const char* kernel) {
    if (*first && std::string(call) == "clEnqueueNDRangeKernel" && std::string(kernel) == "share_open")
      in_use->push_back((*first)->meter().now);
    return CL_SUCCESS;
  };
  DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
  pool.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) { *first = &lent.runtime; });
  for (const Crossing policy : {Crossing::drop, Crossing::split}) {
    Options options;
    options.crossing = policy;
    const Singles expected({work}, options);
    options.tiles = tiles_wanted;
    in_use->clear();
    expected.check(tiles::triangulate(pool, batch.view(), options));
    REQUIRE(in_use->size() > 1);
    // Under split the last round has added vertices, and links.
    for (std::size_t i = 1; i + (policy == Crossing::split ? 1 : 0) < in_use->size(); ++i)
      CHECK(in_use->at(i) <= in_use->at(0));
  }
}

TEST_CASE("before a tile is made, what is to stay on the device and is not there yet counts as well") {
  const Workload work = workload("letters", 60000);
  runtime::CallHook hook;
  hook.tuning.memory_bytes = 2 * enough(work);
  DevicePool pool(two(hook, hook), {}, {});
  Given given(pool, work);
  const std::vector<Role> roles;
  tiles::StagedConstraints constraints(pool, given.staged, given.input, roles, tiles_wanted);
  tiles::ResultRoom room(pool, work.points.size(), work.constraints.size());
  tiles::Spiller spiller(pool, given.staged, room, {0, tiles_wanted});
  spiller.expect(2);
  const std::uint64_t blocks = 8 * work.constraints.size();
  pool.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) {
    if (lent.device != 0) return;
    REQUIRE(constraints.keeps(0));
    CHECK(constraints.bytes_to_come(0) == blocks);
    CHECK(given.staged.bytes_to_come(0) == 0);
    std::uint64_t n = 1;  // the most vertices of a tile that has room beside half of the blocks
    while (lent.runtime.meter().now + forest_bytes(1, n + 100, 0) + blocks / 2 <= lent.capacity) n += 100;
    spiller.make_room(lent, n / 2, 0, &constraints);
    CHECK(constraints.keeps(0));
    spiller.make_room(lent, n, 0, &constraints);
    CHECK(!constraints.keeps(0));
    CHECK(constraints.bytes_to_come(0) == 0);
    CHECK(given.staged.keeps(0));
  });
}

namespace {

/// Pairs of vertices in rows, with constraints that take turns between left and right; the last two cross.
Workload in_turn(std::uint32_t count) {
  Workload work;
  const std::uint32_t width = 200;
  const auto add = [&](Point a, Point b) {
    work.points.push_back(a), work.points.push_back(b);
    const auto last = static_cast<std::uint32_t>(work.points.size() - 1);
    work.constraints.push_back({last - 1, last});
  };
  for (std::uint32_t c = 0; c < count; ++c) {
    const std::uint32_t place = c / 2, half = width / 2;
    const double x = 3.0 * (place % half + (c % 2) * half), y = place / half;
    add({x, y}, {x + 1, y});
  }
  add({1.25, 0.25}, {1.75, 0.75});
  add({1.25, 0.75}, {1.75, 0.25});
  return work;
}

}  // namespace

TEST_CASE("the sample of constraints is right where they take turns between tiles") {
  DevicePool pool(two({}, {}), {}, {});
  const Workload work = in_turn(1u << 15);
  Given given(pool, work);
  const tiles::Partition expected = tiles::partition(given.input, given.cuts, {});
  const tiles::Partition made = tiles::partition_open(given.input, given.cuts, {}, expected.open,
                                                      tiles::expected_constraints(given.input, given.cuts));
  for (std::size_t t = 0; t < tiles_wanted; ++t) {
    const auto exact = static_cast<double>(expected.tiles[t].constraints.size());
    CHECK(std::abs(static_cast<double>(made.tiles[t].expected) - exact) <=
          static_cast<double>(work.constraints.size()) / (4.0 * tiles_wanted) + 1);
  }
}

TEST_CASE("constraints that have both ends nowhere in one tile are none's in the sample") {
  DevicePool pool(two({}, {}), {}, {});
  Workload work = uniform(20000);
  for (std::uint32_t i = 0; i < 4000; ++i) work.constraints.push_back({i, i + 1});  // across all of the square
  Given given(pool, work);
  const tiles::Partition exact = tiles::partition(given.input, given.cuts, {});
  std::uint64_t own = 0, all = 0;
  const tiles::Partition made = tiles::partition_open(given.input, given.cuts, {}, exact.open,
                                                      tiles::expected_constraints(given.input, given.cuts));
  for (std::size_t t = 0; t < tiles_wanted; ++t)
    own += exact.tiles[t].constraints.size(), all += made.tiles[t].expected;
  CHECK(all < own + 1000);
}

TEST_CASE("no tile is refused because of what is expected of its constraints") {
  const Workload work = workload("spiral", 80000);
  const RaggedBatch batch({work});
  runtime::CallHook hook;
  const std::uint64_t n = work.points.size() / tiles_wanted, m = work.constraints.size() / tiles_wanted;
  hook.tuning.memory_bytes = forest_bytes(1, n, m) / 100 * 98 / 3 * 4;
  DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
  REQUIRE(forest_bytes(1, n, m) > pool.capacity());
  REQUIRE(forest_bytes(1, n, 0) < pool.capacity());
  Options options;
  options.tiles = tiles_wanted;
  Singles({work}).check(tiles::triangulate(pool, batch.view(), options));
}

TEST_CASE("under split the numbers of constraints go to a device some at a time") {
  const Workload work = in_turn(60000);
  const RaggedBatch batch({work});
  Options options;
  options.crossing = Crossing::split;
  const Singles expected({work}, options);
  options.tiles = tiles_wanted;
  const auto largest = std::make_shared<std::uint64_t>(0);
  const auto times = std::make_shared<int>(0);
  runtime::CallHook hook;
  hook.tuning.fresh_buffers = true;
  DevicePool pool(two(hook, hook),
                  [=](int, const char* message) {
                    unsigned long long bytes = 0;
                    char name[64] = "";
                    if (std::sscanf(message, "took %llu bytes of device memory for %63[a-z ],", &bytes, name) == 2 &&
                        std::string(name).find("numbers ") == 0)
                      *largest = std::max<std::uint64_t>(*largest, bytes), ++*times;
                  },
                  {});
  expected.check(tiles::triangulate(pool, batch.view(), options));
  CHECK(*times > 0);
  CHECK(*largest < 4 * work.constraints.size());
}

TEST_CASE("a device that is lent reads as often as a solver does, and as a pool's again afterwards") {
  const Workload work = workload("uniform", 3000);
  runtime::CallHook hook;
  hook.tuning.kind = DeviceKind::gpu;
  DevicePool pool({{cl::Context(), app_device(), hook}}, {}, {});
  runtime::Runtime* runtime = nullptr;
  const auto check_lent = [&](DevicePool::Lent& lent) {
    runtime = &lent.runtime;
    CHECK(lent.runtime.tuning().rounds_per_read == Tuning().rounds_per_read);
  };
  pool.on_each(DevicePool::Who::all, check_lent);
  REQUIRE(runtime);
  CHECK(runtime->tuning().rounds_per_read == Tuning::gpu_rounds_per_read);
  const RaggedBatch batch({work});
  pool.make_each(batch.view(), {}, DevicePool::Who::all, [&](DevicePool::Lent& lent, std::uint32_t) {
    check_lent(lent);
    return ForestResult();
  });
  CHECK(runtime->tuning().rounds_per_read == Tuning::gpu_rounds_per_read);
}

TEST_CASE("the first device makes what is for one, every time, and the next one when it is lost") {
  const auto fails = std::make_shared<std::atomic<bool>>(false);
  runtime::CallHook weak = healthy();
  weak.before = [fails](const char*, const char*) -> cl_int { return *fails ? CL_DEVICE_NOT_AVAILABLE : CL_SUCCESS; };
  DevicePool pool({{cl::Context(), app_device(), weak}, {cl::Context(), app_device(), healthy()}}, {}, {});
  const RaggedBatch batch({uniform(10), uniform(10), uniform(10)});
  std::vector<std::size_t> devices;
  const DevicePool::MakeOne note = [&](DevicePool::Lent& lent, std::uint32_t) {
    devices.push_back(lent.device);
    lent.runtime.finish();
    return ForestResult();
  };
  CHECK(pool.count_of(DevicePool::Who::all) == 2);
  CHECK(pool.count_of(DevicePool::Who::first) == 1);
  for (int call = 0; call < 3; ++call) pool.make_each(batch.view(), {}, DevicePool::Who::first, note);
  CHECK(devices == std::vector<std::size_t>(9, 0));
  *fails = true;
  CHECK_THROWS(pool.make_each(batch.view(), {}, DevicePool::Who::first, note));
  devices.clear();
  pool.make_each(batch.view(), {}, DevicePool::Who::first, note);
  CHECK(devices == std::vector<std::size_t>(3, 1));
  CHECK(pool.count_of(DevicePool::Who::all) == 1);
}
