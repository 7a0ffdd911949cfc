// SPDX-License-Identifier: Apache-2.0
// Bytes as a planar straight-line graph with small integer coordinates, and back. Any bytes are one, and degeneracies
// are the rule: there are few places, and many vertices on them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gcdt::fuzz {

/// What is done with a graph; see pipeline_fuzz.cpp. A byte each.
struct Choices {
  std::uint8_t crossing = 0, domain = 0, scale = 0, way = 0, refinement = 0, seeds = 0;
};
constexpr std::size_t choice_bytes = 6;

struct Graph {
  Choices choices;
  std::vector<std::array<std::uint8_t, 2>> vertices;
  std::vector<std::array<std::uint8_t, 2>> constraints;  ///< vertex numbers, all of vertices that are there
};

/// Vertex numbers are bytes.
constexpr std::size_t most_vertices = 255, most_constraints = 1000;

/// The choices; the number of vertices; two bytes for each; two for each constraint. What is missing is left out.
inline Graph decode(const std::uint8_t* data, std::size_t size) {
  Graph graph;
  std::size_t at = 0;
  const auto next = [&] { return at < size ? data[at++] : std::uint8_t{0}; };
  Choices& c = graph.choices;
  for (std::uint8_t* choice : {&c.crossing, &c.domain, &c.scale, &c.way, &c.refinement, &c.seeds}) *choice = next();
  for (std::size_t i = next(); i > 0 && size - at >= 2; --i) {
    const std::uint8_t x = next();
    graph.vertices.push_back({x, next()});
  }
  const std::size_t n = graph.vertices.size();
  while (n > 0 && at < size && size - at >= 2 && graph.constraints.size() < most_constraints) {
    const auto a = static_cast<std::uint8_t>(next() % n);
    graph.constraints.push_back({a, static_cast<std::uint8_t>(next() % n)});
  }
  return graph;
}

/// As many bytes as `most`, of what decode() reads back; less of the graph if it does not fit.
inline std::size_t encode(const Graph& graph, std::uint8_t* data, std::size_t most) {
  std::size_t at = 0;
  const auto put = [&](std::size_t byte) {
    if (at < most) data[at++] = static_cast<std::uint8_t>(byte);
  };
  const Choices& c = graph.choices;
  for (const std::uint8_t choice : {c.crossing, c.domain, c.scale, c.way, c.refinement, c.seeds}) put(choice);
  put(graph.vertices.size());
  for (const auto& [x, y] : graph.vertices) put(x), put(y);
  for (const auto& [a, b] : graph.constraints) put(a), put(b);
  return at;
}

}  // namespace gcdt::fuzz
