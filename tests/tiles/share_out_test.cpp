// SPDX-License-Identifier: Apache-2.0
// Which constraints are no tile's, and which are a tile's: as devices find it, block by block, and as the host does.
#include "tiles/share_out.hpp"
#include "faulty_device.hpp"
#include "pool_cases.hpp"
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
    const tiles::Partition made = tiles::partition_open(given.input, given.cuts, {}, expected.open);
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
  std::uint64_t lost = 0, kept = 0, let_go = 0;
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
      if (!pool.report(0).lost && !given.staged.keeps(0)) ++let_go;
    }
  }
  CHECK(lost > 0);
  CHECK(kept > 0);
  CHECK(let_go > 0);
}
