// SPDX-License-Identifier: Apache-2.0
// Constraints that are cleaned and enforced ahead of the others (phases/ahead.hpp): the result is the same, with less
// to walk, and what crosses is found as ever.
#include "phases/ahead.hpp"
#include "called.hpp"
#include "staged.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::uint32_t always = 0, never = 0xFFFFFFFFu;

Called call_ahead(runtime::Runtime& runtime, const Workload& work, std::optional<std::uint32_t> crossings_ahead,
                  Crossing policy = Crossing::reject) {
  Tuning tuning = runtime.tuning();
  tuning.crossings_ahead = crossings_ahead;
  tuning.here_vertices = 0;  // where constraints are taken one after the other
  return call(runtime, work, tuning, policy);
}

/// Parallel lines, and one more from the lower end of line `from` to the upper end of line `to`.
Workload lines_and_one(std::uint32_t lines, std::uint32_t from, std::uint32_t to) {
  Workload work;
  for (std::uint32_t i = 0; i < lines; ++i) {
    work.points.push_back({64.0 * i, double(i % 3)});
    work.points.push_back({64.0 * i, 4000.0 + i % 5});
    work.constraints.push_back({2 * i, 2 * i + 1});
    work.points.push_back({64.0 * i + 31, 100.0 + 97 * (i * 7 % 40)});  // for the lines to cross faces
  }
  work.constraints.push_back({2 * from, 2 * to + 1});
  return work;
}

/// Some pay to be taken ahead.
struct Staged : fixture::Staged {
  Staged(runtime::Runtime& on, const std::vector<fixture::Point>& given, const std::vector<Constraint>& pairs)
      : fixture::Staged(on, given, pairs) {
    plan.crossings_ahead = 1, plan.step_ahead = 8;
  }
};

/// Rays from the first vertex to others far away, a lattice between them, and vertices that lie on rays.
void make_rays(std::vector<fixture::Point>& points, std::vector<Constraint>& rays) {
  constexpr std::int64_t side = 60, ends = 240, unit = 1 << 18;  // lengths count as parts of 2^31
  points.push_back({0, 0});
  for (std::int64_t i = 0; i < ends; ++i) {
    points.push_back({4000 * unit, (16 * i + 5) * unit});
    rays.push_back({0, std::uint32_t(points.size()) - 1});
    if (i % 10 == 3) points.push_back({2000 * unit, (16 * i + 5) * unit / 2});
  }
  for (std::int64_t x = 1; x < side; ++x)
    for (std::int64_t y = 0; y < side; ++y) points.push_back({(64 * x + y % 3) * unit, (64 * y + x % 5) * unit});
}

/// Long lines side by side, each at most a few vertices from being an edge.
void make_lines(std::vector<fixture::Point>& points, std::vector<Constraint>& lines) {
  for (std::uint32_t i = 0; i < 600; ++i) {
    points.push_back({i << 18, i % 3});
    points.push_back({i << 18, (1 << 30) - i % 5});
    lines.push_back({2 * i, 2 * i + 1});
  }
}

}  // namespace

TEST_CASE("those ahead are every so many-th, and the others go through few faces after them") {
  std::vector<fixture::Point> points;
  std::vector<Constraint> rays;
  make_rays(points, rays);
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    runtime::Runtime& runtime = *device.runtime;
    Staged made(runtime, points, rays);
    KeptConstraints kept = made.cleaner.keep(made.plan, {});
    REQUIRE(may_pay_in_turn(made.plan, sizes_of(made.vertices), kept.count, kept.crossings));
    const CleanResult at_once = made.cleaner.clean(made.walked(), kept, made.counters);
    CHECK(at_once.hits > 0);

    CleanResult some = clean_ahead(made.cleaner, made.walked(), kept, made.counters);
    std::vector<Constraint> chosen;
    const std::vector<cl_uint> list = words_of(runtime, kept.list, kept.count);
    for (std::size_t i = 0; i < list.size(); i += 8) chosen.push_back(made.constraints[list[i]]);
    CHECK(fixture::read_pieces(runtime, some.pieces) == fixture::expected_pieces(made.points, chosen));

    const ConstrainResult ahead = enforce_ahead(runtime, made.primitives, made.plan, made.vertices, made.mesh,
                                                made.history, some.pieces, kept, made.counters);
    REQUIRE(ahead.failed == 0);
    CHECK(fixture::marked_edges(made.now()) == fixture::expected_pieces(made.points, chosen));
    CHECK(kept.crossings < at_once.pieces.walked.crossed / 8);

    CleanResult rest = made.cleaner.clean(made.walked(), kept, made.counters);
    CHECK(rest.hits == at_once.hits);
    CHECK(3 * rest.pieces.walked.crossed < at_once.pieces.walked.crossed);
    const auto same = [&](const auto& a, const auto& b, cl_uint count) {
      return words_of(runtime, a, count) == words_of(runtime, b, count);
    };
    REQUIRE(rest.pieces.count == at_once.pieces.count);
    CHECK(same(rest.pieces.ends, at_once.pieces.ends, rest.pieces.count));
    CHECK(same(rest.pieces.source_offsets, at_once.pieces.source_offsets, rest.pieces.count + 1));
    CHECK(same(rest.pieces.sources, at_once.pieces.sources, rest.pieces.source_count));

    ConstrainResult all = constrain(runtime, made.primitives, made.plan, made.vertices, made.mesh, made.history,
                                    rest.pieces, made.counters);
    REQUIRE(all.failed == 0);
    CHECK(fixture::marked_edges(made.now()) == fixture::expected_pieces(made.points, made.constraints));
    add_ahead(ahead, all);
    CHECK(all.existing_edges + all.walked == rest.pieces.count);
  }
}

TEST_CASE("long constraints that cross little are taken at once") {
  std::vector<fixture::Point> points;
  std::vector<Constraint> lines;
  make_lines(points, lines);
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    Staged made(*device.runtime, points, lines);
    const KeptConstraints kept = made.cleaner.keep(made.plan, {});
    CHECK(may_pay_in_turn(made.plan, sizes_of(made.vertices), kept.count, kept.crossings));
    CHECK(clean_ahead(made.cleaner, made.walked(), kept, made.counters).pieces.count == 0);
    made.plan.crossings_ahead = UINT32_MAX;
    CHECK(!may_pay_in_turn(made.plan, sizes_of(made.vertices), kept.count, kept.crossings));
  }
}

TEST_CASE("the result is the same, and pieces cross fewer faces") {
  for (Treated& device : devices_as_all_kinds()) {
    runtime::Runtime& runtime = *device.runtime;
    CAPTURE(device.name);
    const std::size_t n = runtime.kind() == DeviceKind::lanes ? 1000 : 4000;
    // sunray, hub: spokes of one vertex, whose first edges make it one of many faces.
    for (const char* name : {"sunray", "hub", "fan", "letters", "spiral", "star"}) {
      CAPTURE(name);
      const Workload work = workload(name, n);
      const Called at_once = call_ahead(runtime, work, never), in_turn = call_ahead(runtime, work, always);
      CHECK(at_once.seen.error == "");
      CHECK(at_once.seen == in_turn.seen);
      const Statistics &a = at_once.statistics, &b = in_turn.statistics;
      CHECK(b.cases.existing_edges + b.cases.pieces_walked == b.constraints_pieces);
      CHECK(a.constraints_pieces == b.constraints_pieces);
      CHECK(b.crossed_pairs <= a.crossed_pairs + a.crossed_pairs / 8 + 8);
      if (name == std::string("sunray") && n == 4000) CHECK(3 * b.crossed_pairs < 2 * a.crossed_pairs);
    }
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(seed);
      const Workload work = random_pslg(300, seed % 2 == 0 ? 40 : 100000, 200, seed);
      CHECK(call_ahead(runtime, work, never).seen == call_ahead(runtime, work, always).seen);
    }
  }
}

TEST_CASE("constraints that cross more than their lengths tell are taken in turn, too") {
  for (Treated& device : devices_as_all_kinds()) {
    runtime::Runtime& runtime = *device.runtime;
    CAPTURE(device.name);
    // Two vertices far away make the grid wide, and all that is between the others short.
    Workload work = workload("sunray", runtime.kind() == DeviceKind::lanes ? 1000 : 4000);
    double right = 0;
    for (const auto& p : work.points) right = std::max(right, std::max(p[0], p[1]));
    work.points.push_back({-1000 * right, -1000 * right});
    work.points.push_back({1000 * right, 1000 * right});
    const Called at_once = call_ahead(runtime, work, never), in_turn = call_ahead(runtime, work, 1);
    CHECK(at_once.seen.error == "");
    CHECK(at_once.seen == in_turn.seen);
    const std::uint64_t part = runtime.kind() == DeviceKind::lanes ? 4 : 3;  // few rays are left further apart
    CHECK(part * in_turn.statistics.crossed_pairs < (part - 1) * at_once.statistics.crossed_pairs);
  }
}

TEST_CASE("few crossings: all at once") {
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    const Workload work = workload("letters", 1000);
    CHECK(call_ahead(*device.runtime, work, {}).statistics.crossed_pairs ==
          call_ahead(*device.runtime, work, never).statistics.crossed_pairs);
  }
}

// Wherever the one that crosses stands among the pieces: ahead, or among the rest.
TEST_CASE("what crosses is found, dropped and split as ever") {
  for (Treated& device : devices_as_all_kinds()) {
    runtime::Runtime& runtime = *device.runtime;
    CAPTURE(device.name);
    const bool lanes = runtime.kind() == DeviceKind::lanes;
    for (std::uint32_t from = 1; from < 36; from += lanes ? 17 : 5) {
      CAPTURE(from);
      const Workload work = lines_and_one(40, from, from + 3);
      for (const Crossing policy : {Crossing::reject, Crossing::drop, Crossing::split}) {
        const Seen at_once = call_ahead(runtime, work, never, policy).seen,
                   in_turn = call_ahead(runtime, work, always, policy).seen;
        CHECK((at_once.error != "") == (policy == Crossing::reject));
        CHECK(at_once == in_turn);
      }
    }
    for (std::uint64_t seed = 1; seed <= (lanes ? 1 : 4); ++seed) {
      CAPTURE(seed);
      const Workload work = random_crossing(100, 1000, 60, seed);
      for (const Crossing policy : {Crossing::reject, Crossing::drop, Crossing::split})
        CHECK(call_ahead(runtime, work, never, policy).seen == call_ahead(runtime, work, always, policy).seen);
    }
  }
}
