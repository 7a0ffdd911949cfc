// SPDX-License-Identifier: Apache-2.0
// CGAL's CDT on integer coordinates, which its exact predicates take as they are; then the ties by flips.
#include "reference.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <unordered_map>

namespace gcdt::reference {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                                       CGAL::No_constraint_intersection_requiring_constructions_tag>;

using Points = std::vector<std::array<std::int64_t, 2>>;
using Segments = std::vector<std::array<std::uint32_t, 2>>;
__extension__ typedef __int128 Int128;

Int128 incircle(const Points& p, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  Int128 m[3][3];
  const std::uint32_t rows[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    m[i][0] = p[rows[i]][0] - p[d][0];
    m[i][1] = p[rows[i]][1] - p[d][1];
    m[i][2] = m[i][0] * m[i][0] + m[i][1] * m[i][1];
  }
  return m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) - m[1][2] * (m[0][0] * m[2][1] - m[0][1] * m[2][0]) +
         m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
}

ReferenceMesh build(const Points& points, const Segments& constraints) {
  std::vector<std::pair<Kernel::Point_2, std::uint32_t>> sites;
  for (std::uint32_t i = 0; i < points.size(); ++i) sites.push_back({{double(points[i][0]), double(points[i][1])}, i});
  Cdt cdt;
  cdt.insert(sites.begin(), sites.end());
  if (cdt.number_of_vertices() != points.size()) throw std::runtime_error("reference: two points are equal");
  std::vector<Cdt::Vertex_handle> handles(points.size());
  for (auto v = cdt.finite_vertices_begin(); v != cdt.finite_vertices_end(); ++v) handles[v->info()] = v;
  for (const auto& [a, b] : constraints)
    if (a != b) cdt.insert_constraint(handles.at(a), handles.at(b));
  ReferenceMesh mesh;
  if (cdt.dimension() < 2) return mesh;
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) {
    mesh.triangles.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    mesh.constrained.push_back(
        static_cast<std::uint8_t>(f->is_constrained(0) | f->is_constrained(1) << 1 | f->is_constrained(2) << 2));
  }
  mesh.neighbours = link(mesh.triangles);
  return mesh;
}

int corner_towards(const ReferenceMesh& mesh, std::int32_t t, std::int32_t neighbour) {
  for (int k = 0; k < 3; ++k)
    if (mesh.neighbours[t][k] == neighbour) return k;
  throw std::logic_error("reference: a link is one-sided");
}

/// (x, y) order; the diagonal must end in the least of the four.
bool tie_is_wrong(const Points& p, std::uint32_t apex, std::uint32_t from, std::uint32_t to, std::uint32_t opposite) {
  return std::min(p[apex], p[opposite]) < std::min(p[from], p[to]);
}

/// Flips the edge across from corner k of t:   t = (a, b, c), u = (d, c, b)  ->  t = (a, b, d), u = (d, c, a).
///
///         c                 c
///        /|\               / \         t keeps edge ab and takes bd from u;
///       a | d     ->      a---d        u keeps edge dc and takes ca from t.
///        \|/               \ /
///         b                 b
void flip(ReferenceMesh& mesh, std::int32_t t, int k) {
  const std::int32_t u = mesh.neighbours[t][k];
  const int j = corner_towards(mesh, u, t);
  const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3], c = mesh.triangles[t][(k + 2) % 3];
  const std::uint32_t d = mesh.triangles[u][j];
  const std::int32_t ca = mesh.neighbours[t][(k + 1) % 3], ab = mesh.neighbours[t][(k + 2) % 3];
  const std::int32_t bd = mesh.neighbours[u][(j + 1) % 3], dc = mesh.neighbours[u][(j + 2) % 3];
  auto flag = [&](std::int32_t s, int i) { return mesh.constrained[s] >> i % 3 & 1; };
  const int flag_ca = flag(t, k + 1), flag_ab = flag(t, k + 2), flag_bd = flag(u, j + 1), flag_dc = flag(u, j + 2);
  if (bd >= 0) mesh.neighbours[bd][corner_towards(mesh, bd, u)] = t;
  if (ca >= 0) mesh.neighbours[ca][corner_towards(mesh, ca, t)] = u;
  mesh.triangles[t] = {a, b, d};
  mesh.neighbours[t] = {bd, u, ab};
  mesh.constrained[t] = static_cast<std::uint8_t>(flag_bd | flag_ab << 2);
  mesh.triangles[u] = {d, c, a};
  mesh.neighbours[u] = {ca, t, dc};
  mesh.constrained[u] = static_cast<std::uint8_t>(flag_ca | flag_dc << 2);
}

/// Ends, since the tie rule is Lawson's on heights |p|^2 - eps with eps largest for the least point.
void settle_ties(const Points& points, ReferenceMesh& mesh) {
  std::vector<std::int32_t> pending(mesh.triangles.size());
  for (std::size_t t = 0; t < pending.size(); ++t) pending[t] = static_cast<std::int32_t>(t);
  while (!pending.empty()) {
    const std::int32_t t = pending.back();
    pending.pop_back();
    for (int k = 0; k < 3; ++k) {
      const std::int32_t u = mesh.neighbours[t][k];
      if (u < 0 || (mesh.constrained[t] >> k & 1)) continue;
      const auto [a, b, c] =
          std::array{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]};
      const std::uint32_t d = mesh.triangles[u][corner_towards(mesh, u, t)];
      const Int128 inside = incircle(points, a, b, c, d);
      if (inside > 0) throw std::logic_error("reference: CGAL's mesh is not Delaunay");
      if (inside < 0 || !tie_is_wrong(points, a, b, c, d)) continue;
      flip(mesh, t, k);
      pending.push_back(t);
      pending.push_back(u);
      break;
    }
  }
}

void sort_canonically(const Points& points, ReferenceMesh& mesh) {
  std::vector<std::uint64_t> z(points.size());
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = morton(points[i]);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& corners = mesh.triangles[t];
    int first = 0;
    for (int k = 1; k < 3; ++k)
      if (z[corners[k]] < z[corners[first]]) first = k;
    std::rotate(corners.begin(), corners.begin() + first, corners.end());
    mesh.constrained[t] =
        static_cast<std::uint8_t>((mesh.constrained[t] >> first | mesh.constrained[t] << (3 - first)) & 7);
  }
  std::vector<std::uint32_t> order(mesh.triangles.size());
  for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
  std::sort(order.begin(), order.end(), [&](std::uint32_t s, std::uint32_t t) {
    const auto &a = mesh.triangles[s], &b = mesh.triangles[t];
    return std::pair(z[a[0]], z[a[1]]) < std::pair(z[b[0]], z[b[1]]);
  });
  ReferenceMesh sorted;
  for (std::uint32_t t : order) {
    sorted.triangles.push_back(mesh.triangles[t]);
    sorted.constrained.push_back(mesh.constrained[t]);
  }
  sorted.neighbours = link(sorted.triangles);
  mesh = std::move(sorted);
}

}  // namespace

std::uint64_t morton(std::array<std::int64_t, 2> point) {
  std::uint64_t code = 0;
  for (int i = 0; i < 31; ++i)
    code |= std::uint64_t(point[0] >> i & 1) << 2 * i | std::uint64_t(point[1] >> i & 1) << (2 * i + 1);
  return code;
}

std::vector<std::array<std::int32_t, 3>> link(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::unordered_map<std::uint64_t, std::int32_t> by_edge;
  by_edge.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      by_edge[std::uint64_t(triangles[t][(k + 1) % 3]) << 32 | triangles[t][(k + 2) % 3]] =
          static_cast<std::int32_t>(t);
  std::vector<std::array<std::int32_t, 3>> neighbours(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto found = by_edge.find(std::uint64_t(triangles[t][(k + 2) % 3]) << 32 | triangles[t][(k + 1) % 3]);
      neighbours[t][k] = found == by_edge.end() ? -1 : found->second;
    }
  return neighbours;
}

ReferenceMesh reference_mesh(const Points& points, const Segments& constraints) {
  ReferenceMesh mesh = build(points, constraints);
  settle_ties(points, mesh);
  sort_canonically(points, mesh);
  return mesh;
}

std::vector<std::array<std::uint32_t, 3>> reference_cdt(const Points& points, const Segments& constraints) {
  return reference_mesh(points, constraints).triangles;
}

}  // namespace gcdt::reference
