// SPDX-License-Identifier: Apache-2.0
// The host's proof of splitting, with meshes that were split wrongly.
#include <doctest/doctest.h>

#include "split_graphs.hpp"

using namespace gcdt;
using namespace gcdt::test;
using namespace gcdt::test::graphs;

namespace {

/// The mesh of `links` over the points and added vertices, as a splitter might have made it.
std::string fault_of(const Graph& graph, const std::vector<std::array<std::int32_t, 2>>& added,
                     const std::vector<std::array<oracle::GridPair, 2>>& links,
                     std::set<oracle::Edge>* edges = nullptr) {
  Graph made = graph;
  made.points.insert(made.points.end(), added.begin(), added.end());
  std::map<oracle::GridPair, std::uint32_t> number;
  for (std::uint32_t v = 0; v < made.points.size(); ++v) number.insert({{made.points[v][0], made.points[v][1]}, v});
  made.constraints.clear();
  for (const auto& [a, b] : links) made.constraints.push_back({number.at(a), number.at(b)});
  Options options = splitting();
  options.crossing = Crossing::reject;
  Triangulation mesh = solver().triangulate(made.points, made.constraints, options);
  mesh.added_on_grid.assign(added.begin(), added.end());
  if (edges)
    for (const auto& piece : pieces(graph, mesh)) edges->insert(piece.first);
  return fault(graph, mesh);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A graph, how it is split, and what of that the functions below change.
struct Split {
  const Graph& graph;
  const oracle::Split right;
  std::vector<std::array<std::int32_t, 2>> added;
  std::vector<std::array<oracle::GridPair, 2>> links;
  std::set<oracle::GridPair> taken;

  explicit Split(const Graph& of) : graph(of), right(oracle::split(of.wide(), of.constraints)) {
    for (const auto& [at, pair] : right.added)
      added.push_back({static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1])});
    for (const auto& chain : right.links)
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) links.push_back({chain[i], chain[i + 1]});
    for (const auto& p : graph.wide()) taken.insert(p);
    for (const auto& [at, pair] : right.added) taken.insert(at);
  }
};

// One more vertex, where none cross. Returns how many were tried, as do the others.
int reject_one_more(const Split& split, std::uint64_t seed) {
  Random random(seed);
  const oracle::GridPair extra = {static_cast<std::int64_t>(random.below(30)),
                                  static_cast<std::int64_t>(random.below(6))};
  auto more = split.added;
  more.push_back({static_cast<std::int32_t>(extra[0]), static_cast<std::int32_t>(extra[1])});
  std::sort(more.begin(), more.end());
  bool free = !split.taken.count(extra);
  for (const auto& [a, b] : split.links) free &= !oracle::meets(a, b, extra);
  if (!free) return 0;
  CHECK(fault_of(split.graph, more, split.links) != "");
  return 1;
}

// A routed constraint that leaves out a vertex where it bends, if what is left does not cross others.
int reject_shortcuts(const Split& split) {
  const oracle::Split& right = split.right;
  int routed = 0;
  for (std::uint32_t c : right.moved) {
    const auto& chain = right.links[c];
    for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
      if (oracle::turn(chain[i - 1], chain[i], chain[i + 1]) == 0) continue;
      auto fewer = split.links;
      for (std::size_t j : {i - 1, i})
        if (right.pieces.at(oracle::edge_of(chain[j], chain[j + 1])).size() == 1)
          fewer.erase(std::remove(fewer.begin(), fewer.end(), std::array{chain[j], chain[j + 1]}), fewer.end());
      fewer.push_back({chain[i - 1], chain[i + 1]});
      std::string reason;
      std::set<oracle::Edge> edges, all;
      for (const auto& piece : right.pieces) all.insert(piece.first);
      try {
        reason = fault_of(split.graph, split.added, fewer, &edges);
      } catch (const Error& error) {
        CHECK(error.status() == Status::constraints_cross);
        continue;
      }
      CHECK((reason == "") == (edges == all));  // others may run along the edges
      routed += edges != all;
    }
  }
  return routed;
}

// A vertex beside the pixel where it must be.
int reject_shifted(const Split& split) {
  if (split.added.empty()) return 0;
  auto shifted = split.added;
  shifted[0][0] += 1;
  std::sort(shifted.begin(), shifted.end());
  if (split.taken.count({shifted[0][0], shifted[0][1]}) ||
      std::adjacent_find(shifted.begin(), shifted.end()) != shifted.end())
    return 0;
  CHECK(fault_of(split.graph, shifted, {}) != "");
  return 1;
}

}  // namespace

TEST_CASE("the verification rejects a vertex too many or too few, and constraints routed wrongly") {
  int routed = 0, added_wrongly = 0, lacking = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Graph graph = seed % 2 ? random_graph(300 + seed, 16, 10, 30) : strip(seed, 8, 300, 6);
    CAPTURE(graph.name);
    const Split split(graph);
    CHECK(fault_of(graph, split.added, split.links) == "");
    added_wrongly += reject_one_more(split, seed);
    routed += reject_shortcuts(split);
    lacking += reject_shifted(split);
  }
  CHECK(routed > 30);
  CHECK(added_wrongly > 20);
  CHECK(lacking > 20);
}

TEST_CASE("the verification names a duplicate, a disorder and a vertex outside the grid") {
  const Graph graph{"pair", {{0, 0}, {4, 4}, {0, 4}, {4, 0}}, {{0, 1}, {2, 3}}};
  Triangulation mesh = split(graph);
  REQUIRE(mesh.added_on_grid.size() == 1);
  CHECK(fault(graph, mesh) == "");
  mesh.added_on_grid = {{2, -2}};
  CHECK(contains(fault(graph, mesh), "added vertex 4 is outside the grid"));
  mesh.added_on_grid = {{4, 4}};
  CHECK(contains(fault(graph, mesh), "added vertex 4 is where vertex 1 is"));
  mesh.added_on_grid = {{3, 2}, {2, 2}};
  CHECK(contains(fault(graph, mesh), "are not in order"));
  // Both pass the pixel of vertex 4, and cross at (50, 5).
  const Graph narrow{"narrow", {{0, 0}, {100, 10}, {0, 1}, {100, 9}, {48, 5}}, {{0, 1}, {2, 3}}};
  const oracle::GridPair near = {48, 5}, cross = {50, 5}, ends[] = {{0, 0}, {100, 10}, {0, 1}, {100, 9}};
  CHECK(fault_of(narrow, {{50, 5}},
                 {{ends[0], near}, {ends[2], near}, {near, cross}, {cross, ends[1]}, {cross, ends[3]}}) == "");
  CHECK(contains(fault_of(narrow, {}, {{ends[0], near}, {ends[2], near}, {near, ends[1]}, {near, ends[3]}}),
                 "cross, but no vertex was added at grid point (50, 5)"));
}
