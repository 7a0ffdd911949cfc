// SPDX-License-Identifier: Apache-2.0
// Point location against a search of all triangles, weights, interpolation; hull, triangles of vertices, pieces of
// edges.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "agreement.hpp"
#include "device/tuning.hpp"
#include "polygons.hpp"
#include "triangle_search.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Vertices, middles of edges, points anywhere and points outside; even coordinates, so that middles are integers.
Grid32 make_queries(const Grid32& points, const Triangulation& mesh, std::int32_t side, Random& random) {
  Grid32 queries(points);
  for (const auto& t : mesh.triangles)
    queries.push_back({(points[t[0]][0] + points[t[1]][0]) / 2, (points[t[0]][1] + points[t[1]][1]) / 2});
  for (int i = 0; i < 300; ++i)
    queries.push_back({static_cast<std::int32_t>(random.below(2 * side)) - side / 2,
                       static_cast<std::int32_t>(random.below(2 * side)) - side / 2});
  shuffle(queries, random);
  return queries;
}

Grid32 even_points(std::size_t n, std::int32_t side, Random& random) {
  Grid32 points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(
        {2 * static_cast<std::int32_t>(random.below(side / 2)), 2 * static_cast<std::int32_t>(random.below(side / 2))});
  return points;
}

}  // namespace

TEST_CASE("every query is in the least triangle that holds it, and its weights give it back") {
  for (const Domain domain : {Domain::hull, Domain::even_odd, Domain::outer})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      CAPTURE(seed);
      CAPTURE(static_cast<int>(domain));
      Random random(seed);
      const std::int32_t side = seed % 2 ? 40 : 1 << 20;
      const Grid32 points = even_points(20 + 10 * seed, side, random);
      std::vector<Constraint> constraints;
      for (std::uint32_t i = 0; i + 3 < 20; i += 4)
        constraints.insert(constraints.end(), {{i, i + 1}, {i + 1, i + 2}, {i + 2, i}});
      Options options;
      options.domain = domain;
      options.crossing = Crossing::drop;
      const Result result = solver().solve(points, constraints, options);
      const Triangulation mesh = result.download();
      const Grid32 queries = make_queries(points, mesh, side, random);
      std::vector<std::array<double, 3>> weights;
      const Array<std::int32_t> triangles = result.locate(queries, &weights);
      std::size_t outside = 0, misplaced = 0, wrong = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        misplaced += triangles[i] != found_in(points, mesh.triangles, queries[i]);
        outside += triangles[i] < 0;
        if (triangles[i] < 0) {
          wrong += weights[i] != std::array<double, 3>{0, 0, 0};
          continue;
        }
        const auto& t = mesh.triangles[triangles[i]];
        const double all = static_cast<double>(orient(points[t[0]], points[t[1]], points[t[2]]));
        for (int k = 0; k < 3; ++k)
          wrong += weights[i][k] !=
                   static_cast<double>(orient(points[t[(k + 1) % 3]], points[t[(k + 2) % 3]], queries[i])) / all;
      }
      CHECK(misplaced == 0);
      CHECK(wrong == 0);
      CHECK(outside > 0);
      CHECK(outside < queries.size());
      CHECK(result.locate(queries) == triangles);
    }
}

TEST_CASE("queries on a decimal grid are the decimals that they read as; those not finite are refused") {
  const std::vector<std::array<double, 2>> points = {{0.1, 0.1}, {0.3, 0.1}, {0.3, 0.3}, {0.1, 0.3}, {1000000.7, 5.5}};
  const Result result = solver().solve(points);
  REQUIRE(result.statistics().grid.kind == Grid::Kind::decimal);
  std::vector<std::array<double, 3>> weights;
  const auto triangles = result.locate(points, &weights);
  const auto mesh = result.download();
  for (std::size_t v = 0; v < points.size(); ++v) {
    REQUIRE(triangles[v] >= 0);
    for (int k = 0; k < 3; ++k) CHECK(weights[v][k] == (mesh.triangles[triangles[v]][k] == v ? 1 : 0));
  }
  CHECK(result.locate(std::vector<std::array<double, 2>>{{0.2, 0.05}, {-1e300, 1e300}, {0.1, 0.29999}}) ==
        std::vector<std::int32_t>{-1, -1, result.locate(std::vector<std::array<double, 2>>{{0.1, 0.2}})[0]});
  try {
    result.locate(std::vector<std::array<double, 2>>{{0, 0}, {0, std::numeric_limits<double>::infinity()}});
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    CHECK(error.status() == Status::coordinate_not_finite);
    CHECK(error.indices() == std::vector<std::uint64_t>{1, 1});
  }
}

TEST_CASE("more queries than are on the device at once have numbers of their own, in errors, too") {
  const std::vector<std::array<double, 2>> points = {{0, 0}, {4, 0}, {0, 4}, {4, 4}, {1, 2}};
  const Result result = solver().solve(points);
  const std::size_t count = Tuning::queries_at_once + 5;
  std::vector<std::array<double, 2>> queries(count);
  for (std::size_t i = 0; i < count; ++i) queries[i] = {double(i % 11) / 2, double(i % 7) / 2};
  std::vector<std::array<double, 3>> weights;
  const auto triangles = result.locate(queries, &weights);
  const auto values = result.interpolate(queries, std::vector<double>{0, 4, 4, 8, 3}, -1);
  CHECK(result.locate(queries) == triangles);
  for (const std::size_t first : {std::size_t{0}, count - 77}) {
    CAPTURE(first);
    const std::vector<std::array<double, 2>> some(queries.begin() + std::ptrdiff_t(first),
                                                  queries.begin() + std::ptrdiff_t(first + 77));
    std::vector<std::array<double, 3>> own_weights;
    const auto own = result.locate(some, &own_weights);
    CHECK(std::vector<std::int32_t>(triangles.begin() + std::ptrdiff_t(first),
                                    triangles.begin() + std::ptrdiff_t(first + 77)) == own);
    for (std::size_t i = 0; i < 77; ++i) {
      CHECK(weights[first + i] == own_weights[i]);
      CHECK(values[first + i] == (own[i] < 0 ? -1 : doctest::Approx(some[i][0] + some[i][1])));
    }
  }
  queries[count - 2][1] = std::numeric_limits<double>::quiet_NaN();
  try {
    result.locate(queries);
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    CHECK(error.indices() == std::vector<std::uint64_t>{count - 2, 1});
    CHECK(std::string(error.what()) == "y of point " + std::to_string(count - 2) + " is not a finite number");
  }
}

TEST_CASE("queries on a decimal grid are read as decimals after crossings were split, too") {
  // So far out that the doubles nearest to decimals are a twentieth away.
  const std::vector<std::array<double, 2>> points = {
      {0.1, -999999999999999.8}, {0.9, -999999999999996}, {0.1, -999999999999996}, {0.9, -999999999999999.2}};
  Options options;
  options.crossing = Crossing::split;
  const std::vector<Constraint> constraints = {{0, 1}, {2, 3}};
  const Result result = solver().solve(points, constraints, options);
  REQUIRE(result.statistics().grid.kind == Grid::Kind::decimal);
  REQUIRE(result.statistics().vertices_added == 1);
  const auto at = result.vertex_triangles();
  CHECK(result.locate(points) == std::vector<std::int32_t>(at.begin(), at.begin() + 4));
}

TEST_CASE("linear values are interpolated as they are, and with jumps by triangle") {
  Random random(5);
  const Grid32 points = even_points(200, 1024, random);
  const Result result = solver().solve(points);
  std::vector<double> heights;
  for (const auto& [x, y] : points) heights.push_back(3.0 * x - 2.0 * y + 1);
  const Grid32 queries = make_queries(points, result.download(), 1024, random);
  const Array<double> values = result.interpolate(queries, heights, -9999);
  const auto triangles = result.locate(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const double expected = triangles[i] < 0 ? -9999 : 3.0 * queries[i][0] - 2.0 * queries[i][1] + 1;
    CHECK(std::abs(values[i] - expected) <= 1e-11 * 6000);  // three roundings of numbers below 6000
  }
  heights.pop_back();
  CHECK_THROWS_AS(result.interpolate(queries, heights, 0), Error);
}

TEST_CASE("no triangles, no queries, and many thousand at one place") {
  const Result flat = solver().solve(Grid32{{0, 0}, {1, 1}, {2, 2}});
  CHECK(flat.locate(Grid32{{1, 1}, {5, 5}}) == std::vector<std::int32_t>{-1, -1});
  CHECK(flat.hull().empty());
  CHECK(flat.vertex_triangles() == std::vector<std::int32_t>{-1, -1, -1});
  const Result empty = solver().solve(Grid32{});
  CHECK(empty.locate(Grid32{{0, 0}}) == std::vector<std::int32_t>{-1});
  CHECK(empty.locate(Grid32{}).empty());
  CHECK(empty.hull().empty());
  const Result one = solver().solve(Grid32{{0, 0}, {4, 0}, {0, 4}});
  CHECK(one.locate(Grid32(50000, {1, 1})) == std::vector<std::int32_t>(50000, 0));
}

TEST_CASE("a walk across a mesh of long thin triangles ends, in more than one launch") {
  // Vertices on a parabola, the start of each walk far away along the curve from where the query is.
  const Workload work = parabola(20000);
  const Result result = solver().solve(work.points);
  const Triangulation mesh = result.download();
  std::vector<std::array<double, 2>> queries;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 97) {
    const auto& [a, b, c] = mesh.triangles[t];
    queries.push_back({std::floor((work.points[a][0] + work.points[b][0] + work.points[c][0]) / 3),
                       std::floor((work.points[a][1] + work.points[b][1] + work.points[c][1]) / 3)});
  }
  Grid32 points, integers_of;
  for (const auto& p : work.points) points.push_back({std::int32_t(p[0]), std::int32_t(p[1])});
  for (const auto& q : queries) integers_of.push_back({std::int32_t(q[0]), std::int32_t(q[1])});
  const auto found = result.locate(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) CHECK(found[i] == found_in(points, mesh.triangles, integers_of[i]));
}

TEST_CASE("the hull is all vertices on the boundary, counter-clockwise from the first in Z-order") {
  for (const Workload& work : {grid(100), uniform(500), ring(64), line_and_one(30), comb(50)}) {
    const Result result = solver().solve(work.points);
    const Triangulation mesh = result.download();
    std::map<std::uint32_t, std::uint32_t> next;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        if (mesh.neighbours[t][k] < 0) next[mesh.triangles[t][(k + 1) % 3]] = mesh.triangles[t][(k + 2) % 3];
    const Array<std::uint32_t> hull = result.hull();
    REQUIRE(hull.size() == next.size());
    for (std::size_t i = 0; i < hull.size(); ++i) CHECK(next[hull[i]] == hull[(i + 1) % hull.size()]);
    const auto place = on_grid(work.points, mesh.statistics.grid);
    auto z = [&](std::uint32_t v) { return reference::morton({place[v][0], place[v][1]}); };
    CHECK(std::all_of(hull.begin(), hull.end(), [&](std::uint32_t v) { return z(hull[0]) <= z(v); }));
    Options nothing;
    nothing.domain = Domain::outer;
    const Result removed = solver().solve(work.points, {}, nothing);
    CHECK(removed.triangle_count() == 0);
    CHECK(removed.hull() == hull);
  }
}

TEST_CASE("triangles of vertices are the least, and pieces of edges have the edge's ends") {
  for (const Domain domain : {Domain::hull, Domain::even_odd})
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const Workload work = random_pslg(80, 30, 100, seed);
      Options options;
      options.domain = domain;
      const Result result = solver().solve(work.points, work.constraints, options);
      const Triangulation mesh = result.download();
      std::vector<std::int32_t> least(work.points.size(), -1);
      for (std::size_t t = mesh.triangles.size(); t-- > 0;)
        for (const std::uint32_t v : mesh.triangles[t]) least[v] = static_cast<std::int32_t>(t);
      for (std::size_t v = 0; v < least.size(); ++v) least[v] = least[mesh.representative[v]];
      CHECK(result.vertex_triangles() == least);
      const auto pieces = result.edge_pieces();
      REQUIRE(pieces.size() == mesh.triangles.size());
      for (std::size_t t = 0; t < pieces.size(); ++t)
        for (int k = 0; k < 3; ++k) {
          REQUIRE((pieces[t][k] >= 0) == ((mesh.constrained[t] >> k & 1) != 0));
          if (pieces[t][k] < 0) continue;
          const std::uint32_t a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
          const auto [p, q] = mesh.pieces[pieces[t][k]];
          CHECK(std::minmax(a, b) == std::minmax(p, q));
        }
    }
}
