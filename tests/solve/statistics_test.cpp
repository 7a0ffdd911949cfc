// SPDX-License-Identifier: Apache-2.0
// The statistics say what happened: times add up and agree with the trace and with the caller's clock, counters with
// launches and with what theory expects.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include <gcdt/gcdt_pool.hpp>

#include "device/tuning.hpp"
#include "solver_fixture.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

struct Told {
  Statistics statistics;
  double clock = 0;                     ///< the call, on the test's own
  std::map<std::string, double> spans;  ///< milliseconds of the trace's phases, by name
  std::map<std::string, int> launches;
};

double ms(const TraceSpan& span) { return double(span.end_ns - span.begin_ns) / 1e6; }

/// Of the second of two calls: programs are there.
Told told(const Workload& work, const Options& options = {}) {
  Told result;
  Solver solver(test_device(), {}, [&](const TraceSpan& span) {
    if (span.on_device)
      ++result.launches[span.name];
    else
      result.spans[span.name] += ms(span);
  });
  solver.triangulate(work.points, work.constraints, options);
  result.spans.clear();
  result.launches.clear();
  const auto start = std::chrono::steady_clock::now();
  result.statistics = solver.triangulate(work.points, work.constraints, options).statistics;
  result.clock = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::vector<Options> ways() {
  std::vector<Options> all(4);
  all[1].canonical = false;
  all[2].domain = Domain::even_odd;
  all[3].check = false;
  return all;
}

std::int64_t turn(const std::array<std::int32_t, 2>& a, const std::array<std::int32_t, 2>& b,
                  const std::array<std::int32_t, 2>& c) {
  const auto d = [](std::int32_t from, std::int32_t to) { return std::int64_t{to} - from; };
  return d(a[0], b[0]) * d(a[1], c[1]) - d(a[1], b[1]) * d(a[0], c[0]);
}

/// Whether the segments p q and r s meet inside both.
bool cross(const std::vector<std::array<std::int32_t, 2>>& at, Constraint c, std::uint32_t r, std::uint32_t s) {
  const auto apart = [](std::int64_t a, std::int64_t b) { return (a < 0 && b > 0) || (a > 0 && b < 0); };
  return apart(turn(at[c[0]], at[c[1]], at[r]), turn(at[c[0]], at[c[1]], at[s])) &&
         apart(turn(at[r], at[s], at[c[0]]), turn(at[r], at[s], at[c[1]]));
}

/// Pairs of a triangle and a piece that crosses an edge of it, by trying all that are not left or right of each other.
std::uint64_t pairs_crossed(const Workload& work, const Triangulation& enforced, const Triangulation& delaunay) {
  const auto at = grid_points(enforced.statistics.grid, work.points);
  std::uint64_t pairs = 0;
  for (const Constraint& piece : enforced.pieces) {
    const auto [left, right] = std::minmax(at[piece[0]][0], at[piece[1]][0]);
    for (const auto& t : delaunay.triangles) {
      const auto [first, last] = std::minmax({at[t[0]][0], at[t[1]][0], at[t[2]][0]});
      if (first > right || last < left) continue;
      pairs += cross(at, piece, t[0], t[1]) || cross(at, piece, t[1], t[2]) || cross(at, piece, t[2], t[0]);
    }
  }
  return pairs;
}

/// Two clocks read around the same thing; a thread may lose its core between them.
void check_same_time(double a, double b) {
  CHECK(a <= 1.2 * b + 2);
  CHECK(b <= 1.2 * a + 2);
}

// `cleans`: by walks of their own; few vertices are cleaned and enforced by one work-item.
void check_phases(const Workload& work, bool cleans) {
  for (const Options& options : ways()) {
    CAPTURE(options.canonical);
    CAPTURE(options.check);
    Told t = told(work, options);
    auto& span = t.spans;
    const auto& s = t.statistics.ms;
    CHECK(s.full ==
          doctest::Approx(s.order + s.insert + s.constrain + s.flip + s.check + s.output + s.domain + s.refine));
    const double copies = s.output - span["output"];  // which are no phase
    CHECK(copies >= -2);
    check_same_time(s.full - copies, span["order"] + span["insert"] + span["constrain"] + span["flip"] + span["check"] +
                                         span["output"] + span["domain"]);
    check_same_time(s.core, span["sort"] + span["insert"] + span["constrain"] - span["clean"] + span["walk"] +
                                span["flip"] + span["gather"]);
    check_same_time(s.clean, span["clean"]);
    check_same_time(s.walk, span["walk"]);
    check_same_time(s.gather, span["gather"]);
    CHECK((span["check"] > 0) == options.check);
    CHECK((span["domain"] > 0) == (options.domain != Domain::hull));
    for (const char* name : {"order", "sort", "insert", "constrain", "flip", "output", "gather"}) {
      CAPTURE(name);
      CHECK(span[name] > 0);
    }
    for (const char* name : {"clean", "walk"}) CHECK((span[name] > 0) == cleans);
    for (const double part : {s.order, s.insert, s.constrain, s.output, s.core, s.gather}) CHECK(part > 0);
    for (const double part : {s.clean, s.walk}) CHECK((part > 0) == cleans);
    CHECK(s.walk <= s.clean);
    CHECK(s.clean <= s.constrain);
    CHECK(s.gather <= s.output);
    CHECK(s.core <= s.full);
  }
}

}  // namespace

TEST_CASE("full is the sum of the phases, core that of its parts, and each part is as long as its span in the trace") {
  check_phases(workload("random_pslg", 300), false);
  check_phases(workload("spiral", most_here() + 1000), true);
}

// Sorting alone has no figure of its own: what core has beside the others must be what the trace calls so. Clocks are
// read one after the other, far less than half a walk apart.
TEST_CASE("core is sorting, inserting, enforcing with the walk that cleaning shares with it, flipping and gathering") {
  Told t = told(workload("fan", most_here() + 4000));
  const auto& s = t.statistics.ms;
  const double sorting = s.core - (s.insert + (s.constrain - s.clean) + s.walk + s.flip + s.gather);
  const double least = std::min(s.walk, s.gather);
  CHECK(least > 0.5);
  CHECK(std::abs(sorting - t.spans["sort"]) < least / 2);
}

TEST_CASE("call is the caller's clock: with copies and new arrays, and with building where programs are built") {
  for (const auto& [name, n] :
       {std::pair<const char*, std::size_t>{"uniform", 200000}, {"random_pslg", most_here() + 1000}}) {
    CAPTURE(name);
    const Workload work = workload(name, n);
    const Told t = told(work);
    CHECK(t.statistics.ms.build == 0);
    CHECK(t.statistics.ms.full <= t.statistics.ms.call);
    CHECK(t.statistics.ms.call <= t.clock);
    check_same_time(t.statistics.ms.call, t.clock);
    Solver fresh(test_device());
    const Statistics first = fresh.triangulate(work.points, work.constraints).statistics;
    CHECK(first.ms.build > 0);
    CHECK(first.ms.build + first.ms.full <= first.ms.call);
  }
}

TEST_CASE("the call of a batch is the caller's clock") {
  const Workload problem = workload("random_pslg", 60);
  Batch batch;
  for (int i = 0; i < 300; ++i) batch.add(problem.points, problem.constraints);
  Pool pool(test_device());
  pool.triangulate(batch);
  const auto start = std::chrono::steady_clock::now();
  const double told = pool.triangulate(batch).statistics().ms_call;
  const double clock = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  CHECK(told <= clock);
  check_same_time(told, clock);
}

TEST_CASE("each copy of a result adds its time to output, full and call") {
  const Workload work = uniform(50000);
  const Result result = solver().solve(work.points);
  const Statistics before = result.statistics();
  result.triangles();
  const Statistics after = result.statistics();
  const double copied = after.ms.output - before.ms.output;
  CHECK(copied > 0);
  CHECK(after.ms.full - before.ms.full == doctest::Approx(copied));
  CHECK(after.ms.call - before.ms.call == doctest::Approx(copied));
}

// A vertex that is inserted in random order takes fewer than 3 flips on average, as its degree is then below 6; by
// levels it is nearly so. It takes one at least, but for the few that are inserted in the interior of triangles that
// stay.
TEST_CASE("flips, steps of location and rounds are those of theory, to a factor below three") {
  const std::size_t n = 30000;
  const Told t = told(uniform(n));
  const Statistics& s = t.statistics;
  CHECK(s.flips > 1.3 * n);
  CHECK(s.flips < 3.6 * n);
  // A walk from a neighbour on the curve: at least the face where it ends.
  CHECK(s.location_steps > 2 * n);
  CHECK(s.location_steps < 6 * n);
  CHECK(s.rounds.insert > 0);
  if (const auto grown = t.launches.find("grow_insert"); grown != t.launches.end())
    CHECK(s.rounds.insert == static_cast<std::uint64_t>(grown->second));
}

// Where vertices go in one after the other, constraints are enforced in the Delaunay mesh of all: at once, or, of few,
// one after the other.
TEST_CASE("crossed pairs are those of the mesh in which constraints are enforced") {
  std::uint64_t all = 0;
  for (const auto& [name, n] : {std::pair<const char*, std::size_t>{"random_pslg", 60},
                                {"fan", 200},
                                {"fan", most_here() + 1000},
                                {"letters", most_here() + 1000}}) {
    CAPTURE(name);
    const Workload work = workload(name, n);
    const Told t = told(work);
    const Triangulation enforced = solver().triangulate(work.points, work.constraints);
    const std::uint64_t crossed = pairs_crossed(work, enforced, solver().triangulate(work.points));
    CHECK(t.statistics.cases.pieces_walked + t.statistics.cases.existing_edges == enforced.pieces.size());
    CHECK(t.statistics.crossed_pairs >= t.statistics.cases.pieces_walked);
    const bool at_once = t.launches.count("enforce_problems") == 0;
    CHECK(at_once == (work.points.size() > most_here() || t.launches.count("grow_insert") == 0));
    if (at_once && t.launches.count("grow_insert") != 0) CHECK(t.statistics.crossed_pairs == crossed);
    all += crossed;
  }
  CHECK(all > 0);
}
