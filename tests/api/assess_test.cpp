// SPDX-License-Identifier: Apache-2.0
// Meshes at the coordinates as they were given, against rational arithmetic; and grids at the edges of doubles.
#include <doctest/doctest.h>

#include <map>

#include "exact/doubles.hpp"
#include "grid_oracle.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using oracle::Rational;
using Doubles = std::vector<std::array<double, 2>>;

int sign(const Rational& v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

int turn(const exact::Point& a, const exact::Point& b, const exact::Point& c) {
  using oracle::exact;
  const Rational ax = exact(a[0]) - exact(c[0]), ay = exact(a[1]) - exact(c[1]);
  const Rational bx = exact(b[0]) - exact(c[0]), by = exact(b[1]) - exact(c[1]);
  return sign(Rational(ax * by - ay * bx));
}

int inside(const exact::Point& a, const exact::Point& b, const exact::Point& c, const exact::Point& d) {
  using oracle::exact;
  std::array<Rational, 6> v;
  const exact::Point* points[] = {&a, &b, &c};
  for (int i = 0; i < 6; ++i)
    v[std::size_t(i)] = exact((*points[i / 2])[std::size_t(i % 2)]) - exact(d[std::size_t(i % 2)]);
  const Rational la = v[0] * v[0] + v[1] * v[1], lb = v[2] * v[2] + v[3] * v[3], lc = v[4] * v[4] + v[5] * v[5];
  return sign(
      Rational(la * (v[2] * v[5] - v[3] * v[4]) + lb * (v[4] * v[1] - v[5] * v[0]) + lc * (v[0] * v[3] - v[1] * v[2])));
}

/// By brute force over the triangles, in rational arithmetic.
Assessment expected(const Doubles& points, const Triangulation& mesh) {
  Assessment all;
  for (std::size_t v = 0; v < points.size(); ++v) all.vertices_lost += points[v] != points[mesh.representative[v]];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    const int side = turn(points[c[0]], points[c[1]], points[c[2]]);
    all.triangles_inverted += side < 0;
    all.triangles_flat += side == 0;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t across = mesh.neighbours[t][std::size_t(k)];
      if (across < static_cast<std::int32_t>(t) || (mesh.constrained[t] >> k & 1) || side <= 0) continue;
      for (const std::uint32_t v : mesh.triangles[std::size_t(across)])
        if (std::find(c.begin(), c.end(), v) == c.end())
          all.edges_not_delaunay += inside(points[c[0]], points[c[1]], points[c[2]], points[v]) > 0;
    }
  }
  return all;
}

Assessment assessed(const Doubles& points, const Triangulation& mesh) {
  return assess(points, view(mesh), mesh.statistics.grid);
}

double any(Random& random, double scale) { return (double(random.next() >> 11) * 0x1p-53 - 0.5) * scale; }

}  // namespace

TEST_CASE("the signs are exact for doubles of all sizes") {
  Random random(1);
  int zeros = 0;
  for (int i = 0; i < 3000; ++i) {
    std::array<exact::Point, 4> p;
    const int kind = i % 5;
    for (auto& point : p)
      for (double& v : point) {
        v = any(random, kind == 0 ? 1 : kind == 1 ? 1e308 : kind == 2 ? 1e-310 : 4);
        if (kind == 3) v = std::ldexp(v, int(random.below(2000)) - 1020);  // far apart
        if (kind == 4) v = std::floor(v);                                  // small integers: ties
      }
    const int side = turn(p[0], p[1], p[2]);
    CHECK(exact::orient2d(p[0], p[1], p[2]) == side);
    if (side < 0) std::swap(p[0], p[1]);
    if (kind != 3 || i % 20 == 3) CHECK(exact::incircle(p[0], p[1], p[2], p[3]) == inside(p[0], p[1], p[2], p[3]));
    zeros += side == 0;
  }
  CHECK(zeros > 50);
  // One ulp beside a line and a circle, where rounding says nothing.
  const double next = std::nextafter(0.5, 1);
  CHECK(exact::orient2d({0, 0}, {1, 1}, {0.5, next}) == 1);
  CHECK(exact::orient2d({12, 12}, {24, 24}, {0.5, next}) == 1);
  CHECK(exact::incircle({1, 0}, {0, 1}, {-1, 0}, {0, -1}) == 0);
  CHECK(exact::incircle({1, 0}, {0, 1}, {-1, 0}, {0, std::nextafter(-1, 0)}) == 1);
  CHECK(exact::incircle({1, 0}, {0, 1}, {-1, 0}, {0, std::nextafter(-1, -2)}) == -1);
}

TEST_CASE("an exact grid is valid and Delaunay as given; a rounded one is told as it is") {
  Random random(2);
  int inverted = 0, not_delaunay = 0, lost = 0;
  for (int i = 0; i < 60; ++i) {
    Doubles points;
    for (int v = 0; v < 60; ++v) points.push_back({any(random, 1), any(random, 1)});
    Options options;
    // Coarser and coarser, down to cells in which many vertices lie.
    const double cell = std::pow(0.5, 3 + i % 12);
    if (i % 2) options.grid = FixedGrid{-1, -1, std::to_string(cell)};
    const Triangulation mesh = solver().triangulate(points, {}, options);
    const Assessment found = assessed(points, mesh), right = expected(points, mesh);
    CHECK(found.triangles_inverted == right.triangles_inverted);
    CHECK(found.triangles_flat == right.triangles_flat);
    CHECK(found.vertices_lost == right.vertices_lost);
    CHECK(found.edges_not_delaunay == right.edges_not_delaunay);
    inverted += found.triangles_inverted > 0;
    not_delaunay += found.edges_not_delaunay > 0;
    lost += found.vertices_lost > 0;
    if (found.valid) CHECK((right.triangles_inverted == 0 && right.triangles_flat == 0 && right.vertices_lost == 0));
  }
  CHECK(inverted > 5);
  CHECK(not_delaunay > 5);
  CHECK(lost > 3);
  const Doubles square = {{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}};
  const Assessment decimals = assessed(square, solver().triangulate(square));
  CHECK(decimals.valid);
  Doubles integers;
  for (int v = 0; v < 200; ++v) integers.push_back({double(random.below(50)), double(random.below(50))});
  const Assessment whole = assessed(integers, solver().triangulate(integers));
  CHECK(whole.valid);
  CHECK(whole.edges_not_delaunay == 0);
}

namespace {

/// Do edges of the outline meet anywhere but where one follows the other? By trying all pairs.
bool simple_outline(const Doubles& points, const Triangulation& mesh) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (mesh.neighbours[t][k] < 0) edges.push_back({mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]});
  const auto within = [&](std::uint32_t a, std::uint32_t b, std::uint32_t v) {
    const auto &p = points[a], &q = points[b], &r = points[v];
    return turn(p, q, r) == 0 && std::min(p[0], q[0]) <= r[0] && r[0] <= std::max(p[0], q[0]) &&
           std::min(p[1], q[1]) <= r[1] && r[1] <= std::max(p[1], q[1]);
  };
  for (const auto& e : edges)
    for (const auto& f : edges) {
      if (e == f) continue;
      for (const std::uint32_t v : f)
        if (v != e[0] && v != e[1] && within(e[0], e[1], v)) return false;
      if (e[0] == f[1] || e[1] == f[0]) continue;
      const auto &a = points[e[0]], &b = points[e[1]], &c = points[f[0]], &d = points[f[1]];
      if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return false;
    }
  return true;
}

}  // namespace

TEST_CASE("an outline that meets itself is found, and one that is only not convex is none") {
  Options options;
  options.grid = FixedGrid{};
  Random random(5);
  int crossed = 0, dents = 0;
  for (int i = 0; i < 1500; ++i) {
    Doubles points;
    const double size = i % 3 == 0 ? 3 : i % 3 == 1 ? 6 : 60;
    for (int v = 0; v < 4 + i % 4; ++v)
      points.push_back({any(random, i % 2 ? 3 : size) + size, std::floor(any(random, 40) + 20) / 8 + size});
    const Triangulation mesh = solver().triangulate(points, {}, options);
    if (mesh.triangles.empty()) continue;
    const bool simple = simple_outline(points, mesh);
    const Assessment found = assessed(points, mesh);
    CHECK(found.outline_simple == simple);
    crossed += !simple;
    dents += simple && found.valid && mesh.statistics.grid.largest_move > 0;
  }
  CHECK(crossed > 20);
  CHECK(dents > 20);
  // On the grid the right side is three vertices above one another; as given, the middle one is dented.
  const Doubles dented = {{0, 0}, {8, 0}, {7.6, 4}, {8, 8}, {0, 8}};
  const Triangulation mesh = solver().triangulate(dented, {}, options);
  CHECK(mesh.triangles.size() == 3);
  CHECK(assessed(dented, mesh).valid);
}

TEST_CASE("grid points have the nearest doubles, and those have the grid points") {
  Random random(3);
  const std::vector<std::pair<Doubles, std::optional<FixedGrid>>> inputs = {
      {{{500000.25, 4649776.5}, {500713.0625, 4650001.75}}, {}},  // metres
      {{{-179.136572, 51.4}, {179.78, -14.373865}}, {}},          // degrees
      {{{1e300, -1e300}, {1.5e300, 1e299}}, {}},
      {{{0, 1e-17}, {3e-17, 2e-17}}, {}},
      {{{5e-324, 0}, {5e-322, 1e-323}}, {}},
      {{{0.1, 0.2}, {0.7, 1e-9}}, {}},
      {{{1e9, 0}, {1e9 + 1, 1}}, FixedGrid{1e9, 0, "0.001"}},
      {{{-5, 7}, {1e5, 8}}, FixedGrid{-12.5, 3.25, "0.0123"}},
      {{{1e15, 7}, {1e20, 8}}, FixedGrid{0, 0, "1e12"}},
  };
  for (const auto& [points, fixed] : inputs) {
    const Grid grid = choose_grid(points, fixed);
    const auto on_grid = grid_points(grid, points);
    for (std::size_t v = 0; v < points.size() && grid.largest_move == 0; ++v)
      CHECK(grid_coordinates(grid, on_grid)[v] == points[v]);
    std::vector<std::array<std::int32_t, 2>> some = {{0, 0}, {2147483647, 2147483647}};
    for (int i = 0; i < 200; ++i)
      some.push_back(
          {static_cast<std::int32_t>(random.below(1u << 31)), static_cast<std::int32_t>(random.below(1u << 31))});
    const auto coordinates = grid_coordinates(grid, some);
    const Rational cell = grid.cell_units ? Rational(grid.cell_units) / oracle::power_of_ten(grid.cell_decimals)
                                          : oracle::power_of_two(grid.cell_exponent);
    for (std::size_t i = 0; i < some.size(); ++i)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        Rational origin = oracle::exact(grid.origin[axis]);
        if (grid.kind == Grid::Kind::decimal)  // as written
          origin = Rational(oracle::round_half_even(Rational(origin / cell))) * cell;
        const Rational at = origin + cell * Rational(some[i][axis]);
        const double v = coordinates[i][axis];
        auto distance = [&](double w) {
          const Rational d = oracle::exact(w) - at;
          return d < 0 ? Rational(-d) : d;
        };
        CHECK(distance(v) <= distance(std::nextafter(v, HUGE_VAL)));
        CHECK(distance(v) <= distance(std::nextafter(v, -HUGE_VAL)));
      }
  }
}

TEST_CASE("neighbouring data sets on one fixed grid agree: common vertices have the same coordinates, cut or whole") {
  Random random(4);
  Doubles left, right, both;
  Options options;
  options.grid = FixedGrid{-180, -90, "0.000001"};
  for (int v = 0; v < 300; ++v) {
    const std::array<double, 2> p = {any(random, 40), any(random, 40)};
    both.push_back(p);
    if (p[0] < 4) left.push_back(p);
    if (p[0] > -4) right.push_back(p);
  }
  const auto places = [&](const Doubles& points) {
    const Triangulation mesh = solver().triangulate(points, {}, options);
    CHECK(mesh.statistics.grid.kind == Grid::Kind::fixed);
    CHECK(mesh.statistics.grid.largest_move <= 0.5000001e-6);
    CHECK(fault(points, {}, mesh) == "");
    const auto on_grid = grid_points(mesh.statistics.grid, points);
    std::map<std::array<double, 2>, std::array<std::int32_t, 2>> all;
    for (std::size_t v = 0; v < points.size(); ++v) all[points[v]] = on_grid[v];
    return all;
  };
  const auto of_left = places(left), of_right = places(right), of_both = places(both);
  std::size_t common = 0;
  for (const auto& [point, at] : of_both) {
    const auto in_left = of_left.find(point), in_right = of_right.find(point);
    if (in_left != of_left.end()) CHECK(in_left->second == at);
    if (in_right != of_right.end()) CHECK(in_right->second == at);
    common += in_left != of_left.end() && in_right != of_right.end();
  }
  CHECK(common > 10);
}
