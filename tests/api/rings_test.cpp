// SPDX-License-Identifier: Apache-2.0
// Polygons as ragged arrays: rings become constraints, whatever their orientation, and however they touch.
#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "grid_oracle.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Doubles = std::vector<std::array<double, 2>>;

struct Rings {
  Doubles points;
  std::vector<std::uint64_t> rings = {0}, polygons = {0};

  void ring(Doubles at, bool closed = false) {
    points.insert(points.end(), at.begin(), at.end());
    if (closed) points.push_back(at.front());
    rings.push_back(points.size());
  }
  void end_polygon() { polygons.push_back(rings.size() - 1); }
};

Doubles square(double x, double y, double side, bool clockwise) {
  Doubles all = {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
  if (clockwise) std::reverse(all.begin(), all.end());
  return all;
}

oracle::Rational doubled_area(const Doubles& points, const std::vector<Constraint>& constraints) {
  oracle::Rational area = 0;
  for (const auto& [a, b] : constraints)
    area += oracle::exact(points[a][0]) * oracle::exact(points[b][1]) -
            oracle::exact(points[a][1]) * oracle::exact(points[b][0]);
  return area;
}

/// The doubled area of the triangles to the centre of which an odd number of constraints is crossed: by a ray.
oracle::Rational odd_area(const Doubles& points, const std::vector<Constraint>& constraints,
                          const Triangulation& mesh) {
  using oracle::Rational, oracle::exact;
  Rational area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Rational x = (exact(points[a][0]) + exact(points[b][0]) + exact(points[c][0])) / 3;
    const Rational y = (exact(points[a][1]) + exact(points[b][1]) + exact(points[c][1])) / 3;
    bool odd = false;
    for (const auto& [p, q] : constraints) {
      const Rational py = exact(points[p][1]), qy = exact(points[q][1]);
      if ((py > y) == (qy > y)) continue;
      const Rational at = exact(points[p][0]) + (exact(points[q][0]) - exact(points[p][0])) * (y - py) / (qy - py);
      odd ^= at > x;
    }
    const std::vector<Constraint> around = {{a, b}, {b, c}, {c, a}};
    if (odd) area += doubled_area(points, around);
  }
  return area;
}

std::int32_t status_of(const std::vector<std::uint64_t>& rings, const std::vector<std::uint64_t>& polygons,
                       const Doubles& points) {
  try {
    ring_constraints(points, rings, polygons);
  } catch (const Error& error) {
    return static_cast<std::int32_t>(error.status());
  }
  return 0;
}

}  // namespace

TEST_CASE("constraint v joins vertex v and the next of its ring; as given, nothing is turned") {
  Rings r;
  r.ring(square(0, 0, 4, true));
  r.ring({});
  r.ring({{9, 9}});
  r.ring({{1, 1}, {2, 2}});
  const auto made = ring_constraints(r.points, r.rings);
  CHECK(made == std::vector<Constraint>{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 4}, {5, 6}, {6, 5}});
  CHECK(ring_constraints({}, std::vector<std::uint64_t>{0}).empty());
}

TEST_CASE("of a polygon the first ring is turned counter-clockwise, the others clockwise, by exact areas") {
  for (int turned = 0; turned < 16; ++turned) {
    Rings r;
    r.ring(square(0, 0, 10, turned & 1), turned & 8);
    r.ring(square(2, 2, 3, turned & 2), turned & 4);
    r.ring(square(6, 6, 2, turned & 4));
    r.end_polygon();
    r.ring(square(20, 0, 5, turned & 8), true);
    r.end_polygon();
    r.end_polygon();  // a polygon without rings
    const auto made = ring_constraints(r.points, r.rings, r.polygons);
    CHECK(doubled_area(r.points, made) == 2 * (100 - 9 - 4 + 25));
    // The same edges as without turning.
    const auto given = ring_constraints(r.points, r.rings);
    for (std::size_t v = 0; v < made.size(); ++v)
      CHECK((made[v] == given[v] || made[v] == Constraint{given[v][1], given[v][0]}));
  }
  // A sliver whose area is lost in rounding, far from 0, and denormal and huge rings.
  const double far = 0x1p52;
  for (const Doubles& ring : {Doubles{{far, far}, {far + 2, far + 2}, {far + 1, far + 1 + 1}, {far + 1, far + 1}},
                              Doubles{{0, 0}, {5e-324, 0}, {5e-324, 5e-324}},
                              Doubles{{-1.5e308, -1.5e308}, {1.5e308, -1.5e308}, {1.5e308, 1.5e308}},
                              Doubles{{1e300, 1e-300}, {-1e300, 1e-300}, {0, 1e-320}}}) {
    for (const bool reversed : {false, true}) {
      Rings r;
      Doubles at = ring;
      if (reversed) std::reverse(at.begin(), at.end());
      r.ring(at);
      r.end_polygon();
      CHECK(doubled_area(r.points, ring_constraints(r.points, r.rings, r.polygons)) > 0);
    }
  }
}

TEST_CASE("rings that touch, share edges, repeat their first vertex or touch themselves fill their area") {
  Random random(11);
  for (int seed = 0; seed < 30; ++seed) {
    // Cells of a board, each a polygon of its own: borders coincide, corners touch. Some have a hole that touches.
    Rings r;
    oracle::Rational expected = 0;
    for (int x = 0; x < 4; ++x)
      for (int y = 0; y < 4; ++y) {
        if (random.below(3) == 0) continue;
        r.ring(square(8 * x, 8 * y, 8, random.below(2)), random.below(2));
        expected += 128;
        if (random.below(2)) {  // a triangle with its tip on the border, or in a corner of the cell
          Doubles hole = {
              {8.0 * x + 2, 8.0 * y + 6}, {8.0 * x + 6, 8.0 * y + 6}, {8.0 * x + (random.below(2) ? 4 : 0), 8.0 * y}};
          if (random.below(2)) std::reverse(hole.begin(), hole.end());
          r.ring(hole, random.below(2));
          expected -= 24;
        }
        r.end_polygon();
      }
    // A ring that touches itself in a vertex: a bow of two squares.
    r.ring({{100, 0}, {104, 0}, {104, 4}, {108, 4}, {108, 8}, {104, 8}, {104, 4}, {100, 4}});
    r.end_polygon();
    expected += 64;
    const auto constraints = ring_constraints(r.points, r.rings, r.polygons);
    const Triangulation mesh = solver().triangulate(r.points, constraints);
    CHECK(fault(r.points, constraints, mesh) == "");
    CHECK(doubled_area(r.points, constraints) == expected);
    // Every border is there as often as it was given: the even-odd area, in which shared borders count twice.
    CHECK(odd_area(r.points, constraints, mesh) == expected);
  }
}

TEST_CASE("rings that overlap are split, and keep all borders") {
  Rings r;
  r.ring(square(0, 0, 6, false));
  r.ring(square(3, 3, 6, true), true);
  const auto constraints = ring_constraints(r.points, r.rings);
  Options options;
  options.crossing = Crossing::split;
  const Triangulation mesh = solver().triangulate(r.points, constraints, options);
  CHECK(mesh.added == std::vector<std::array<double, 2>>{{3, 6}, {6, 3}});
  Doubles all = r.points;
  all.insert(all.end(), mesh.added.begin(), mesh.added.end());
  CHECK(odd_area(all, constraints, mesh) == 2 * (36 + 36 - 2 * 9));
}

TEST_CASE("domains of ring arrays have exactly the area of the polygons: touching, with borders cut up at random") {
  Random random(23);
  for (int seed = 0; seed < 30; ++seed) {
    CAPTURE(seed);
    Rings r;
    std::uint64_t expected = 0;  // twice the area
    // A side of a cell, with vertices on it or without: neighbours cut up their common border in different ways.
    auto ring = [&](const Doubles& corners) {
      Doubles at;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
        at.push_back(a);
        for (int cut = 1; cut < 8; ++cut)
          if (random.below(4) == 0) at.push_back({a[0] + (b[0] - a[0]) * cut / 8, a[1] + (b[1] - a[1]) * cut / 8});
      }
      if (random.below(2)) std::reverse(at.begin(), at.end());
      r.ring(at, random.below(2));
    };
    for (double x = 0; x < 32; x += 8)
      for (double y = 0; y < 32; y += 8) switch (random.below(4)) {
          case 0: break;
          case 1:  // with a hole that touches a side or a corner
            ring(square(x, y, 8, false));
            ring({{x + (random.below(2) ? 4 : 0), y}, {x + 6, y + 6}, {x + 2, y + 6}});
            expected += 128 - 24;
            r.end_polygon();
            break;
          case 2:  // a ring that touches itself in the middle of the cell
            ring({{x, y}, {x + 8, y}, {x + 4, y + 4}, {x + 8, y + 8}, {x, y + 8}, {x + 4, y + 4}});
            expected += 64;
            r.end_polygon();
            break;
          default:
            ring(square(x, y, 8, false));
            expected += 128;
            r.end_polygon();
        }
    const auto constraints = ring_constraints(r.points, r.rings, r.polygons);
    Options options;
    options.grid = FixedGrid{0, 0, "0.125"};  // on which all cuts are
    for (const Domain domain : {Domain::even_odd, Domain::nonzero}) {
      options.domain = domain;
      const Result result = solver().solve(r.points, constraints, options);
      CHECK(result.quality().doubled == 64 * expected);
      CHECK(result.statistics().open_parity == 0);
      CHECK(result.statistics().open_winding == 0);
    }
  }
}

TEST_CASE("domains of ring arrays that overlap, split: the area that a board of cells has by counting") {
  Random random(29);
  for (int seed = 0; seed < 30; ++seed) {
    CAPTURE(seed);
    Rings r;
    std::array<std::array<int, 16>, 16> covers{};  // by how many polygons
    const std::uint64_t polygons = 1 + random.below(7);
    for (std::uint64_t p = 0; p < polygons; ++p) {
      const std::uint64_t x = random.below(12), y = random.below(12), side = 1 + random.below(16 - std::max(x, y));
      // The hole may share sides with its ring.
      const std::uint64_t hole = random.below(side), hole_x = x + random.below(side - hole + 1),
                          hole_y = y + random.below(side - hole + 1);
      r.ring(square(double(x), double(y), double(side), random.below(2)), random.below(2));
      if (hole > 0) r.ring(square(double(hole_x), double(hole_y), double(hole), random.below(2)), random.below(2));
      r.end_polygon();
      for (std::uint64_t i = x; i < x + side; ++i)
        for (std::uint64_t j = y; j < y + side; ++j)
          covers[i][j] += i < hole_x || i >= hole_x + hole || j < hole_y || j >= hole_y + hole;
    }
    std::uint64_t odd = 0, any = 0;
    for (const auto& column : covers)
      for (const int c : column) odd += 2 * (c % 2), any += 2 * (c > 0);
    const auto constraints = ring_constraints(r.points, r.rings, r.polygons);
    Options options;
    options.grid = FixedGrid{};
    options.crossing = Crossing::split;
    options.domain = Domain::even_odd;
    CHECK(solver().solve(r.points, constraints, options).quality().doubled == odd);
    options.domain = Domain::nonzero;
    CHECK(solver().solve(r.points, constraints, options).quality().doubled == any);
  }
}

TEST_CASE("offsets that do not ascend from 0 to the end are errors") {
  const Doubles points = square(0, 0, 1, false);
  const auto invalid = static_cast<std::int32_t>(Status::invalid_argument);
  CHECK(status_of({0, 4}, {}, points) == 0);
  CHECK(status_of({0, 4}, {0, 1}, points) == 0);
  CHECK(status_of({0, 3}, {}, points) == invalid);
  CHECK(status_of({1, 4}, {}, points) == invalid);
  CHECK(status_of({0, 3, 2, 4}, {}, points) == invalid);
  CHECK(status_of({0, 4}, {0, 2}, points) == invalid);
  CHECK(status_of({}, {}, points) == invalid);
  Doubles bad = points;
  bad[2][1] = std::nan("");
  CHECK(status_of({0, 4}, {0, 1}, bad) == static_cast<std::int32_t>(Status::coordinate_not_finite));
}
