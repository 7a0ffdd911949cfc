// SPDX-License-Identifier: Apache-2.0
// Crossing::split: against the definition by brute force, and what docs/splitting.md promises.
#include <doctest/doctest.h>

#include "corpus.hpp"
#include "device_list.hpp"
#include "split_graphs.hpp"

using namespace gcdt;
using namespace gcdt::test;
using namespace gcdt::test::graphs;

namespace {

// Before anything else lists devices.
const std::size_t device_count = every_device().size();

void must_be_as_defined(const Graph& graph, std::uint64_t& closures) {
  CAPTURE(graph.name);
  const oracle::Split expected = oracle::split(graph.wide(), graph.constraints);
  const Triangulation mesh = split(graph);
  CHECK(fault(graph, mesh) == "");
  const Statistics& s = mesh.statistics;
  CHECK(s.crossings == expected.crossings);
  CHECK(s.vertices_added == expected.added.size());
  CHECK(s.constraints_split == expected.moved.size());
  REQUIRE(mesh.added_on_grid.size() == expected.added.size());
  REQUIRE(mesh.added_crossing.size() == expected.added.size());
  std::size_t i = 0;
  for (const auto& [at, pair] : expected.added) {  // in order of x, then y
    CHECK(place(graph, mesh, static_cast<std::uint32_t>(graph.points.size() + i)) == at);
    CHECK(mesh.added_crossing[i] == pair);
    CHECK(mesh.added[i] == std::array<double, 2>{double(at[0]), double(at[1])});
    CHECK(mesh.representative[graph.points.size() + i] == graph.points.size() + i);
    ++i;
  }
  CHECK(pieces(graph, mesh) == expected.pieces);
  // The move, once more: the largest distance of a vertex of a routed constraint from it.
  double move = 0;
  std::uint64_t crossing = 0;
  for (std::uint32_t c : expected.moved) {
    const auto& links = expected.links[c];
    const auto a = links.front(), b = links.back();
    for (const auto& h : links) {
      const oracle::Integer area = oracle::turn(a, b, h), dx = b[0] - a[0], dy = b[1] - a[1];
      CHECK(2 * area * area <= dx * dx + dy * dy);  // half the diagonal of a cell
      move = std::max(move, std::fabs(oracle::turn(a, b, h).convert_to<double>()) /
                                std::hypot(double(b[0] - a[0]), double(b[1] - a[1])));
    }
    for (std::uint32_t d = 0; d < graph.constraints.size(); ++d) {
      const auto &p = graph.points[graph.constraints[d][0]], &q = graph.points[graph.constraints[d][1]];
      crossing += oracle::crossing(a, b, {p[0], p[1]}, {q[0], q[1]}) ? 1 : 0;
    }
  }
  closures += expected.crossings == 0 ? 0 : crossing < expected.moved.size();
  CHECK(s.constraint_move == doctest::Approx(move).epsilon(1e-12));
}

}  // namespace

TEST_CASE("split is as defined, against brute force in rational arithmetic") {
  std::uint64_t closures = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    must_be_as_defined(random_graph(seed, 12, 10, 12), closures);  // several vertices in one pixel's reach
    must_be_as_defined(random_graph(100 + seed, 40, 24, 60), closures);
    must_be_as_defined(random_graph(200 + seed, 30, 14, 1u << 31), closures);  // the whole grid
  }
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    must_be_as_defined(strip(seed, 14, 400, 12), closures);
    must_be_as_defined(strip(seed, 12, 2147483647, 6), closures);
    must_be_as_defined(strip(100 + seed, 10, 2147483647, 1u << 31), closures);
  }
  must_be_as_defined(random_graph(900, 240, 120, 1u << 31), closures);  // long segments by the hundred
  CHECK(closures > 0);  // some constraint was routed only since it would cross a routed one
}

TEST_CASE("without crossings, split is reject: nothing moves, whatever is close to a constraint") {
  Graph graph{"close", {{0, 0}, {1000, 1}, {500, 1}, {300, 0}, {0, 9}, {9, 9}}, {{0, 1}, {4, 5}}};
  const Triangulation mesh = split(graph);
  Options options = splitting();
  options.crossing = Crossing::reject;
  const Triangulation other = solver().triangulate(graph.points, graph.constraints, options);
  CHECK(mesh.triangles == other.triangles);
  CHECK(mesh.pieces == other.pieces);
  CHECK(mesh.statistics.constraints_split == 0);
  CHECK(mesh.representative.size() == graph.points.size());
  CHECK(fault(graph, mesh) == "");
}

TEST_CASE("permuted and reversed constraints, and permuted vertices, give the same triangles") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Graph graph = seed % 2 ? random_graph(seed, 60, 40, 200) : strip(seed, 30, 100000, 40);
    const Triangulation mesh = split(graph);
    REQUIRE(mesh.statistics.vertices_added > 0);
    Random random(seed);
    Graph other = graph;
    for (std::size_t i = other.constraints.size(); i > 1; --i) {
      std::swap(other.constraints[i - 1], other.constraints[random.below(i)]);
      if (random.below(2)) std::swap(other.constraints[i - 1][0], other.constraints[i - 1][1]);
    }
    const Triangulation permuted = split(other);
    CHECK(permuted.triangles == mesh.triangles);
    CHECK(permuted.neighbours == mesh.neighbours);
    CHECK(permuted.constrained == mesh.constrained);
    CHECK(permuted.pieces == mesh.pieces);
    CHECK(permuted.added_on_grid == mesh.added_on_grid);

    std::vector<std::uint32_t> place_of(graph.points.size());
    for (std::uint32_t v = 0; v < place_of.size(); ++v) place_of[v] = v;
    for (std::size_t i = place_of.size(); i > 1; --i) std::swap(place_of[i - 1], place_of[random.below(i)]);
    for (std::uint32_t v = 0; v < place_of.size(); ++v) other.points[place_of[v]] = graph.points[v];
    other.constraints = graph.constraints;
    for (Constraint& c : other.constraints) c = {place_of[c[0]], place_of[c[1]]};
    CHECK(shape(other, split(other)) == shape(graph, mesh));
  }
}

TEST_CASE("translation on the grid moves the result, and nothing else") {
  const Graph graph = strip(7, 40, 1000, 30);
  const Triangulation mesh = split(graph);
  Graph moved = graph;
  for (auto& [x, y] : moved.points) x += 12345, y += 777;
  const Triangulation other = split(moved);
  REQUIRE(other.added_on_grid.size() == mesh.added_on_grid.size());
  for (std::size_t i = 0; i < other.added_on_grid.size(); ++i)
    CHECK(other.added_on_grid[i] ==
          std::array<std::int32_t, 2>{mesh.added_on_grid[i][0] + 12345, mesh.added_on_grid[i][1] + 777});
  const auto before = pieces(graph, mesh), after = pieces(moved, other);
  REQUIRE(after.size() == before.size());
  for (const auto& [edge, sources] : before) {
    const auto shifted = [](const oracle::GridPair& p) { return oracle::GridPair{p[0] + 12345, p[1] + 777}; };
    CHECK(after.at({shifted(edge[0]), shifted(edge[1])}) == sources);
  }
}

TEST_CASE("every device gives the same bytes") {
  const Graph graphs[] = {random_graph(5, 80, 60, 300), strip(3, 40, 1 << 30, 60), lattice(20, 3), star(60, 500)};
  std::vector<Triangulation> first;
  for (std::size_t number = 0; number < device_count; ++number) {
    Solver device(std::to_string(number));
    for (std::size_t i = 0; i < std::size(graphs); ++i) {
      const Triangulation mesh = split(graphs[i], device);
      if (number == 0) first.push_back(mesh);
      CHECK(mesh.triangles == first[i].triangles);
      CHECK(mesh.pieces == first[i].pieces);
      CHECK(mesh.sources == first[i].sources);
      CHECK(mesh.added_on_grid == first[i].added_on_grid);
      CHECK(mesh.added_crossing == first[i].added_crossing);
    }
  }
  CHECK(device_count >= 2);
}

TEST_CASE("a lattice of 500 x 500 lines has 250,000 crossings, all vertices, and nothing moves") {
  const Graph graph = lattice(500, 1 << 20);
  const Triangulation mesh = split(graph);
  CHECK(mesh.statistics.crossings == 250000);
  CHECK(mesh.statistics.vertices_added == 250000);
  CHECK(mesh.statistics.constraint_move == 0);
  CHECK(mesh.pieces.size() == 2 * 500 * 501);
  CHECK(fault(graph, mesh) == "");
}

TEST_CASE("a star of lines through one pixel: pairs by the million, few vertices") {
  const Graph graph = star(3000, 1 << 29);  // more pairs than are looked at together
  const Triangulation mesh = split(graph);
  // Opposite points of every second line are shifted by one: all lines pass within half a cell of the centre.
  CHECK(mesh.statistics.crossings == 3000 * 2999 / 2);
  CHECK(mesh.statistics.vertices_added < 20000);
  CHECK(fault(graph, mesh) == "");
}

TEST_CASE("lines that overlap keep all their constraints, also where they are crossed") {
  // Two constraints on one line, overlapping from 4 to 8, crossed at 6 by a third, at 2 by a fourth.
  Graph graph{
      "overlap", {{0, 5}, {8, 5}, {4, 5}, {12, 5}, {6, 0}, {6, 9}, {2, 0}, {2, 9}}, {{0, 1}, {2, 3}, {4, 5}, {6, 7}}};
  const Triangulation mesh = split(graph);
  CHECK(mesh.statistics.crossings == 3);
  CHECK(mesh.added_on_grid == std::vector<std::array<std::int32_t, 2>>{{2, 5}, {6, 5}});
  CHECK(mesh.added_crossing == std::vector<Constraint>{{0, 3}, {0, 2}});
  const auto all = pieces(graph, mesh);
  CHECK(all.at({{{4, 5}, {6, 5}}}) == std::vector<std::uint32_t>{0, 1});
  CHECK(all.at({{{6, 5}, {8, 5}}}) == std::vector<std::uint32_t>{0, 1});
  CHECK(all.at({{{8, 5}, {12, 5}}}) == std::vector<std::uint32_t>{1});
  CHECK(fault(graph, mesh) == "");
}

TEST_CASE("every file of the corpus can be split, and is verified") {
  const std::string folder = std::string(GCDT_TEST_DATA) + "/corpus";
  Options options;
  options.crossing = Crossing::split;
  int with_crossings = 0;
  for (const CorpusEntry& entry : read_manifest(folder)) {
    if (entry.status == "invalid") continue;
    CAPTURE(entry.name);
    const Workload work = read_poly(folder + "/" + entry.name);
    const Triangulation mesh = solver().triangulate(work.points, work.constraints, options);
    CHECK(static_cast<long>(mesh.statistics.crossings) == entry.crossings);
    CHECK((mesh.statistics.constraints_split > 0) == (entry.crossings > 0));
    // Each added vertex inside the hull makes two more triangles.
    CHECK(static_cast<long>(mesh.triangles.size()) == entry.triangles + 2 * static_cast<long>(mesh.added.size()));
    MeshView seen = view(mesh);
    seen.added = mesh.added_on_grid;
    CHECK(verify(work.points, work.constraints, seen, mesh.statistics.grid, Crossing::split).reason == "");
    with_crossings += entry.crossings > 0;
  }
  CHECK(with_crossings >= 9);
}

TEST_CASE("numbers of any offset and size are split: what comes back is on the grid that is reported") {
  const Graph base = random_graph(77, 60, 40, 1000);
  const double scales[] = {1, 0.1, 1e-3, 1e297, 5e-324, 1e-20, 1.0 / 3}, offsets[] = {0, 500000, 1e9, -1e15};
  int between_doubles = 0;
  for (const double scale : scales)
    for (const double offset : offsets) {
      if (offset != 0 && (scale > 1 || scale < 1e-3)) continue;
      CAPTURE(scale);
      CAPTURE(offset);
      std::vector<std::array<double, 2>> points;
      for (const auto& [x, y] : base.points) points.push_back({x * scale + offset, y * scale - offset});
      Options options;
      options.crossing = Crossing::split;
      const Triangulation mesh = solver().triangulate(points, base.constraints, options);
      const Grid& grid = mesh.statistics.grid;
      CHECK(mesh.statistics.vertices_added > 100);
      CHECK(mesh.statistics.constraint_move <= 0.70711 * grid.cell());
      MeshView seen = view(mesh);
      seen.added = mesh.added_on_grid;
      CHECK(verify(points, base.constraints, seen, grid, Crossing::split).reason == "");
      CHECK(mesh.added == grid_coordinates(grid, mesh.added_on_grid));
      between_doubles += grid_points(grid, mesh.added) != mesh.added_on_grid;
      CHECK(std::is_sorted(mesh.added_on_grid.begin(), mesh.added_on_grid.end()));
    }
  CHECK(between_doubles > 0);  // a grid finer than the doubles there
  // float, int32 and int64 vertices give what the same doubles give.
  std::vector<std::array<float, 2>> floats;
  std::vector<std::array<std::int64_t, 2>> longs;
  std::vector<std::array<double, 2>> doubles;
  for (const auto& [x, y] : base.points) {
    floats.push_back({static_cast<float>(x), static_cast<float>(y)});
    longs.push_back({x, y});
    doubles.push_back({static_cast<double>(x), static_cast<double>(y)});
  }
  Options options;
  options.crossing = Crossing::split;
  const Triangulation expected = solver().triangulate(doubles, base.constraints, options);
  for (const Triangulation& mesh :
       {solver().triangulate(floats, base.constraints, options), solver().triangulate(longs, base.constraints, options),
        solver().triangulate(base.points, base.constraints, options)}) {
    CHECK(mesh.triangles == expected.triangles);
    CHECK(mesh.added_on_grid == expected.added_on_grid);
    CHECK(mesh.added_crossing == expected.added_crossing);
  }
}

TEST_CASE("nothing, one, two and three vertices, and vertices on a line, have nothing to be split") {
  for (const Graph& graph :
       {Graph{"none", {}, {}}, Graph{"one", {{5, 5}}, {{0, 0}}}, Graph{"two", {{0, 0}, {9, 9}}, {{0, 1}}},
        Graph{"three", {{0, 0}, {9, 0}, {0, 9}}, {{0, 1}, {1, 2}, {2, 0}, {0, 1}}},
        Graph{"line", {{0, 0}, {9, 9}, {3, 3}, {6, 6}}, {{0, 3}, {2, 1}}}}) {
    CAPTURE(graph.name);
    const Triangulation mesh = split(graph);
    CHECK(mesh.added.empty());
    CHECK(mesh.statistics.crossings == 0);
    CHECK(fault(graph, mesh) == "");
  }
}

TEST_CASE("a crossing on a tie is rounded up, on both axes") {
  // (0, 0)-(3, 3) and (0, 3)-(3, 0) cross at (1.5, 1.5).
  Graph graph{"tie", {{0, 0}, {3, 3}, {0, 3}, {3, 0}}, {{0, 1}, {2, 3}}};
  CHECK(split(graph).added_on_grid == std::vector<std::array<std::int32_t, 2>>{{2, 2}});
}
