// SPDX-License-Identifier: Apache-2.0
// Graphs with crossings for the tests of splitting, and what is asked of their results.
#pragma once

#include "solver_fixture.hpp"
#include "split_oracle.hpp"

namespace gcdt::test::graphs {

struct Graph {
  std::string name;
  std::vector<std::array<std::int32_t, 2>> points;
  std::vector<Constraint> constraints;

  std::vector<oracle::GridPair> wide() const {
    std::vector<oracle::GridPair> all;
    for (const auto& [x, y] : points) all.push_back({x, y});
    return all;
  }
};

Options splitting();

Triangulation split(const Graph& graph, Solver& with = solver());

std::string fault(const Graph& graph, const Triangulation& mesh);

oracle::GridPair place(const Graph& graph, const Triangulation& mesh, std::uint32_t v);

using Shape = std::vector<std::array<oracle::GridPair, 3>>;
Shape shape(const Graph& graph, const Triangulation& mesh);

std::map<oracle::Edge, std::vector<std::uint32_t>> pieces(const Graph& graph, const Triangulation& mesh);

/// `count` points in a square, and random constraints between them.
Graph random_graph(std::uint64_t seed, std::size_t points, std::size_t constraints, std::uint64_t side);

/// Lines from the left of a flat strip to its right: they cross at small angles, many in one pixel.
Graph strip(std::uint64_t seed, std::size_t lines, std::int32_t length, std::uint64_t height);

/// `rows` x `rows` lines from side to side of a square.
Graph lattice(std::uint32_t rows, std::int32_t step);

/// Lines through the middle of a square, from all over its boundary: opposite points are symmetric but for one cell.
Graph star(std::uint32_t lines, std::int32_t radius);

}  // namespace gcdt::test::graphs
