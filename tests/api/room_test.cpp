// SPDX-License-Identifier: Apache-2.0
// Room for results in host memory that is made while the device works (gcdt_options.host_room).
#include <doctest/doctest.h>

#include <cstring>

#include "faulty_device.hpp"
#include "fresh_memory.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::size_t many = std::size_t{1} << 16;  // vertices that are worth a thread

runtime::CallHook preparing(bool prepares = true) {
  runtime::CallHook hook;
  hook.tuning.prepares_host_memory = prepares;
  hook.tuning.room_threads = 3;
  hook.tuning.least_chunked = 1 << 12, hook.tuning.transfer_chunk = 1 << 14, hook.tuning.copied_by_thread = 1 << 14;
  return hook;
}

/// Letters by even-odd; many vertices at few places; constraints that cross.
std::vector<std::pair<Workload, Options>> cases() {
  Options regions, even_odd, split;
  even_odd.domain = Domain::even_odd;
  regions.regions = true;
  split.crossing = Crossing::split;
  Workload few = uniform(100), crossing = uniform(many);
  for (std::size_t i = 0; i < many; ++i) few.points.push_back(few.points[i % 100]);
  crossing.constraints = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {8, 9}};
  return {{uniform(many), {}}, {uniform(many), regions}, {workload("letters", many), even_odd},
          {few, {}},           {crossing, split},        {uniform(300), {}}};
}

}  // namespace

TEST_CASE("results are the same with room and without, and are not kept in far too much of it") {
  Solver with = hooked_solver(preparing()), without = hooked_solver(preparing(false));
  for (const auto& [work, options] : cases()) {
    const Triangulation mesh = with.triangulate(work.points, work.constraints, options);
    CHECK(same_bytes(mesh, without.triangulate(work.points, work.constraints, options)));
    CHECK(same_bytes(mesh, with.solve(work.points, work.constraints, options).download()));
#define GCDT_ARRAY(number, name, ...) CHECK(mesh.name.capacity() <= 4 * mesh.name.size() + 3);
#include <gcdt/arrays.def>
  }
}

TEST_CASE("points are located the same with room and without") {
  Solver with = hooked_solver(preparing()), without = hooked_solver(preparing(false));
  const Workload work = workload("uniform", 500);
  const std::vector<Point> queries = uniform(many, 7).points;
  const Result there = with.solve(work.points), here = without.solve(work.points);
  std::vector<std::array<double, 3>> weights, expected;
  CHECK(there.locate(queries, &weights) == here.locate(queries, &expected));
  CHECK(weights == expected);
  CHECK(there.locate(queries) == here.locate(queries));
}

TEST_CASE("room is made for what a result will have, in the arrays themselves") {
  Triangulation to;
  const auto ranges = [&to](std::size_t n, std::size_t m, const Options& options) {
    to = {};
    return detail::room(to, n, m, options);
  };
  CHECK(ranges(1000, 1000, {}).empty());
  CHECK(to.triangles.empty());
  const auto has = [](const std::vector<gcdt_host_memory>& room, const void* memory, std::uint64_t bytes) {
    return std::any_of(room.begin(), room.end(),
                       [&](const gcdt_host_memory& r) { return r.memory == memory && r.bytes == bytes; });
  };
  const auto hull = ranges(many, 7, {});
  CHECK(hull.size() == 7);
  CHECK(has(hull, to.triangles.data(), 24 * many));
  CHECK(has(hull, to.neighbours.data(), 24 * many));
  CHECK(has(hull, to.constrained.data(), 2 * many));
  CHECK(has(hull, to.representative.data(), 4 * many));
  CHECK(has(hull, to.pieces.data(), 56));
  CHECK(has(hull, to.source_offsets.data(), 32));
  CHECK(has(hull, to.sources.data(), 28));
  CHECK(to.triangles.size() == 2 * many);
  Options options;
  options.domain = Domain::holes;
  const auto some = ranges(many, 0, options);
  CHECK(has(some, to.triangles.data(), 12 * many));
  CHECK(to.triangles.size() == 2 * many);
  CHECK(has(some, to.region.data(), 4 * many));
  CHECK(ranges(std::size_t{1} << 62, 0, {}).empty());  // no memory for it
}

TEST_CASE("pages are touched while the call runs, on devices that want it and for many vertices, and not after") {
  struct Call {
    bool prepares;
    std::size_t vertices;
    bool touches;
  };
  for (const Call call : {Call{true, many, true}, Call{false, many, false}, Call{true, 1000, false}}) {
    CAPTURE(call.vertices);
    Solver solver = hooked_solver(preparing(call.prepares));
    const Fresh memory(std::size_t{1} << 20);
    const std::vector<bool> all(memory.touched().size(), true), none(memory.touched().size(), false);
    const gcdt_host_memory room = {memory.first, memory.bytes};
    struct Seen {
      const Fresh& memory;
      bool wanted, touched;
    } seen = {memory, call.touches, false};
    gcdt_options options = GCDT_OPTIONS_INIT;
    options.host_room = &room, options.host_room_count = 1;
    options.progress_user = &seen;
    options.progress = [](void* user, const char*, double) -> std::int32_t {
      auto& asked = *static_cast<Seen*>(user);
      const std::vector<bool> every(asked.memory.touched().size(), true);
      if (asked.wanted && !asked.touched) asked.touched = comes_true([&] { return asked.memory.touched() == every; });
      return 1;
    };
    const Workload work = uniform(call.vertices);
    const gcdt_input input = detail::input(work.points, {});
    gcdt_result* made = nullptr;
    REQUIRE(gcdt_triangulate(solver.handle(), &input, &options, &made) == GCDT_OK);
    gcdt_result_release(made);
    CHECK(seen.touched == call.touches);
    CHECK(memory.touched() == (call.touches ? all : none));
  }
}

TEST_CASE("a call that fails or is cancelled leaves room alone from then on") {
  Solver solver = hooked_solver(preparing());
  std::vector<unsigned char> memory(std::size_t{64} << 20);
  const gcdt_host_memory room = {memory.data(), memory.size()};
  Workload work = uniform(many);
  work.constraints = {{0, 1}, {2, 1000000}};
  for (const bool cancelled : {false, true}) {
    gcdt_options options = GCDT_OPTIONS_INIT;
    options.host_room = &room, options.host_room_count = 1;
    if (cancelled) options.progress = [](void*, const char*, double) -> std::int32_t { return 0; };
    const gcdt_input input = detail::input(work.points, work.constraints);
    gcdt_result* made = nullptr;
    CHECK(gcdt_triangulate(solver.handle(), &input, &options, &made) ==
          (cancelled ? GCDT_ERROR_CANCELLED : GCDT_ERROR_INDEX_OUT_OF_RANGE));
    std::fill(memory.begin(), memory.end(), static_cast<unsigned char>(0xee));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const bool kept = std::all_of(memory.begin(), memory.end(), [](unsigned char b) { return b == 0xee; });
    CHECK(kept);
  }
  CHECK(solver.triangulate(work.points).triangles.size() > many);
}
