// SPDX-License-Identifier: Apache-2.0
// Random constraint sets by the hundred, on small grids of integers: vertices on edges and on
// constraints, overlaps, ties and crossings all occur, and the statistics prove it.
#include <doctest/doctest.h>

#include "agreement.hpp"
#include "solver_fixture.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Delaunay edges of a third of the vertices after stretching y: long parallel constraints that cut
/// the same triangles many times, from all sides.
Workload stretched(std::size_t n, std::uint32_t side, std::uint64_t seed) {
  Workload work = random_pslg(n, side, 0, seed);
  std::vector<GridPoint> subset;
  std::vector<std::uint32_t> number;
  const auto representative = representatives(integers(work.points));
  for (std::uint32_t i = 0; i < n / 3; ++i) {
    if (representative[i] != i) continue;
    const std::int64_t x = static_cast<std::int64_t>(work.points[i][0]),
                       y = static_cast<std::int64_t>(work.points[i][1]);
    subset.push_back({x, 8 * y});
    number.push_back(i);
  }
  for (const auto& t : reference::reference_cdt(subset, {}))
    for (int k = 0; k < 3; ++k) work.constraints.push_back({number[t[k]], number[t[(k + 1) % 3]]});
  return work;
}

/// A triangle with an empty circle, its corners cut off by three bundles of parallel constraints.
Workload cut_corners(std::uint64_t seed) {
  Random random(seed);
  Workload work{{{0, 10000}, {-8660, -5000}, {8660, -5000}}, {}};
  for (std::uint32_t bundle = 0; bundle < 3; ++bundle) {
    const std::uint64_t count = 1 + random.below(4);
    for (std::uint64_t i = 0; i < count; ++i) {  // a chord near (0, 10000), turned by a third of a turn a bundle
      const double y = 6000 + 700 * static_cast<double>(i) + static_cast<double>(random.below(100)),
                   x = 8200 + static_cast<double>(random.below(1500));
      const Point d = direction(bundle * 0x55555555u);
      for (double side : {-x, x})
        work.points.push_back({std::floor(side * d[0] - y * d[1]), std::floor(side * d[1] + y * d[0])});
      const std::uint32_t last = static_cast<std::uint32_t>(work.points.size() - 1);
      work.constraints.push_back({last - 1, last});
    }
  }
  return work;
}

/// Empty if the solver's result is valid and agrees with brute force and CGAL. Counts the special cases in `sum`.
std::string fault_by(Solver& solver, const Workload& work, Statistics::Cases& sum, Crossing crossing) try {
  Options options;
  options.crossing = crossing;
  const Triangulation mesh = solver.triangulate(work.points, work.constraints, options);
  const Statistics::Cases& cases = mesh.statistics.cases;
  sum.edge_splits += cases.edge_splits;
  sum.constraint_hits += cases.constraint_hits;
  sum.existing_edges += cases.existing_edges;
  sum.pieces_walked += cases.pieces_walked;
  sum.chain_vertices += cases.chain_vertices;
  sum.holes += cases.holes;
  sum.symbolic_chain_vertices += cases.symbolic_chain_vertices;
  const std::string invalid = fault(work.points, work.constraints, mesh, crossing);
  return invalid.empty() ? disagreement(work, mesh, crossing) : invalid;
} catch (const Error& error) {
  return error.what();
}

/// By one work-item, where few vertices are one's, and by all.
std::string fault_of(const Workload& work, Statistics::Cases& sum, Crossing crossing = Crossing::reject) {
  static Solver by_all = tuned_solver(DeviceKind::threads, shared_out());
  const std::string fault = fault_by(solver(), work, sum, crossing);
  return fault.empty() ? fault_by(by_all, work, sum, crossing) : fault;
}

}  // namespace

TEST_CASE("hundreds of random inputs give meshes that agree with CGAL, and every special case is reached") {
  Statistics::Cases sum;
  std::size_t inputs = 0;
  const auto check = [&](const Workload& work) {
    REQUIRE(crossings(integers(work.points), work.constraints).empty());
    CHECK(fault_of(work, sum) == "");
    ++inputs;
  };
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const std::size_t n = 3 + random.below(58);
    const std::uint32_t sides[] = {3, 5, 8, 13, 40, 1000};
    const std::uint32_t side = sides[seed % 6];
    CAPTURE(n);
    CAPTURE(side);
    check(random_pslg(n, side, n * (1 + random.below(4)), seed));
  }
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    check(stretched(60, seed % 2 ? 1000 : 30, seed));
    check(cut_corners(seed));
  }
  CHECK(inputs == 320);
  CHECK(sum.edge_splits > 0);
  CHECK(sum.constraint_hits > 0);
  CHECK(sum.existing_edges > 0);
  CHECK(sum.pieces_walked > 0);
  CHECK(sum.chain_vertices > 0);
  CHECK(sum.holes > 0);
  MESSAGE("edge splits " << sum.edge_splits << ", constraint hits " << sum.constraint_hits << ", existing edges "
                         << sum.existing_edges << ", pieces walked " << sum.pieces_walked << ", chain vertices "
                         << sum.chain_vertices << ", holes " << sum.holes << ", symbolic chain vertices "
                         << sum.symbolic_chain_vertices);
}

TEST_CASE("drop keeps a constraint exactly if it crosses no earlier kept one") {
  Statistics::Cases sum;
  std::size_t dropped_inputs = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Random random(1000 + seed);
    const std::size_t n = 4 + random.below(37);
    const std::uint32_t side = seed % 3 == 0 ? 5 : seed % 3 == 1 ? 12 : 500;
    const Workload work = random_crossing(n, side, 1 + random.below(2 * n), seed);
    CAPTURE(seed);
    CHECK(fault_of(work, sum, Crossing::drop) == "");
    dropped_inputs += !dropped(integers(work.points), work.constraints).empty();
  }
  CHECK(dropped_inputs > 50);
}

TEST_CASE("drop without crossings is reject") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Workload work = random_pslg(40, 10, 80, seed);
    Options drop;
    drop.crossing = Crossing::drop;
    const Triangulation a = solver().triangulate(work.points, work.constraints),
                        b = solver().triangulate(work.points, work.constraints, drop);
    CHECK(a.triangles == b.triangles);
    CHECK(a.pieces == b.pieces);
    CHECK(b.dropped.empty());
  }
}

TEST_CASE("reject names the number of crossing pairs and all of them, ten in its message") {
  std::size_t few = 0, many = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Random random(2000 + seed);
    const std::size_t n = 4 + random.below(37);
    const Workload work = random_crossing(n, seed % 2 ? 6 : 300, 2 + random.below(seed % 4 < 2 ? 8 : 60), seed);
    const auto expected = crossings(integers(work.points), work.constraints);
    CAPTURE(seed);
    try {
      solver().triangulate(work.points, work.constraints);
      CHECK(expected.empty());
    } catch (const Error& error) {
      CHECK(error.status() == Status::constraints_cross);
      CHECK(error.pair_count() == expected.size());
      std::vector<std::uint64_t> all;
      for (const auto& pair : expected) all.insert(all.end(), pair.begin(), pair.end());
      CHECK(error.indices() == all);
      const std::string message = error.what();
      CHECK(std::count(message.begin(), message.end(), '(') == 2 * std::min<std::ptrdiff_t>(10, expected.size()));
      CHECK((message.find(", ...") != std::string::npos) == (expected.size() > 10));
      (expected.size() > 10 ? many : few) += 1;
    }
  }
  CHECK(few > 10);
  CHECK(many > 10);
}
