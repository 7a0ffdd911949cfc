// SPDX-License-Identifier: Apache-2.0
// Domains of graphs whose crossings were split: winding numbers against the routes of the oracle, and the host's proof.
#include <doctest/doctest.h>

#include "agreement.hpp"
#include "split_graphs.hpp"

using namespace gcdt;
using namespace gcdt::test;
using namespace gcdt::test::graphs;

namespace {

Options options_for(Domain domain) {
  Options options = splitting();
  options.domain = domain;
  options.regions = true;
  return options;
}

std::string domain_fault(const Graph& graph, const Triangulation& mesh, const Options& options) {
  MeshView seen = view(mesh);
  seen.added = mesh.added_on_grid;
  const RegionView said = {mesh.region.data(), mesh.depth.data(), mesh.winding.data()};
  return verify_domain(graph.points, graph.constraints, seen, said, mesh.statistics.grid, options).reason;
}

std::int64_t doubled(const oracle::GridPair& a, const oracle::GridPair& b, const oracle::GridPair& c) {
  return static_cast<std::int64_t>(oracle::turn(a, b, c));
}

/// Twice the area, each triangle times `weight` of its winding number.
template <class Weight>
std::int64_t area(const Graph& graph, const Triangulation& mesh, Weight&& weight) {
  std::int64_t sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    sum += weight(mesh.winding[t]) * doubled(place(graph, mesh, a), place(graph, mesh, b), place(graph, mesh, c));
  }
  return sum;
}

/// Closed polygons through random points, which cross themselves and one another.
Graph closed_polygons(std::uint64_t seed, std::size_t polygons, std::size_t corners, std::uint64_t side) {
  Graph graph = random_graph(seed, polygons * corners, 0, side);
  graph.name = "closed polygons " + std::to_string(seed);
  for (std::uint32_t p = 0; p < polygons; ++p)
    for (std::uint32_t i = 0; i < corners; ++i) {
      const auto first = p * static_cast<std::uint32_t>(corners);
      graph.constraints.push_back({first + i, first + (i + 1) % static_cast<std::uint32_t>(corners)});
    }
  return graph;
}

}  // namespace

TEST_CASE(
    "areas times winding numbers add up to the shoelace sum of the routes, by every domain that the host proves") {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    // From crowded, where everything is rounded and merged, to sparse.
    const Graph graph = closed_polygons(seed, 1 + seed % 4, 5 + seed % 6,
                                        seed % 3 == 0   ? 12
                                        : seed % 3 == 1 ? 60
                                                        : 9000);
    CAPTURE(graph.name);
    const oracle::Split right = oracle::split(graph.wide(), graph.constraints);
    std::int64_t shoelace = 0;
    for (const oracle::Links& links : right.links)
      for (std::size_t i = 0; i + 1 < links.size(); ++i)
        shoelace += links[i][0] * links[i + 1][1] - links[i + 1][0] * links[i][1];
    // The oracle's links run along the constraint, as its ends are given.
    const Triangulation whole = solver().triangulate(graph.points, graph.constraints, options_for(Domain::hull));
    CHECK(area(graph, whole, [](int w) { return w; }) == shoelace);
    CHECK(whole.statistics.open_parity == 0);
    CHECK(whole.statistics.open_winding == 0);
    CHECK(domain_fault(graph, whole, options_for(Domain::hull)) == "");
    for (const Domain domain : {Domain::even_odd, Domain::nonzero, Domain::outer}) {
      const Options options = options_for(domain);
      const Triangulation mesh = solver().triangulate(graph.points, graph.constraints, options);
      CHECK(domain_fault(graph, mesh, options) == "");
      if (domain == Domain::outer) continue;
      const bool parity = domain == Domain::even_odd;
      const auto kept = [&](int w) { return parity ? w & 1 : w != 0; };
      CHECK(area(graph, mesh, [](int) { return 1; }) == area(graph, whole, kept));
    }
  }
}

TEST_CASE("two squares that cross: the area by nonzero is that of the union, by even-odd without what both cover") {
  Graph graph;
  graph.points = {{0, 0}, {20, 0}, {20, 20}, {0, 20}, {10, 10}, {30, 10}, {30, 30}, {10, 30}};
  graph.constraints = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}};
  const auto count = [&](Domain domain) {
    const Triangulation mesh = solver().triangulate(graph.points, graph.constraints, options_for(domain));
    CHECK(mesh.statistics.vertices_added == 2);
    CHECK(mesh.statistics.constraint_move == 0);
    return area(graph, mesh, [](int) { return 1; });
  };
  CHECK(count(Domain::nonzero) == 2 * (400 + 400 - 100));
  CHECK(count(Domain::even_odd) == 2 * (400 + 400 - 200));
}

TEST_CASE("the host's proof refuses a domain with a wrong winding number, and one without an added vertex") {
  const Graph graph = closed_polygons(4, 2, 7, 9000);
  const Options options = options_for(Domain::nonzero);
  const Triangulation mesh = solver().triangulate(graph.points, graph.constraints, options);
  REQUIRE(mesh.statistics.vertices_added > 0);
  REQUIRE(domain_fault(graph, mesh, options) == "");
  Triangulation wrong = mesh;
  wrong.winding[0] += 1;
  CHECK(domain_fault(graph, wrong, options) != "");
  wrong = mesh;
  wrong.added_on_grid.pop_back();
  CHECK(domain_fault(graph, wrong, options) != "");
  wrong = mesh;
  wrong.added_on_grid[0][0] += 1;
  CHECK(domain_fault(graph, wrong, options) != "");
}

TEST_CASE("values of added vertices lie between those of the constraints that cross there") {
  Graph graph;
  graph.points = {{0, 0}, {40, 0}, {10, -10}, {10, 30}};
  for (auto& p : graph.points) p[1] += 10;
  graph.constraints = {{0, 1}, {2, 3}};
  const std::vector<double> heights = {0, 40, 100, 140};  // at the crossing 10 along the one, 110 along the other
  const Triangulation mesh = solver().triangulate(graph.points, graph.constraints, splitting());
  const auto values = added_values(graph.points, graph.constraints, mesh.added, mesh.added_crossing, heights);
  REQUIRE(values.size() == 1);
  CHECK(values[0] == doctest::Approx(60));
  const std::vector<Constraint> none = {{0, 7}};
  CHECK_THROWS_WITH_AS(added_values(graph.points, graph.constraints, mesh.added, none, heights),
                       doctest::Contains("there is no constraint 7"), Error);
}
