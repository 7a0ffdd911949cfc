// SPDX-License-Identifier: Apache-2.0
// What the generators promise, proved without the library: a test input that is not what it says
// proves nothing.
#include "workloads.hpp"

#include <doctest/doctest.h>

#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include "oracle.hpp"

using namespace gcdt::test;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 2, std::size_t>;

/// How many pairs of constraints cross properly, a vertex at the crossing or not.
std::size_t proper_crossings(const Workload& work) {
  const auto at = [&](std::uint32_t i) { return Kernel::Point_2(work.points[i][0], work.points[i][1]); };
  std::vector<Box> boxes;
  for (std::size_t c = 0; c < work.constraints.size(); ++c)
    boxes.emplace_back(Kernel::Segment_2(at(work.constraints[c][0]), at(work.constraints[c][1])).bbox(), c);
  std::size_t count = 0;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& s, const Box& t) {
    const Segment c = work.constraints[s.info()], d = work.constraints[t.info()];
    const auto side = [&](const Segment& of, std::uint32_t p) {
      return static_cast<int>(CGAL::orientation(at(of[0]), at(of[1]), at(p)));
    };
    count += side(c, d[0]) * side(c, d[1]) < 0 && side(d, c[0]) * side(d, c[1]) < 0;
  });
  return count;
}

/// Whether every coordinate is a multiple of 2^exponent and the extent fits 31 bits of it.
bool on_binary_grid(const Workload& work, int exponent) {
  double low[2] = {work.points[0][0], work.points[0][1]}, high[2] = {low[0], low[1]};
  for (const Point& p : work.points)
    for (int axis = 0; axis < 2; ++axis) {
      const double units = std::ldexp(p[axis], -exponent);
      if (units != std::floor(units)) return false;
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  return std::ldexp(std::max(high[0] - low[0], high[1] - low[1]), -exponent) <= 2147483647.0;
}

}  // namespace

TEST_CASE("constraints of every generator do not cross and stay exact on the grid") {
  for (const std::string& name : workload_names()) {
    if (name == "line" || name == "random_pslg") continue;  // overlaps, crossings at vertices: below
    for (std::size_t n : {400, 5000, 98000}) {
      if (n > 5000 && name.compare(0, 7, "letters") != 0 && name != "spiral")
        continue;  // the others have no new shape at that size
      const Workload work = workload(name, n);
      CAPTURE(name);
      CAPTURE(n);
      CHECK(proper_crossings(work) == 0);
      for (const Segment& s : work.constraints) REQUIRE(std::max(s[0], s[1]) < work.points.size());
      if (!work.constraints.empty() && name != "star") CHECK((on_binary_grid(work, 0) || on_binary_grid(work, -29)));
    }
  }
}

TEST_CASE("the generators make about as many vertices as asked for") {
  for (const std::string& name : workload_names())
    for (std::size_t n : {400, 12000}) {
      const std::size_t made = workload(name, n).points.size();
      CAPTURE(name);
      CHECK(made >= n * 9 / 10);
      if (name.compare(0, 7, "letters") != 0)
        CHECK(made <= n);  // it ends with a whole word: up to 20,000 more when dense
      else
        CHECK(made <= n + 40000);
    }
}

TEST_CASE("random constraints are accepted exactly until they would cross") {
  std::size_t touching = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Workload all = random_crossing(20, 6, 60, seed), greedy = random_pslg(20, 6, 60, seed);
    const auto points = integers(all.points);
    CHECK(all.points == greedy.points);
    CHECK(crossings(points, greedy.constraints).empty());
    std::vector<Segment> kept;
    const auto without = dropped(points, all.constraints);
    for (std::uint32_t c = 0; c < all.constraints.size(); ++c)
      if (!std::binary_search(without.begin(), without.end(), c)) kept.push_back(all.constraints[c]);
    CHECK(kept == greedy.constraints);
    touching += proper_crossings(greedy);
  }
  CHECK(touching > 0);  // crossings at a vertex are kept
}

TEST_CASE("the lattice circle is 12,288 distinct points on one circle that fits the grid") {
  const Workload work = lattice_circle(20000);
  CHECK(std::set<Point>(work.points.begin(), work.points.end()).size() == 12288);
  const std::uint64_t squared = 125ull * 169 * 17 * 29 * 37 * 41 * 53 * 61 * 73 * 89;
  for (const GridPoint& p : integers(work.points)) {
    const std::int64_t x = p[0] - (1 << 30), y = p[1] - (1 << 30);
    REQUIRE(static_cast<std::uint64_t>(x * x + y * y) == squared);
    REQUIRE((p[0] >= 0 && p[1] >= 0 && p[0] < (std::int64_t{1} << 31) && p[1] < (std::int64_t{1} << 31)));
  }
}

TEST_CASE("directions are on the unit circle and at the angle asked for") {
  const double pi = std::acos(-1.0);
  for (std::uint64_t turn = 0; turn < (1ull << 32); turn += 65537 * 11) {
    const Point d = direction(static_cast<std::uint32_t>(turn));
    REQUIRE(std::fabs(d[0] - std::cos(2 * pi * static_cast<double>(turn) * 0x1p-32)) < 1e-14);
    REQUIRE(std::fabs(d[1] - std::sin(2 * pi * static_cast<double>(turn) * 0x1p-32)) < 1e-14);
  }
}

TEST_CASE("a spiral's polygon is simple and a hub's spokes are distinct") {
  const Workload polygon = spiral(10000);
  CHECK(std::set<Point>(polygon.points.begin(), polygon.points.end()).size() == polygon.points.size());
  std::set<std::pair<std::int64_t, std::int64_t>> slopes;
  const Workload wheel = hub(2000);
  for (const Segment& s : wheel.constraints) {
    const GridPoint p = integers({wheel.points[s[1]]})[0];
    CHECK(s[0] == 0);
    CHECK(std::gcd(p[0], p[1]) == 1);
    slopes.insert({p[0], p[1]});
  }
  CHECK(slopes.size() == wheel.constraints.size());
}
