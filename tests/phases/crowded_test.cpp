// SPDX-License-Identifier: Apache-2.0
// Random graphs on grids so small that nearly everything is degenerate, and the same stretched over the largest grid:
// each with every option for crossings and domains together, proved by the host, and asked all that can be asked.
// GCDT_CROWDED_CASES: how many graphs, a few by default; GCDT_CROWDED_FIRST: the number of the first.
#include <doctest/doctest.h>

#include <cstdlib>

#include "split_graphs.hpp"

using namespace gcdt;
using namespace gcdt::test;
using namespace gcdt::test::graphs;

namespace {

std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

using Cell = std::array<std::int32_t, 2>;
using Seeds = std::vector<std::array<double, 2>>;

/// Points at random, all on one line, or at few places; constraints at random, in rings, in a chain, doubled, turned
/// around, of no length.
Graph crowded_graph(Random& random) {
  const std::int32_t sides[] = {1, 2, 3, 5, 8, 13, 40};
  const std::int32_t side = sides[random.below(std::size(sides))];
  Graph graph;
  const std::uint64_t n = random.below(random.below(4) == 0 ? 5 : 16);
  const std::uint64_t line = random.below(8);
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto x = static_cast<std::int32_t>(random.below(side + 1)),
               y = static_cast<std::int32_t>(random.below(side + 1));
    graph.points.push_back(line == 0 ? Cell{x, 0} : line == 1 ? Cell{x, x} : line == 2 ? Cell{3, y} : Cell{x, y});
  }
  if (n == 0) return graph;
  const auto any = [&] { return static_cast<std::uint32_t>(random.below(n)); };
  for (std::uint64_t i = random.below(14); i > 0; --i) graph.constraints.push_back({any(), any()});
  for (std::uint64_t rings = random.below(3); rings > 0; --rings) {
    const std::uint32_t first = any();
    std::uint32_t at = first;
    for (std::uint64_t corner = 1 + random.below(6); corner > 0; --corner) {
      const std::uint32_t next = corner == 1 ? first : any();
      graph.constraints.push_back({at, next});
      at = next;
    }
  }
  for (std::uint64_t again = random.below(4); again > 0 && !graph.constraints.empty(); --again) {
    const Constraint c = graph.constraints[random.below(graph.constraints.size())];
    graph.constraints.push_back(random.below(2) ? c : Constraint{c[1], c[0]});
  }
  shuffle(graph.constraints, random);
  return graph;
}

/// The same over the whole of the largest grid, each coordinate off by one or not: nearly degenerate.
void stretch(Graph& graph, Random& random) {
  std::int32_t most = 1;
  for (const Cell& p : graph.points) most = std::max({most, p[0], p[1]});
  const std::int64_t last = (std::int64_t{1} << 31) - 1;
  for (Cell& p : graph.points)
    for (std::int32_t& c : p)
      c = static_cast<std::int32_t>(
          std::clamp<std::int64_t>(last * c / most + static_cast<std::int64_t>(random.below(3)) - 1, 0, last));
}

/// At vertices, between them, and outside.
Seeds some_places(const Graph& graph, std::uint64_t count, Random& random) {
  Seeds places;
  for (; count > 0; --count) {
    if (graph.points.empty() || random.below(8) == 0) {
      places.push_back({-1e300, 4e9});
      continue;
    }
    const Cell &a = graph.points[random.below(graph.points.size())],
               &b = graph.points[random.below(graph.points.size())];
    places.push_back(random.below(2) ? std::array<double, 2>{double(a[0]), double(a[1])}
                                     : std::array<double, 2>{(double(a[0]) + b[0]) / 2, (double(a[1]) + b[1]) / 2});
  }
  return places;
}

std::string domain_fault(const Graph& graph, const Triangulation& mesh, const Options& options) {
  MeshView seen = view(mesh);
  seen.added = mesh.added_on_grid;
  const RegionView said = {mesh.region.data(), mesh.depth.data(), mesh.winding.data()};
  return verify_domain(graph.points, graph.constraints, seen, said, mesh.statistics.grid, options).reason;
}

/// The vertices, added ones last.
std::vector<Cell> all_points(const Graph& graph, const Triangulation& mesh) {
  std::vector<Cell> points = graph.points;
  points.insert(points.end(), mesh.added_on_grid.begin(), mesh.added_on_grid.end());
  return points;
}

/// Where each query is, by brute force: even coordinates are whole cells.
std::string locate_fault(const Graph& graph, const Triangulation& mesh, const Result& result, Random& random) {
  std::vector<Cell> queries = all_points(graph, mesh);
  const std::size_t corners = queries.size();
  for (std::size_t i = 0; i < 20 && corners > 0; ++i) {
    const Cell &a = queries[random.below(corners)], &b = queries[random.below(corners)];
    queries.push_back({a[0] / 2 + b[0] / 2, a[1] / 2 + b[1] / 2});
  }
  queries.push_back({0, 2147483647});
  std::vector<std::array<double, 3>> weights;
  const auto found = result.locate(queries, &weights);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const oracle::GridPair q = {queries[i][0], queries[i][1]};
    std::int32_t expected = -1;
    for (std::size_t t = 0; t < mesh.triangles.size() && expected < 0; ++t) {
      bool inside = true;
      for (int k = 0; k < 3; ++k)
        inside = inside && oracle::turn(place(graph, mesh, mesh.triangles[t][k]),
                                        place(graph, mesh, mesh.triangles[t][(k + 1) % 3]), q) >= 0;
      if (inside) expected = static_cast<std::int32_t>(t);
    }
    if (found[i] != expected) return "query " + std::to_string(i) + " is in another triangle";
    const double sum = weights[i][0] + weights[i][1] + weights[i][2];
    if (expected < 0 ? sum != 0 : std::abs(sum - 1) > 1e-15) return "weights do not add up";
  }
  return "";
}

/// The result, taken for a mesh that is there already: the same, whatever the domain has left of it.
std::string adoption_fault(const Graph& graph, const Triangulation& mesh) {
  Options options;
  options.grid = FixedGrid{};
  const Result again = solver().adopt(all_points(graph, mesh), mesh.triangles, mesh.pieces, options);
  if (again.triangles() != mesh.triangles) return "triangles differ";
  if (again.neighbours() != mesh.neighbours) return "neighbours differ";
  if (again.constrained() != mesh.constrained) return "flags differ";
  if (again.pieces() != mesh.pieces) return "pieces differ";
  return "";
}

bool same(const Triangulation& a, const Triangulation& b) {
  return a.triangles == b.triangles && a.neighbours == b.neighbours && a.constrained == b.constrained &&
         a.pieces == b.pieces && a.sources == b.sources && a.region == b.region && a.depth == b.depth &&
         a.winding == b.winding && a.region_seed == b.region_seed && a.added_on_grid == b.added_on_grid;
}

/// What is wrong with one graph under one option for crossings.
void try_all(const Graph& graph, Crossing crossing, Random& random) {
  Options options;
  options.crossing = crossing;
  options.grid = FixedGrid{};
  options.hole_seeds = some_places(graph, random.below(3), random);
  options.region_seeds = some_places(graph, random.below(3), random);
  options.regions = true;
  const Domain domains[] = {Domain::hull,  Domain::even_odd, Domain::nonzero,
                            Domain::holes, Domain::outer,    Domain::outer_holes};
  const std::size_t shown = random.below(std::size(domains));  // asked further: each costs a call
  for (std::size_t d = 0; d < std::size(domains); ++d) {
    CAPTURE(d);
    options.domain = domains[d];
    const Result result = solver().solve(graph.points, graph.constraints, options);
    const Triangulation mesh = result.download();
    REQUIRE(domain_fault(graph, mesh, options) == "");
    if (d != shown) continue;
    REQUIRE(locate_fault(graph, mesh, result, random) == "");
    REQUIRE(adoption_fault(graph, mesh) == "");
    Graph turned = graph;
    shuffle(turned.constraints, random);
    if (crossing == Crossing::split) {
      const Triangulation other = solver().triangulate(turned.points, turned.constraints, options);
      REQUIRE(other.triangles == mesh.triangles);
      REQUIRE(other.region == mesh.region);
      REQUIRE(other.added_on_grid == mesh.added_on_grid);
    }
    REQUIRE(same(solver().triangulate(graph.points, graph.constraints, options), mesh));
    if (options.domain == Domain::hull) {
      MeshView seen = view(mesh);
      seen.added = mesh.added_on_grid;
      REQUIRE(assess(graph.points, seen, mesh.statistics.grid).valid);
    }
  }
}

}  // namespace

TEST_CASE("crowded graphs: every option for crossings with every domain, located in, adopted and assessed") {
  const std::uint64_t first = number_from("GCDT_CROWDED_FIRST", 1), cases = number_from("GCDT_CROWDED_CASES", 24);
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Graph graph = crowded_graph(random);
    if (seed % 3 == 0) stretch(graph, random);
    const oracle::Split right = oracle::split(graph.wide(), graph.constraints);
    {
      const Triangulation mesh = split(graph);
      REQUIRE(pieces(graph, mesh) == right.pieces);
      REQUIRE(mesh.added_on_grid.size() == right.added.size());
      REQUIRE(mesh.statistics.crossings == right.crossings);
    }
    try_all(graph, Crossing::split, random);
    try_all(graph, Crossing::drop, random);
    if (right.crossings == 0)
      try_all(graph, Crossing::reject, random);
    else
      REQUIRE_THROWS_AS(solver().triangulate(graph.points, graph.constraints), Error);
  }
}

TEST_CASE("crowded graphs at any scale and offset, on the grids that are chosen for them, as each type of number") {
  const double scales[] = {1, 0.1, 1.0 / 3, 1e-17, 1e-300, 5e-324, 4e306, 0x1p40};
  const double offsets[] = {0, 0, 1, -0.7, 5e5, -1e15};
  const std::uint64_t first = number_from("GCDT_CROWDED_FIRST", 1), cases = number_from("GCDT_CROWDED_CASES", 40);
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Graph graph = crowded_graph(random);
    const double scale = scales[random.below(std::size(scales))], x = offsets[random.below(std::size(offsets))],
                 y = offsets[random.below(std::size(offsets))];
    std::vector<std::array<double, 2>> doubles;
    std::vector<std::array<float, 2>> floats;
    std::vector<std::array<std::int64_t, 2>> wide;
    for (const Cell& p : graph.points) {
      doubles.push_back({x + scale * p[0], y + scale * p[1]});
      floats.push_back({static_cast<float>(x + p[0] / 3.0), static_cast<float>(y + p[1] / 3.0)});
      wide.push_back({(std::int64_t{1} << 53) - 40 + p[0], p[1] - (std::int64_t{1} << 53)});
    }
    Options options;
    options.crossing = Crossing::split;
    options.domain = Domain::even_odd;
    for (const gcdt::Points& points : {gcdt::Points(doubles), gcdt::Points(floats), gcdt::Points(wide)}) {
      CAPTURE(static_cast<int>(points.type()));
      const Result result = solver().solve(points, graph.constraints, options);
      const Triangulation mesh = result.download();
      MeshView seen = view(mesh);
      seen.added = mesh.added_on_grid;
      const RegionView said = {mesh.region.data(), mesh.depth.data(), mesh.winding.data()};
      REQUIRE(verify_domain(points, graph.constraints, seen, said, mesh.statistics.grid, options).reason == "");
      REQUIRE(choose_grid(points).cell() == mesh.statistics.grid.cell());
      const auto at = result.vertex_triangles(), found = result.locate(points);
      REQUIRE(std::equal(found.begin(), found.end(), at.begin()));
    }
  }
}
