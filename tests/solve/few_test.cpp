// SPDX-License-Identifier: Apache-2.0
// Few vertices, whose constraints one work-item enforces (kernels/constrain/enforce.cl): the same bytes and the same
// errors as by all work-items, of whatever is asked for, in a fifth of the launches.
#include <doctest/doctest.h>

#include <cmath>

#include "answer.hpp"
#include "batch_cases.hpp"
#include "solver_fixture.hpp"
#include "split_graphs.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

Solver& usual() {
  static Solver instance = tuned_solver(DeviceKind::threads, {});
  return instance;
}
Solver& all_of_them() {
  static Solver instance = tuned_solver(DeviceKind::threads, shared_out());
  return instance;
}

void check_same(const Workload& work, const Options& options) {
  const Answer few = ask(usual(), work, options), all = ask(all_of_them(), work, options);
  CHECK(few.error == all.error);
  CHECK(few.indices == all.indices);
  if (few.error.empty() && all.error.empty()) CHECK(difference(few.mesh, all.mesh) == "");
}

/// All policies, with regions and a domain, and a refinement.
std::vector<Options> wishes() {
  std::vector<Options> all(3);
  all[0].crossing = Crossing::reject, all[1].crossing = Crossing::drop, all[2].crossing = Crossing::split;
  Options domain;
  domain.crossing = Crossing::drop;
  domain.regions = true;
  for (const Domain d : {Domain::even_odd, Domain::outer}) {
    domain.domain = d;
    all.push_back(domain);
  }
  Options refined;
  refined.crossing = Crossing::drop;
  refined.refine = Refinement{};
  refined.refine->least_angle = 20;
  refined.refine->most_added = 500;
  all.push_back(refined);
  return all;
}

}  // namespace

TEST_CASE("the corpus and random graphs, whatever is asked for") {
  std::vector<Workload> all = corpus({"ok", "crossing", "invalid"});
  CHECK(all.size() > 70);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    all.push_back(random_pslg(120, 1000, 60, seed));
    all.push_back(random_crossing(80, 40, 30, seed));
  }
  for (const Workload& work : all) {
    CAPTURE(&work - all.data());
    for (const Options& options : wishes()) check_same(work, options);
  }
}

TEST_CASE("up to the limit and beyond it, with vertices that coincide, in shapes with long and short constraints") {
  const auto few = static_cast<std::size_t>(Tuning().one_item_vertices);
  const std::size_t most = most_here();
  REQUIRE(most > few);
  for (const char* name : {"hub", "letters", "spiral", "comb", "near_circle", "grid"})
    for (const std::size_t n : {std::size_t{100}, few, few + 1, most, most + 1}) {
      CAPTURE(name);
      check_same(workload(name, n), {});
    }
}

// Where all edges behind a constraint are new, and each has to be flipped until the last one is legal.
TEST_CASE("a constraint between two chains of vertices, convex to it or not, that crosses all edges between them") {
  for (const double bend : {-0.2, 0.2})
    for (const int n : {200, 2000, 12000}) {
      CAPTURE(bend);
      CAPTURE(n);
      Workload work;
      work.points = {{0, 0}, {1, 0}};
      for (int i = 1; i <= n; ++i) {
        const double x = double(i) / (n + 1), away = 0.1 + bend * (x - 0.5) * (x - 0.5);
        work.points.push_back({x, i % 2 == 0 ? away : -away});
      }
      work.constraints = {{0, 1}};
      check_same(work, {});
      const Statistics s = usual().triangulate(work.points, work.constraints).statistics;
      CHECK(s.crossed_pairs > static_cast<std::uint64_t>(n) / 2);
      if (n >= 2000) CHECK(s.flips < 12 * static_cast<std::uint64_t>(n));
    }
}

// Vertices of many pieces, whose other ends come in any order.
TEST_CASE("pieces of one vertex, more than are sorted by insertion") {
  for (const int n : {63, 64, 65, 66, 700, 5000}) {
    Workload work;
    work.points = {{0, 0}};
    for (int i = 0; i < n; ++i) {
      const double angle = 6.28 * i / n;
      work.points.push_back({std::cos(angle), std::sin(angle)});
      work.constraints.push_back({0, static_cast<std::uint32_t>(1 + (i * 7919) % n)});
    }
    check_same(work, {});
  }
}

TEST_CASE("the first of several ends out of range is named, whatever crosses before it") {
  Workload work = problem({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}}, {{0, 2}, {1, 3}, {4, 5}, {7, 0}});
  const Answer answer = ask(usual(), work, {});
  CHECK(answer.error.find("constraint 2: its second end is no vertex") != std::string::npos);
  CHECK(answer.indices == std::vector<std::uint64_t>{2, 1});
  work.constraints.erase(work.constraints.begin() + 2);
  CHECK(ask(usual(), work, {}).indices == std::vector<std::uint64_t>{2, 0});
}

TEST_CASE("few launches do it") {
  const Workload work = random_pslg(300, 1000, 100, 5);
  const Statistics few = usual().triangulate(work.points, work.constraints).statistics,
                   all = all_of_them().triangulate(work.points, work.constraints).statistics;
  CHECK(few.launches <= 12);
  CHECK(few.read_backs <= 8);
  CHECK(all.launches > 40);
  CHECK(few.constraints_pieces == all.constraints_pieces);
  CHECK(few.cases.constraint_hits == all.cases.constraint_hits);
  CHECK(few.ms.clean == 0);
}
