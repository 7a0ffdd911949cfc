// SPDX-License-Identifier: Apache-2.0
// Domains: areas against the shoelace formula, regions against the host's flood, seeds, borders that are not closed.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "agreement.hpp"
#include "polygons.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Grid32 = std::vector<std::array<std::int32_t, 2>>;

constexpr Domain all_domains[] = {Domain::hull,  Domain::even_odd, Domain::nonzero,
                                  Domain::holes, Domain::outer,    Domain::outer_holes};

Options with(Domain domain) {
  Options options;
  options.domain = domain;
  options.regions = true;
  return options;
}

RegionView said(const Triangulation& mesh) { return {mesh.region.data(), mesh.depth.data(), mesh.winding.data()}; }

/// Empty if the host's flood says the same of every triangle, and finds the same triangles.
std::string domain_fault(Points points, Constraints constraints, const Triangulation& mesh, const Options& options) {
  if (mesh.region.size() != mesh.triangles.size() || mesh.depth.size() != mesh.triangles.size() ||
      mesh.winding.size() != mesh.triangles.size() || mesh.region_seed.size() != mesh.triangles.size())
    return "not one region, depth, winding and seed a triangle";
  if (mesh.statistics.peak_device_bytes > required_bytes(points.size(), constraints.size()))
    return "more device memory than required_bytes says";
  return verify_domain(points, constraints, view(mesh), said(mesh), mesh.statistics.grid, options).reason;
}

/// A square of that half side around the origin, counter-clockwise.
void add_square(Grid32& points, std::vector<Constraint>& constraints, std::int32_t half, bool reversed = false) {
  const auto first = static_cast<std::uint32_t>(points.size());
  for (const auto& [x, y] : {std::array{-half, -half}, {half, -half}, {half, half}, {-half, half}})
    points.push_back({x, y});
  for (std::uint32_t i = 0; i < 4; ++i) {
    Constraint side = {first + i, first + (i + 1) % 4};
    if (reversed) std::swap(side[0], side[1]);
    constraints.push_back(side);
  }
}

}  // namespace

TEST_CASE("by even-odd and by nonzero, polygons that do not overlap have the area of their rings, exactly") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    const Polygons p = make_polygons(5 + seed, 9, 4, 0.3, false, false, seed);
    const std::int64_t shoelace = std::accumulate(p.shoelace.begin(), p.shoelace.end(), std::int64_t{0});
    for (const Domain domain : {Domain::even_odd, Domain::nonzero}) {
      const Options options = with(domain);
      const Triangulation mesh = solver().triangulate(p.points, p.constraints, options);
      CHECK(doubled_area(p.points, mesh) == shoelace);
      CHECK(mesh.statistics.open_parity == 0);
      CHECK(mesh.statistics.open_winding == 0);
      CHECK(domain_fault(p.points, p.constraints, mesh, options) == "");
    }
  }
}

TEST_CASE("where polygons overlap, the winding number of a triangle is the number of polygons over its cell") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    const Polygons p = make_polygons(6, 4 + seed, 3 + static_cast<int>(seed % 3), 0.6, true, seed % 2, seed);
    std::int64_t odd = 0, filled = 0;
    for (const int w : p.winding) odd += w & 1, filled += w != 0;
    const Triangulation whole = solver().triangulate(p.points, p.constraints, with(Domain::hull));
    for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
      // Three times the middle, on the lattice's own axes: times the determinant.
      std::int64_t x = 0, y = 0;
      for (const std::uint32_t v : whole.triangles[t]) x += p.points[v][0], y += p.points[v][1] - 3000;
      const std::int64_t scale = 3 * p.cell_area / 2, column = 11 * x - 2 * y, row = 3 * x + 7 * y;
      if (column < 0 || row < 0 || column >= p.columns * scale || row >= p.rows * scale)
        CHECK(whole.winding[t] == 0);
      else
        CHECK(whole.winding[t] == p.winding[(row / scale) * p.columns + column / scale]);
    }
    const Triangulation by_parity = solver().triangulate(p.points, p.constraints, with(Domain::even_odd));
    const Triangulation by_winding = solver().triangulate(p.points, p.constraints, with(Domain::nonzero));
    CHECK(doubled_area(p.points, by_parity) == odd * p.cell_area);
    CHECK(doubled_area(p.points, by_winding) == filled * p.cell_area);
    CHECK(whole.statistics.open_winding == 0);
  }
}

TEST_CASE("a border that two polygons share counts twice: between them even-odd does not change") {
  // Two squares side by side, each with its own copy of the common side.
  const Grid32 points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {8, 0}, {8, 4}};
  const std::vector<Constraint> rings = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 4}, {4, 5}, {5, 2}, {2, 1}};
  const Triangulation both = solver().triangulate(points, rings, with(Domain::even_odd));
  CHECK(doubled_area(points, both) == 2 * 32);
  CHECK(both.statistics.regions == 2);
  CHECK(*std::max_element(both.depth.begin(), both.depth.end()) == 1);
  // With the side once only, the borders are not closed, which is said.
  const std::vector<Constraint> open(rings.begin(), rings.end() - 1);
  const Triangulation said = solver().triangulate(points, open, with(Domain::even_odd));
  CHECK(said.statistics.open_parity == 1);
  CHECK(said.statistics.notes.size() == 1);
  CHECK(doubled_area(points, said) == 2 * 32);
}

TEST_CASE("nested squares: depth, winding and the six domains") {
  Grid32 points;
  std::vector<Constraint> rings;
  for (const std::int32_t half : {100, 80, 60, 40}) add_square(points, rings, half);
  points.push_back({300, 0});  // so that the hull is not a border
  Options options = with(Domain::hull);
  options.hole_seeds = {{0, 0}, {1000, 1000}};
  options.region_seeds = {{90, 0}, {50, 0}, {91, 0}};
  auto area = [&](Domain domain) {
    options.domain = domain;
    const Triangulation mesh = solver().triangulate(points, rings, options);
    CHECK(domain_fault(points, rings, mesh, options) == "");
    return doubled_area(points, mesh);
  };
  const std::int64_t square[] = {2 * 200 * 200, 2 * 160 * 160, 2 * 120 * 120, 2 * 80 * 80};
  const std::int64_t hull = square[0] + 2 * (100 * 200);  // and a triangle of base 200 and height 200
  CHECK(area(Domain::hull) == hull);
  CHECK(area(Domain::even_odd) == square[0] - square[1] + square[2] - square[3]);
  CHECK(area(Domain::nonzero) == square[0]);
  CHECK(area(Domain::holes) == hull - square[3]);
  CHECK(area(Domain::outer) == square[0]);
  CHECK(area(Domain::outer_holes) == square[0] - square[3]);
  options.domain = Domain::hull;
  const Triangulation mesh = solver().triangulate(points, rings, options);
  CHECK(mesh.statistics.regions == 5);
  CHECK(mesh.statistics.deepest == 4);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    CHECK(mesh.winding[t] == static_cast<std::int32_t>(mesh.depth[t]));
    CHECK(mesh.region_seed[t] == (mesh.depth[t] == 1 ? 0 : mesh.depth[t] == 3 ? 1 : -1));
  }
  std::vector<Constraint> turned(rings.begin(), rings.begin() + 4);
  for (std::size_t i = 4; i < rings.size(); ++i)
    turned.push_back(i < 8 ? Constraint{rings[i][1], rings[i][0]} : rings[i]);
  options.domain = Domain::nonzero;
  CHECK(doubled_area(points, solver().triangulate(points, turned, options)) == square[0] - square[1] + square[2]);
}

TEST_CASE("thousands of nested squares are as deep as they are many") {
  Grid32 points;
  std::vector<Constraint> rings;
  for (std::int32_t half = 1; half <= 3000; ++half) add_square(points, rings, half, half % 2);
  const Options options = with(Domain::hull);
  const Triangulation mesh = solver().triangulate(points, rings, options);
  CHECK(mesh.statistics.regions == 3000);
  CHECK(mesh.statistics.deepest == 3000);
  CHECK(domain_fault(points, rings, mesh, options) == "");
}

TEST_CASE("regions, depths, windings and kept triangles agree with the host's flood, also where borders are open") {
  std::size_t open = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const Domain domain : all_domains) {
      CAPTURE(seed);
      CAPTURE(static_cast<int>(domain));
      const Workload work = seed % 2 ? random_pslg(60, 40, 60 + 10 * seed, seed) : random_crossing(40, 30, 40, seed);
      Options options = with(domain);
      options.crossing = Crossing::drop;
      Random random(seed);
      for (int i = 0; i < 3; ++i)
        options.hole_seeds.push_back({double(random.below(80)) / 2, double(random.below(80)) / 2});
      const Triangulation mesh = solver().triangulate(work.points, work.constraints, options);
      CHECK(domain_fault(work.points, work.constraints, mesh, options) == "");
      open += mesh.statistics.open_winding;
    }
  CHECK(open > 0);
}

TEST_CASE("thousands of regions side by side are reached at once") {
  const Polygons p = make_polygons(80, 80, 3, 0.5, true, true, 99);
  const Options options = with(Domain::nonzero);
  const Triangulation mesh = solver().triangulate(p.points, p.constraints, options);
  CHECK(mesh.statistics.regions > 3000);
  CHECK(mesh.statistics.deepest < 100);
  CHECK(domain_fault(p.points, p.constraints, mesh, options) == "");
}

TEST_CASE("every region is one triangle where all edges are constraints") {
  const Workload work = grid(400);
  const Triangulation mesh = solver().triangulate(work.points);
  std::vector<Constraint> edges;
  for (const auto& [a, b, c] : mesh.triangles) edges.insert(edges.end(), {{a, b}, {b, c}, {c, a}});
  const Options options = with(Domain::nonzero);
  const Triangulation cut = solver().triangulate(work.points, edges, options);
  CHECK(cut.triangles == mesh.triangles);
  CHECK(cut.statistics.regions == mesh.triangles.size());
  CHECK(cut.statistics.constraints_overlapping > 0);
  CHECK(std::all_of(cut.winding.begin(), cut.winding.end(), [](std::int32_t w) { return w == 1; }));
  CHECK(domain_fault(work.points, edges, cut, options) == "");
}

TEST_CASE("nothing is labelled unless asked for, and no triangles are no error") {
  const Polygons p = make_polygons(4, 4, 2, 0.5, false, false, 1);
  const Triangulation plain = solver().triangulate(p.points, p.constraints);
  CHECK(plain.region.empty());
  CHECK(plain.statistics.regions == 0);
  for (const Domain domain : all_domains) {
    const Grid32 flat = {{0, 0}, {1, 1}, {2, 2}}, triangle = {{0, 0}, {4, 0}, {0, 4}};
    CHECK(solver().triangulate(flat, {}, with(domain)).triangles.empty());
    CHECK(solver().triangulate(Grid32{}, {}, with(domain)).triangles.empty());
    const Triangulation one = solver().triangulate(triangle, {}, with(domain));
    CHECK(one.triangles.size() == (domain == Domain::hull || domain == Domain::holes ? 1 : 0));
    CHECK(one.statistics.notes.empty() == !one.triangles.empty());
  }
}

TEST_CASE("seeds that are not finite are refused, and those outside do nothing") {
  const Grid32 triangle = {{0, 0}, {4, 0}, {0, 4}};
  Options options = with(Domain::holes);
  options.hole_seeds = {{1, 1}, {std::numeric_limits<double>::quiet_NaN(), 0}};
  try {
    solver().triangulate(triangle, {}, options);
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    CHECK(error.status() == Status::coordinate_not_finite);
    CHECK(error.indices() == std::vector<std::uint64_t>{1, 0});
  }
  options.hole_seeds = {{4, 4}, {-1, 0}, {1e300, -1e300}};
  CHECK(solver().triangulate(triangle, {}, options).triangles.size() == 1);
  options.hole_seeds = {{2, 2}};
  CHECK(solver().triangulate(triangle, {}, options).triangles.empty());
}

TEST_CASE("the host's proof refuses a domain with a triangle too few, too many, twice, or with a wrong word") {
  Grid32 points;
  std::vector<Constraint> rings;
  for (const std::int32_t half : {100, 80, 60}) add_square(points, rings, half);
  const Options options = with(Domain::even_odd);
  const Triangulation good = solver().triangulate(points, rings, options);
  const Triangulation whole = solver().triangulate(points, rings, with(Domain::hull));
  auto reason = [&](const Triangulation& mesh) {
    return verify_domain(points, rings, view(mesh), said(mesh), good.statistics.grid, options).reason;
  };
  REQUIRE(reason(good) == "");
  CHECK(reason(whole) != "");
  auto spoilt = [&](auto&& change) {
    Triangulation mesh = good;
    change(mesh);
    return reason(mesh);
  };
  CHECK(spoilt([](Triangulation& m) { m.triangles.pop_back(); }).find("missing") != std::string::npos);
  CHECK(spoilt([](Triangulation& m) { m.triangles.back() = m.triangles.front(); }).find("twice") != std::string::npos);
  CHECK(spoilt([](Triangulation& m) { std::swap(m.triangles[0][0], m.triangles[0][1]); }) != "");
  CHECK(spoilt([](Triangulation& m) { m.triangles[0][0] = 77; }) != "");
  CHECK(spoilt([](Triangulation& m) { m.neighbours[0][0] += 1; }).find("neighbour") != std::string::npos);
  CHECK(spoilt([](Triangulation& m) { m.constrained[0] ^= 2; }).find("constrained") != std::string::npos);
  CHECK(spoilt([](Triangulation& m) { m.region[0] += 1; }).find("region") != std::string::npos);
  CHECK(spoilt([](Triangulation& m) { m.depth[0] += 2; }).find("depth") != std::string::npos);
  CHECK(spoilt([](Triangulation& m) { m.winding[0] += 2; }).find("winding") != std::string::npos);
}
