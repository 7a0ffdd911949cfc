// SPDX-License-Identifier: Apache-2.0
// Whole results against brute force and against CGAL: every statement of docs/contract.md, 2 to 5, that a small
// input allows to be recomputed plainly.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "oracle.hpp"
#include "reference.hpp"

namespace gcdt::test {

namespace detail {

inline std::string order_fault(const std::vector<GridPoint>& points, const Triangulation& mesh) {
  const auto z = [&](std::uint32_t v) { return morton(points[v]); };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if (z(t[0]) >= z(t[1]) || z(t[0]) >= z(t[2])) return "a triangle does not start with its first vertex in Z-order";
    if (i == 0) continue;
    const auto& before = mesh.triangles[i - 1];
    if (std::make_pair(z(before[0]), z(before[1])) >= std::make_pair(z(t[0]), z(t[1])))
      return "triangles are not in Z-order";
  }
  for (std::size_t i = 0; i < mesh.pieces.size(); ++i) {
    const Constraint& p = mesh.pieces[i];
    if (z(p[0]) >= z(p[1])) return "a piece's ends are not in Z-order";
    if (i > 0 && std::make_pair(z(mesh.pieces[i - 1][0]), z(mesh.pieces[i - 1][1])) >= std::make_pair(z(p[0]), z(p[1])))
      return "pieces are not in Z-order";
  }
  return {};
}

inline std::string pieces_fault(const std::vector<GridPoint>& points, const Triangulation& mesh,
                                const std::map<Edge, std::vector<std::uint32_t>>& expected) {
  if (mesh.source_offsets.size() != mesh.pieces.size() + 1) return "source_offsets has the wrong length";
  if (mesh.source_offsets.front() != 0 || mesh.source_offsets.back() != mesh.sources.size())
    return "source_offsets has wrong ends";
  std::map<Edge, std::vector<std::uint32_t>> found;
  for (std::size_t i = 0; i < mesh.pieces.size(); ++i) {
    const Constraint& p = mesh.pieces[i];
    if (mesh.representative[p[0]] != p[0] || mesh.representative[p[1]] != p[1])
      return "a piece ends in a merged vertex";
    if (mesh.source_offsets[i] > mesh.source_offsets[i + 1]) return "source_offsets decreases";
    found[edge(points[p[0]], points[p[1]])].assign(mesh.sources.begin() + mesh.source_offsets[i],
                                                   mesh.sources.begin() + mesh.source_offsets[i + 1]);
  }
  if (found.size() != mesh.pieces.size()) return "a piece is listed twice";
  return found == expected ? "" : "pieces or their sources differ";
}

inline std::string statistics_fault(const std::vector<GridPoint>& points, const std::vector<Segment>& constraints,
                                    const Triangulation& mesh) {
  const Statistics& s = mesh.statistics;
  std::uint64_t merged = 0, zero = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) merged += mesh.representative[i] != i;
  for (const Segment& c : constraints) zero += points[c[0]] == points[c[1]];
  std::ostringstream fault;
  const auto expect = [&](const char* name, std::uint64_t found, std::uint64_t expected) {
    if (found != expected) fault << "statistics." << name << " is " << found << ", not " << expected << "; ";
  };
  expect("n", s.n, points.size());
  expect("m", s.m, constraints.size());
  expect("vertices_merged", s.vertices_merged, merged);
  expect("constraints_zero", s.constraints_zero, zero);
  expect("constraints_dropped", s.constraints_dropped, mesh.dropped.size());
  expect("crossings", s.crossings, crossings(points, constraints).size());
  expect("triangles", s.triangles, mesh.triangles.size());
  expect("vertices_added", s.vertices_added, 0);
  return fault.str();
}

/// CGAL's triangles in canonical order and in input numbers. Points from 0 on, duplicates allowed.
inline Triangles reference_triangles(const std::vector<GridPoint>& points, std::vector<Segment> constraints) {
  const std::vector<std::uint32_t> representative = representatives(points);
  std::vector<std::uint32_t> place(points.size()), number;  // into the distinct points and back
  std::vector<GridPoint> distinct;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    place[i] = representative[i] == i ? static_cast<std::uint32_t>(distinct.size()) : place[representative[i]];
    if (representative[i] != i) continue;
    distinct.push_back(points[i]);
    number.push_back(i);
  }
  for (Segment& s : constraints) s = {place[s[0]], place[s[1]]};
  Triangles triangles = reference::reference_cdt(distinct, constraints);
  for (auto& t : triangles)
    for (std::uint32_t& v : t) v = number[v];
  return triangles;
}

}  // namespace detail

/// Empty if `mesh` is what docs/contract.md says for `points` (on the grid) and `constraints` under `crossing`.
inline std::string disagreement(const std::vector<GridPoint>& points, const std::vector<Segment>& constraints,
                                const Triangulation& mesh, Crossing crossing = Crossing::reject) {
  using namespace detail;
  if (mesh.representative != representatives(points)) return "representatives differ";
  const std::vector<std::uint32_t> without =
      crossing == Crossing::drop ? dropped(points, constraints) : std::vector<std::uint32_t>{};
  if (mesh.dropped != without) return "the dropped constraints differ";
  const auto expected = pieces(points, constraints, without);
  if (mesh.triangles.size() != triangle_count(points)) return "the number of triangles is not 2n - 2 - h";
  for (const auto& t : mesh.triangles) {
    for (std::uint32_t v : t)
      if (v >= points.size() || mesh.representative[v] != v) return "a corner is no representative";
    if (orientation(points[t[0]], points[t[1]], points[t[2]]) <= 0) return "a triangle is not counter-clockwise";
  }
  for (const std::string& fault :
       {order_fault(points, mesh), pieces_fault(points, mesh, expected), statistics_fault(points, constraints, mesh)})
    if (!fault.empty()) return fault;

  std::vector<Segment> kept;
  for (std::uint32_t c = 0; c < constraints.size(); ++c)
    if (!std::binary_search(without.begin(), without.end(), c)) kept.push_back(constraints[c]);
  const Edges edges = classify(points, mesh.triangles, expected);
  if (!edges.wrong.empty()) return "an edge is not locally Delaunay or against the tie rule";
  const Triangles reference = reference_triangles(points, kept);
  if (mesh.triangles == reference) return {};
  return edges.decided == classify(points, reference, expected).decided
             ? "triangles differ from CGAL's in order or at cocircular vertices"
             : "edges differ from CGAL's";
}

/// Integer coordinates as grid points from 0 on; the grid's own cell may be finer, which changes nothing.
inline std::string disagreement(const Workload& work, const Triangulation& mesh, Crossing crossing = Crossing::reject) {
  return disagreement(from_zero(integers(work.points)), work.constraints, mesh, crossing);
}

}  // namespace gcdt::test
