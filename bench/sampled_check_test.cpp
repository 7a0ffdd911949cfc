// SPDX-License-Identifier: Apache-2.0
// The sampled check accepts results and refuses results that were damaged.
#include "sampled_check.hpp"

#include <algorithm>
#include <cstdio>

#include "inputs.hpp"

using namespace gcdt;
using namespace gcdt::bench;

namespace {

constexpr std::size_t samples = 200000;  // of at most 10,000 triangles: each is drawn
int failures = 0;

void expect(const char* name, const char* damage, const std::string& fault, bool valid) {
  if (fault.empty() == valid) return;
  std::printf("%s, %s: %s\n", name, damage, valid ? fault.c_str() : "accepted");
  ++failures;
}

/// The side of triangle t that links to u.
int side_to(const Triangulation& mesh, std::int32_t t, std::int32_t u) {
  const auto& links = mesh.neighbours[t];
  return static_cast<int>(std::find(links.begin(), links.end(), u) - links.begin());
}

/// Flips the edge of t across from corner k, with all links, where that leaves both triangles proper.
///
///        c                c
///      / | \            /   \        t = (a, b, c) across from a: u = (d, c, b)
///     a  |  d   ->     a --- d       t = (a, b, d), u = (a, d, c)
///      \ | /            \   /
///        b                b
bool flip(Points points, Triangulation& mesh, std::int32_t t, int k) {
  const std::int32_t u = mesh.neighbours[t][k];
  if (u < 0 || mesh.constrained[t] || mesh.constrained[u]) return false;
  const int j = side_to(mesh, u, t);
  const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3], c = mesh.triangles[t][(k + 2) % 3];
  const std::uint32_t d = mesh.triangles[u][j];
  const auto turns_left = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    const auto at = [&](std::uint32_t v, int axis) { return points.coordinate(v, axis); };
    return (at(q, 0) - at(p, 0)) * (at(r, 1) - at(p, 1)) - (at(q, 1) - at(p, 1)) * (at(r, 0) - at(p, 0)) > 1e-9;
  };
  if (!turns_left(a, b, d) || !turns_left(a, d, c)) return false;
  const std::int32_t ab = mesh.neighbours[t][(k + 2) % 3], ca = mesh.neighbours[t][(k + 1) % 3];
  const std::int32_t bd = mesh.neighbours[u][(j + 1) % 3], dc = mesh.neighbours[u][(j + 2) % 3];
  mesh.triangles[t] = {a, b, d};
  mesh.neighbours[t] = {bd, u, ab};
  mesh.triangles[u] = {a, d, c};
  mesh.neighbours[u] = {dc, ca, t};
  if (bd >= 0) mesh.neighbours[bd][side_to(mesh, bd, u)] = t;
  if (ca >= 0) mesh.neighbours[ca][side_to(mesh, ca, t)] = u;
  return true;
}

void damage_all(Solver& solver, const Input& input) {
  const Workload work = make(input, [](const std::vector<Point>&) { return Array<std::array<std::uint32_t, 3>>(); });
  const Triangulation good = solver.triangulate(work.points, work.constraints);
  const char* name = input.name.c_str();
  const auto check = [&](const Triangulation& mesh) { return sampled_check(work.points, mesh, samples); };
  expect(name, "whole", check(good), true);

  Triangulation mesh = good;
  std::swap(mesh.triangles[1][0], mesh.triangles[1][1]);
  expect(name, "a triangle turned over", check(mesh), false);

  mesh = good;
  mesh.triangles.pop_back(), mesh.neighbours.pop_back(), mesh.constrained.pop_back();
  expect(name, "a triangle missing", check(mesh), false);

  mesh = good;
  mesh.neighbours[2] = {mesh.neighbours[2][1], mesh.neighbours[2][2], mesh.neighbours[2][0]};
  expect(name, "links rotated", check(mesh), false);

  mesh = good;
  mesh.triangles[3][2] = static_cast<std::uint32_t>(work.points.size());
  expect(name, "a corner that does not exist", check(mesh), false);

  mesh = good;
  for (std::int32_t t = 0, flipped = 0; !flipped && t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
    for (int k = 0; k < 3 && !flipped; ++k) flipped = flip(work.points, mesh, t, k);
  expect(name, "an edge flipped", check(mesh), false);
}

}  // namespace

int main() {
  Solver solver;
  for (const char* name : {"uniform", "grid", "star", "leafs"}) damage_all(solver, {name, 4000, {}});
  return failures;
}
