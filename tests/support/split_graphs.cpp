// SPDX-License-Identifier: Apache-2.0
#include "split_graphs.hpp"

namespace gcdt::test::graphs {

Options splitting() {
  Options options;
  options.crossing = Crossing::split;
  options.grid = FixedGrid{};  // cells of 1: what the points are
  return options;
}

Triangulation split(const Graph& graph, Solver& with) {
  return with.triangulate(graph.points, graph.constraints, splitting());
}

std::string fault(const Graph& graph, const Triangulation& mesh) {
  MeshView seen = view(mesh);
  seen.added = mesh.added_on_grid;
  return verify(graph.points, graph.constraints, seen, mesh.statistics.grid, Crossing::split).reason;
}

oracle::GridPair place(const Graph& graph, const Triangulation& mesh, std::uint32_t v) {
  const auto at = v < graph.points.size() ? graph.points[v] : mesh.added_on_grid.at(v - graph.points.size());
  return {at[0], at[1]};
}

Shape shape(const Graph& graph, const Triangulation& mesh) {
  Shape all;
  for (const auto& t : mesh.triangles)
    all.push_back({place(graph, mesh, t[0]), place(graph, mesh, t[1]), place(graph, mesh, t[2])});
  return all;
}

std::map<oracle::Edge, std::vector<std::uint32_t>> pieces(const Graph& graph, const Triangulation& mesh) {
  std::map<oracle::Edge, std::vector<std::uint32_t>> all;
  for (std::size_t i = 0; i < mesh.pieces.size(); ++i)
    all[oracle::edge_of(place(graph, mesh, mesh.pieces[i][0]), place(graph, mesh, mesh.pieces[i][1]))] = {
        mesh.sources.begin() + mesh.source_offsets[i], mesh.sources.begin() + mesh.source_offsets[i + 1]};
  return all;
}

Graph random_graph(std::uint64_t seed, std::size_t points, std::size_t constraints, std::uint64_t side) {
  Random random(seed);
  Graph graph;
  graph.name = "random " + std::to_string(seed);
  const auto at = [&] { return static_cast<std::int32_t>(random.below(side)); };
  for (std::size_t i = 0; i < points; ++i) {
    const std::int32_t x = at();
    graph.points.push_back({x, at()});
  }
  const auto any = [&] { return static_cast<std::uint32_t>(random.below(points)); };
  for (std::size_t i = 0; i < constraints; ++i) {
    const std::uint32_t a = any();
    graph.constraints.push_back({a, any()});
  }
  return graph;
}

Graph strip(std::uint64_t seed, std::size_t lines, std::int32_t length, std::uint64_t height) {
  Random random(seed);
  Graph graph;
  graph.name = "strip " + std::to_string(seed);
  for (std::uint32_t i = 0; i < lines; ++i) {
    graph.points.push_back({0, static_cast<std::int32_t>(random.below(height))});
    graph.points.push_back({length, static_cast<std::int32_t>(random.below(height))});
    graph.constraints.push_back({2 * i, 2 * i + 1});
  }
  return graph;
}

Graph lattice(std::uint32_t rows, std::int32_t step) {
  Graph graph;
  graph.name = "lattice";
  const std::int32_t far = static_cast<std::int32_t>(rows + 1) * step;
  for (std::uint32_t i = 0; i < rows; ++i) {
    const std::int32_t at = static_cast<std::int32_t>(i + 1) * step;
    for (const auto& p : {std::array{at, 0}, std::array{at, far}, std::array{0, at}, std::array{far, at}})
      graph.points.push_back(p);
    graph.constraints.push_back({4 * i, 4 * i + 1});
    graph.constraints.push_back({4 * i + 2, 4 * i + 3});
  }
  return graph;
}

Graph star(std::uint32_t lines, std::int32_t radius) {
  Graph graph;
  graph.name = "star";
  for (std::uint32_t i = 0; i < lines; ++i) {
    const auto along = static_cast<std::int32_t>(2LL * radius * i / lines);
    const std::int32_t shake = static_cast<std::int32_t>(i % 2);
    graph.points.push_back({along, 0});
    graph.points.push_back({2 * radius - along + shake, 2 * radius});
    graph.constraints.push_back({2 * i, 2 * i + 1});
  }
  return graph;
}

}  // namespace gcdt::test::graphs
