// SPDX-License-Identifier: Apache-2.0
// Inputs with the reference's meshes of them, and mutations that verify must catch.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "gcdt/verify.hpp"
#include "reference.hpp"

namespace gcdt::mesh_cases {

using reference::ReferenceMesh;

using GridPoints = std::vector<std::array<std::int64_t, 2>>;
using Segments = std::vector<Constraint>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Random = std::mt19937;

inline std::int64_t below(Random& random, std::int64_t limit) {
  return std::uniform_int_distribution<std::int64_t>(0, limit - 1)(random);
}

inline std::int64_t orient(const GridPoints& p, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return (p[b][0] - p[a][0]) * (p[c][1] - p[a][1]) - (p[b][1] - p[a][1]) * (p[c][0] - p[a][0]);
}

inline bool on_segment(const GridPoints& p, Constraint s, std::uint32_t v) {
  const auto [a, b] = s;
  return orient(p, a, b, v) == 0 && std::min(p[a], p[b]) <= p[v] && p[v] <= std::max(p[a], p[b]);
}

/// docs/contract.md, 3, by its words: the interiors meet in a point that is no vertex and not part of a common piece.
inline bool cross(const GridPoints& p, Constraint s, Constraint t) {
  auto sign = [](std::int64_t v) { return (v > 0) - (v < 0); };
  if (sign(orient(p, s[0], s[1], t[0])) * sign(orient(p, s[0], s[1], t[1])) >= 0) return false;
  if (sign(orient(p, t[0], t[1], s[0])) * sign(orient(p, t[0], t[1], s[1])) >= 0) return false;
  for (std::uint32_t v = 0; v < p.size(); ++v)
    if (on_segment(p, s, v) && on_segment(p, t, v)) return false;
  return true;
}

/// The numbers of the constraints that are kept under Crossing::drop.
inline std::vector<std::uint32_t> kept(const GridPoints& p, const Segments& constraints) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t c = 0; c < constraints.size(); ++c)
    if (std::none_of(result.begin(), result.end(),
                     [&](std::uint32_t earlier) { return cross(p, constraints[c], constraints[earlier]); }))
      result.push_back(c);
  return result;
}

inline Segments chosen(const Segments& constraints, const std::vector<std::uint32_t>& numbers) {
  Segments result;
  for (std::uint32_t c : numbers) result.push_back(constraints[c]);
  return result;
}

struct Case {
  std::string name;
  GridPoints grid_points;  ///< distinct
  Segments constraints;
  ReferenceMesh mesh;

  Case(std::string what, GridPoints p, Segments c) : name(std::move(what)), grid_points(std::move(p)) {
    constraints = chosen(c, kept(grid_points, c));
    mesh = reference::reference_mesh(grid_points, constraints);
  }
  std::vector<std::array<double, 2>> points() const {
    std::vector<std::array<double, 2>> result;
    for (auto [x, y] : grid_points) result.push_back({double(x), double(y)});
    return result;
  }
};

inline Verification check(const Case& c, const ReferenceMesh& mesh, bool neighbours = true, bool flags = true) {
  const auto points = c.points();
  MeshView view{mesh.triangles, neighbours ? mesh.neighbours.data() : nullptr,
                flags ? mesh.constrained.data() : nullptr};
  return verify(points, c.constraints, view, choose_grid(points));
}

inline GridPoints distinct(GridPoints points, Random& random) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::shuffle(points.begin(), points.end(), random);
  return points;
}

inline GridPoints random_points(Random& random, int count, std::int64_t size) {
  GridPoints points;
  for (int i = 0; i < count; ++i) points.push_back({below(random, size), below(random, size)});
  return distinct(points, random);
}

inline GridPoints grid_points(Random& random, int side, std::int64_t step) {
  GridPoints points;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) points.push_back({i * step, j * step});
  return distinct(points, random);
}

/// All points of x^2 + y^2 = 1105^2 (36 of them), scaled, and some inside.
inline GridPoints circle_points(Random& random, std::int64_t scale, int inside) {
  GridPoints points;
  for (std::int64_t x = -1105; x <= 1105; ++x)
    for (std::int64_t y = -1105; y <= 1105; ++y)
      if (x * x + y * y == 1105 * 1105) points.push_back({(x + 1105) * scale, (y + 1105) * scale});
  for (int i = 0; i < inside; ++i)
    points.push_back({(800 + below(random, 600)) * scale, (800 + below(random, 600)) * scale});
  return distinct(points, random);
}

/// A square with many points on its sides.
inline GridPoints square_points(Random& random, std::int64_t size) {
  GridPoints points = random_points(random, 20, size);
  for (std::int64_t i : {std::int64_t(0), size})
    for (int j = 0; j < 15; ++j) {
      points.push_back({i, below(random, size + 1)});
      points.push_back({below(random, size + 1), i});
    }
  for (std::int64_t x : {std::int64_t(0), size})
    for (std::int64_t y : {std::int64_t(0), size}) points.push_back({x, y});
  return distinct(points, random);
}

/// Random pairs, some repeated, reversed or of no length.
inline Segments random_constraints(Random& random, const GridPoints& points, int count) {
  Segments constraints;
  const auto n = static_cast<std::int64_t>(points.size());
  for (int i = 0; i < count; ++i) {
    const auto a = static_cast<std::uint32_t>(below(random, n)), b = static_cast<std::uint32_t>(below(random, n));
    constraints.push_back({a, b});
    if (below(random, 6) == 0) constraints.push_back({b, a});
  }
  return constraints;
}

constexpr std::int64_t largest = 0x7fffffff;

inline std::vector<Case> cases(unsigned seed) {
  Random random(seed);
  std::vector<Case> result;
  auto add = [&](const char* name, const GridPoints& points, int count) {
    result.emplace_back(name, points, random_constraints(random, points, count));
  };
  for (int count : {0, 8, 40}) {
    add("random", random_points(random, 60, 1000), count);
    add("few places", random_points(random, 60, 9), count);
    add("31 bits", random_points(random, 60, largest + 1), count);
    add("grid", grid_points(random, 7, 1), count);
    add("wide grid", grid_points(random, 6, largest / 5), count);
    add("circle", circle_points(random, 1, 6), count);
    add("wide circle", circle_points(random, 900000, 0), count);
    add("square", square_points(random, 40), count);
    add("wide square", square_points(random, largest), count);
  }
  return result;
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Edges as (triangle, corner) with a neighbour, constrained or not.
inline std::vector<std::pair<int, int>> inner_edges(const ReferenceMesh& mesh, bool constrained) {
  std::vector<std::pair<int, int>> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbours[t][k] >= 0 && (mesh.constrained[t] >> k & 1) == constrained) edges.push_back({int(t), k});
  return edges;
}

/// Flips the edge if the quadrilateral is strictly convex. Neighbours and flags follow: the new edge is unflagged.
inline bool flip(const GridPoints& p, ReferenceMesh& mesh, int t, int k) {
  const int u = mesh.neighbours[t][k];
  int j = 0;
  while (mesh.neighbours[u][j] != t) ++j;
  const auto a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3], c = mesh.triangles[t][(k + 2) % 3];
  const auto d = mesh.triangles[u][j];
  if (orient(p, a, b, d) <= 0 || orient(p, a, d, c) <= 0) return false;
  std::set<Constraint> flagged;
  for (int s : {t, u})
    for (int i = 0; i < 3; ++i)
      if (mesh.constrained[s] >> i & 1)
        flagged.insert({mesh.triangles[s][(i + 1) % 3], mesh.triangles[s][(i + 2) % 3]});
  mesh.triangles[t] = {a, b, d};
  mesh.triangles[u] = {a, d, c};
  for (int s : {t, u}) {
    mesh.constrained[s] = 0;
    for (int i = 0; i < 3; ++i)
      if (flagged.count({mesh.triangles[s][(i + 1) % 3], mesh.triangles[s][(i + 2) % 3]}))
        mesh.constrained[s] |= static_cast<std::uint8_t>(1 << i);
  }
  mesh.neighbours = reference::link(mesh.triangles);
  return true;
}

/// Changes a mesh by chance; false if it has no place for the change.
using Mutation = std::function<bool(const Case&, ReferenceMesh&, Random&)>;

/// Applies the mutation to every case and requires a failure that names `part`, with the mesh's own neighbours and
/// flags and also from the triangles alone where these change.
inline void must_be_caught(const Mutation& mutate, const std::vector<std::string>& parts, bool triangles_change,
                           int least = 5) {
  int applied = 0;
  Random random(7);
  for (const Case& c : cases(11)) {
    CAPTURE(c.name);
    ReferenceMesh mutant = c.mesh;
    if (!mutate(c, mutant, random)) continue;
    ++applied;
    const auto full = check(c, mutant);
    CHECK_FALSE(full.valid);
    CHECK_FALSE(full.reason.empty());
    const auto bare = triangles_change ? check(c, mutant, false, false) : full;
    CHECK_FALSE(bare.valid);
    const bool named = std::any_of(parts.begin(), parts.end(), [&](auto& part) { return contains(bare.reason, part); });
    CHECK_MESSAGE(named, bare.reason);
  }
  CHECK(applied >= least);
}

inline std::size_t any_triangle(const ReferenceMesh& mesh, Random& random) {
  return static_cast<std::size_t>(below(random, static_cast<std::int64_t>(mesh.triangles.size())));
}

inline void erase_triangle(ReferenceMesh& mesh, std::size_t t) {
  mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  mesh.constrained.erase(mesh.constrained.begin() + static_cast<std::ptrdiff_t>(t));
  mesh.neighbours = reference::link(mesh.triangles);
}

inline const std::vector<std::string> topology_reasons = {"boundary", "corner of no triangle", "triangles, but"};

}  // namespace gcdt::mesh_cases
