// SPDX-License-Identifier: Apache-2.0
// Results of meshes that were not made by the call: the arrays, what can be asked, and what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "agreement.hpp"
#include "polygons.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Grid32 = std::vector<std::array<std::int32_t, 2>>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

std::int64_t orient(const std::array<std::int32_t, 2>& a, const std::array<std::int32_t, 2>& b,
                    const std::array<std::int32_t, 2>& c) {
  return (std::int64_t{b[0]} - a[0]) * (std::int64_t{c[1]} - a[1]) -
         (std::int64_t{b[1]} - a[1]) * (std::int64_t{c[0]} - a[0]);
}

/// The least triangle that holds q, border included, or -1.
std::int32_t found_in(const Grid32& points, const Triangles& triangles, const std::array<std::int32_t, 2>& q) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (orient(points[a], points[b], q) >= 0 && orient(points[b], points[c], q) >= 0 &&
        orient(points[c], points[a], q) >= 0)
      return static_cast<std::int32_t>(t);
  }
  return -1;
}

Grid32 random_points(std::size_t count, std::int32_t side, Random& random) {
  Grid32 points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<std::int32_t>(random.below(side));
    points.push_back({x, static_cast<std::int32_t>(random.below(side))});
  }
  return points;
}

/// Flips edges at random where the four points are strictly convex: a triangulation that is far from Delaunay.
void shake(const Grid32& points, Triangles& triangles, Random& random) {
  std::map<std::array<std::uint32_t, 2>, std::array<std::size_t, 2>> at;  // directed edge: triangle, corner opposite
  auto enter = [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) at[{triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]}] = {t, k};
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) enter(t);
  for (std::size_t i = 0; i < 4 * triangles.size(); ++i) {
    const std::size_t t = random.below(triangles.size()), k = random.below(3);
    const std::uint32_t p = triangles[t][k], a = triangles[t][(k + 1) % 3], b = triangles[t][(k + 2) % 3];
    const auto across = at.find({b, a});
    if (across == at.end()) continue;
    const auto [u, j] = across->second;
    const std::uint32_t q = triangles[u][j];
    if (orient(points[p], points[a], points[q]) <= 0 || orient(points[q], points[b], points[p]) <= 0) continue;
    at.erase({a, b}), at.erase({b, a});
    triangles[t] = {p, a, q}, triangles[u] = {q, b, p};
    enter(t), enter(u);
  }
}

/// Any order, any first corner.
void disorder(Triangles& triangles, Random& random) {
  for (auto& t : triangles) std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.below(3)), t.end());
  shuffle(triangles, random);
}

/// By brute force: the triangle with the reversed edge, or -1.
std::vector<std::array<std::int32_t, 3>> neighbours_of(const Triangles& triangles) {
  std::map<std::array<std::uint32_t, 2>, std::int32_t> at;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) at[{triangles[t][k], triangles[t][(k + 1) % 3]}] = static_cast<std::int32_t>(t);
  std::vector<std::array<std::int32_t, 3>> all(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto found = at.find({triangles[t][(k + 2) % 3], triangles[t][(k + 1) % 3]});
      all[t][k] = found == at.end() ? -1 : found->second;
    }
  return all;
}

/// What adopting throws; must throw.
Error refused(const Grid32& points, const Triangles& triangles, const std::vector<Constraint>& constraints = {}) {
  try {
    solver().adopt(points, triangles, constraints);
  } catch (const Error& error) {
    return error;
  }
  FAIL("the mesh was adopted");
  return Error(Status::ok, "");
}

}  // namespace

TEST_CASE("a mesh far from Delaunay, with parts missing, keeps its triangles, and points are found in them") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const std::int32_t side = seed % 2 ? 30 : 1 << 22;
    const Grid32 points = random_points(30 + 12 * seed, side, random);
    const auto made = solver().triangulate(points).triangles;
    Triangles triangles(made.begin(), made.end());
    shake(points, triangles, random);
    disorder(triangles, random);
    if (seed % 3) triangles.resize(triangles.size() * 2 / 3);
    const Result result = solver().adopt(points, triangles);
    CHECK(result.triangles() == triangles);
    CHECK(result.neighbours() == neighbours_of(triangles));
    CHECK(result.constrained() == std::vector<std::uint8_t>(triangles.size(), 0));
    CHECK(result.pieces().empty());
    CHECK(result.source_offsets() == std::vector<std::uint32_t>{0});
    const Statistics s = result.statistics();
    CHECK(s.triangles == triangles.size());
    CHECK((s.triangles_removed > 0) == (seed % 3 != 0));
    CHECK(s.m == 0);
    std::int64_t area = 0;
    for (const auto& [a, b, c] : triangles) area += orient(points[a], points[b], points[c]);
    CHECK(result.quality().doubled >= static_cast<std::uint64_t>(area));

    Grid32 queries(points);
    for (int i = 0; i < 200; ++i)
      queries.push_back({static_cast<std::int32_t>(random.below(2 * side)) - side / 2,
                         static_cast<std::int32_t>(random.below(2 * side)) - side / 2});
    const auto found = result.locate(queries);
    for (std::size_t i = 0; i < queries.size(); ++i) CHECK(found[i] == found_in(points, triangles, queries[i]));
    const auto at = result.vertex_triangles();
    for (std::size_t v = 0; v < points.size(); ++v) {
      const auto least = std::find_if(triangles.begin(), triangles.end(), [&](const auto& t) {
        return std::any_of(t.begin(), t.end(), [&](std::uint32_t c) { return points[c] == points[v]; });
      });
      CHECK(at[v] == (least == triangles.end() ? -1 : static_cast<std::int32_t>(least - triangles.begin())));
    }
  }
}

TEST_CASE("constraints along edges are flagged, with their sources, through the vertices on them") {
  // A fan around the middle of a square; constraint 1 runs across it through the middle, 2 and 0 along one side.
  const Grid32 points = {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {4, 4}, {8, 8}};
  const Triangles triangles = {{1, 2, 4}, {4, 0, 1}, {3, 4, 2}, {0, 4, 3}};
  const std::vector<Constraint> constraints = {{0, 1}, {5, 0}, {1, 0}, {2, 5}};
  const Result result = solver().adopt(points, triangles, constraints);
  CHECK(result.triangles() == triangles);
  CHECK(result.constrained() == std::vector<std::uint8_t>{1 << 0, 1 << 0 | 1 << 2, 1 << 0, 1 << 2});
  const auto pieces = result.pieces();
  const auto offsets = result.source_offsets();
  const auto sources = result.sources();
  CHECK(pieces.size() == 3);
  REQUIRE(offsets.size() == 4);
  std::map<Constraint, std::vector<std::uint32_t>> found;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    found[{std::min(pieces[i][0], pieces[i][1]), std::max(pieces[i][0], pieces[i][1])}] = {
        sources.begin() + offsets[i], sources.begin() + offsets[i + 1]};
  CHECK(found == std::map<Constraint, std::vector<std::uint32_t>>{{{0, 1}, {0, 2}}, {{0, 4}, {1}}, {{2, 4}, {1}}});
  const auto edges = result.edge_pieces();
  for (std::size_t t = 0; t < 4; ++t)
    for (int k = 0; k < 3; ++k) {
      const bool flagged = result.constrained()[t] >> k & 1;
      CHECK((edges[t][k] >= 0) == flagged);
      if (!flagged) continue;
      const std::uint32_t a = triangles[t][(k + 1) % 3], b = triangles[t][(k + 2) % 3];
      const Constraint& piece = pieces.at(static_cast<std::size_t>(edges[t][k]));
      CHECK(std::minmax(a, b) == std::minmax(piece[0], piece[1]));
    }
  CHECK(result.statistics().m == 4);
  CHECK(result.statistics().vertices_merged == 1);
}

TEST_CASE("what a call with a domain returned is adopted as it is, and answers alike") {
  const Polygons polygons = make_polygons(12, 9, 3, 0.5, true, false, 5);
  Options options;
  options.domain = Domain::even_odd;
  const Result made = solver().solve(polygons.points, polygons.constraints, options);
  const Result again = solver().adopt(polygons.points, made.triangles(), polygons.constraints);
  CHECK(again.triangles() == made.triangles());
  CHECK(again.neighbours() == made.neighbours());
  CHECK(again.constrained() == made.constrained());
  CHECK(again.pieces() == made.pieces());
  CHECK(again.sources() == made.sources());
  CHECK(again.hull() == made.hull());
  CHECK(again.vertex_triangles() == made.vertex_triangles());
  CHECK(again.edge_pieces() == made.edge_pieces());
  std::vector<double> heights(polygons.points.size());
  std::iota(heights.begin(), heights.end(), 0);
  Random random(1);
  const Grid32 queries = random_points(500, 4000, random);
  CHECK(again.interpolate(queries, heights, -1) == made.interpolate(queries, heights, -1));
}

TEST_CASE("no triangles, and no vertices") {
  const Grid32 points = {{0, 0}, {4, 0}, {0, 4}};
  const Result none = solver().adopt(points, Triangles{});
  CHECK(none.triangle_count() == 0);
  CHECK(none.locate(points) == std::vector<std::int32_t>{-1, -1, -1});
  CHECK(solver().adopt(Grid32{}, Triangles{}).triangle_count() == 0);
}

TEST_CASE("a mesh that is none is refused, and what is wrong is named") {
  const Grid32 points = {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {4, 4}, {20, 20}, {6, 1}};
  const Error clockwise = refused(points, {{0, 1, 4}, {0, 4, 1}});
  CHECK(clockwise.status() == Status::check_failed);
  CHECK(clockwise.indices() == std::vector<std::uint64_t>{1});
  CHECK(refused({{0, 0}, {4, 0}, {8, 0}, {0, 8}}, {{0, 2, 3}, {0, 1, 2}}).indices() ==
        std::vector<std::uint64_t>{1});  // flat
  const Error twice = refused({{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{0, 1, 2}, {0, 2, 3}, {2, 0, 1}});
  CHECK(twice.indices() == std::vector<std::uint64_t>{2});
  const Error inside = refused(points, {{0, 4, 3}, {0, 1, 4}});  // vertex 6 is in the second
  CHECK(inside.status() == Status::check_failed);
  CHECK(inside.indices() == std::vector<std::uint64_t>{1});
  const Error on_edge = refused({{0, 0}, {8, 0}, {0, 8}, {4, 4}}, {{0, 1, 2}});
  CHECK(on_edge.indices() == std::vector<std::uint64_t>{0});
  const Error crossing = refused({{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{0, 1, 2}, {0, 1, 3}});
  CHECK(crossing.status() == Status::check_failed);
  CHECK(std::string(crossing.what()) == "edges 0-2 and 1-3 of the mesh cross");
  const Error across = refused({{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{0, 1, 2}, {0, 2, 3}}, {{0, 1}, {1, 3}});
  CHECK(across.indices() == std::vector<std::uint64_t>{1});
  CHECK(std::string(across.what()) == "constraint 1 (1-3) crosses edge 0-2 of the mesh");
  // Three doubles almost on a line, and a point so far away that the grid has them on it.
  const std::vector<std::array<double, 2>> thin = {{0, 0}, {1, 1e-17}, {2, 0}, {1e9 + 1.0 / 3, 1e9}};
  CHECK_THROWS_WITH_AS(solver().adopt(thin, Triangles{{0, 2, 1}}), doctest::Contains("were rounded to a grid"), Error);
  const Error corner = refused(points, {{0, 1, 9}});
  CHECK(corner.status() == Status::invalid_argument);
  CHECK(corner.indices() == std::vector<std::uint64_t>{0, 2});
  const Error end = refused({{0, 0}, {8, 0}, {8, 8}}, {{0, 1, 2}}, {{0, 3}});
  CHECK(end.status() == Status::index_out_of_range);
  CHECK(end.indices() == std::vector<std::uint64_t>{0, 1});
  Options options;
  options.domain = Domain::outer;
  CHECK_THROWS_WITH_AS(solver().adopt(points, Triangles{}, {}, options), doctest::Contains("as it is"), Error);
  CHECK(solver().adopt(points, Triangles{{0, 6, 4}}).triangle_count() == 1);  // and the solver goes on
}
