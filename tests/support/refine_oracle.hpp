// SPDX-License-Identifier: Apache-2.0
// What docs/refinement.md promises of a refined mesh, by plain loops and CGAL's exact predicates. Shares no code with
// the library's.
#pragma once

#include <map>
#include <set>

#include "oracle.hpp"
#include "solve/triangulate.hpp"

namespace gcdt::test {

/// A result of the solver's inside, on the host; vertices are input numbers, then added ones.
struct RefinedResult {
  std::vector<GridPoint> points;
  std::size_t inputs = 0;
  std::vector<cl_uint> representatives, pieces, source_offsets, sources;
  std::vector<std::array<cl_uint, 3>> triangles;
  std::vector<std::array<cl_int, 3>> neighbours;
  std::vector<cl_uchar> constrained;
  std::vector<cl_uint4> origins;
  RefineResult refined;

  bool flagged(std::size_t t, int k) const { return constrained[t] >> k & 1; }
  Edge edge_at(std::size_t t, int k) const {
    return edge(points[triangles[t][(k + 1) % 3]], points[triangles[t][(k + 2) % 3]]);
  }
};

template <class T>
std::vector<T> read_all(runtime::Runtime& runtime, const runtime::Buffer<T>& buffer, std::size_t count) {
  std::vector<T> values(count);
  if (count > 0) runtime.read(buffer, values.data(), count);
  return values;
}

inline RefinedResult read_refined(runtime::Runtime& runtime, const DeviceTriangulation& made,
                                  const std::vector<GridPoint>& inputs) {
  RefinedResult r;
  r.points = inputs;
  r.inputs = inputs.size();
  for (const cl_int2& p : read_all(runtime, made.added.points, made.added.count)) r.points.push_back({p.s[0], p.s[1]});
  const std::size_t count = made.mesh.triangles;
  const auto corners = read_all(runtime, made.mesh.corners, 3 * count);
  const auto neighbours = read_all(runtime, made.mesh.neighbours, 3 * count);
  for (std::size_t t = 0; t < count; ++t) {
    r.triangles.push_back({corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
    r.neighbours.push_back({neighbours[3 * t], neighbours[3 * t + 1], neighbours[3 * t + 2]});
  }
  r.constrained = read_all(runtime, made.mesh.constrained, count);
  r.representatives = read_all(runtime, made.representatives, r.points.size());
  for (const cl_uint2& p : read_all(runtime, made.pieces.ends, made.pieces.count)) {
    r.pieces.push_back(p.s[0]);
    r.pieces.push_back(p.s[1]);
  }
  r.source_offsets = read_all(runtime, made.pieces.source_offsets, std::size_t{made.pieces.count} + 1);
  r.sources = read_all(runtime, made.pieces.sources, made.pieces.source_count);
  if (made.added.origins.allocated()) r.origins = read_all(runtime, made.added.origins, made.added.count);
  r.refined = made.refined;
  return r;
}

/// The edges of border: those without a neighbour.
inline std::vector<Edge> border_of(const RefinedResult& r) {
  std::vector<Edge> border;
  for (std::size_t t = 0; t < r.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (r.neighbours[t][k] < 0) border.push_back(r.edge_at(t, k));
  return border;
}

inline bool cross_inside(const Edge& e, const Edge& f) {
  const int a = orientation(e.first, e.second, f.first), b = orientation(e.first, e.second, f.second),
            c = orientation(f.first, f.second, e.first), d = orientation(f.first, f.second, e.second);
  if (a == 0 && b == 0) {  // on one line: an overlap
    return std::max(e.first, f.first) < std::min(e.second, f.second);
  }
  const auto inner = [](const Edge& s, const GridPoint& p) {
    return between(s.first, s.second, p) && p != s.first && p != s.second;
  };
  return (a * b < 0 && c * d < 0) || inner(e, f.first) || inner(e, f.second) || inner(f, e.first) || inner(f, e.second);
}

/// Triangles are counter-clockwise, links agree, flags are on both sides and on the pieces, no two edges of the border
/// cross, and every unconstrained edge between two triangles is Delaunay with the tie rule. If so, empty.
inline std::string mesh_fault(const RefinedResult& r) {
  std::set<Edge> flagged;
  for (std::size_t t = 0; t < r.triangles.size(); ++t) {
    const auto& c = r.triangles[t];
    const std::string name = "triangle " + std::to_string(t);
    for (const cl_uint v : c)
      if (v >= r.points.size() || r.representatives[v] != v) return name + " has a corner that is no vertex";
    if (orientation(r.points[c[0]], r.points[c[1]], r.points[c[2]]) <= 0) return name + " is not counter-clockwise";
    for (int k = 0; k < 3; ++k) {
      if (r.flagged(t, k)) flagged.insert(r.edge_at(t, k));
      const cl_int u = r.neighbours[t][k];
      if (u < 0) continue;
      int j = 0;
      while (j < 3 && r.neighbours[u][j] != cl_int(t)) ++j;
      if (j == 3 || r.edge_at(u, j) != r.edge_at(t, k)) return name + " has a neighbour that does not link back";
      if (r.flagged(u, j) != r.flagged(t, k)) return name + " has an edge that is flagged on one side";
      if (r.flagged(t, k)) continue;
      const GridPoint &a = r.points[c[(k + 1) % 3]], &b = r.points[c[(k + 2) % 3]], &p = r.points[c[k]],
                      &q = r.points[r.triangles[u][j]];
      const int side = in_circle(a, b, p, q);
      if (side > 0) return name + " has an edge that is not Delaunay";
      if (side == 0 && std::min(a, b) > std::min(p, q)) return name + " has the wrong diagonal";
    }
  }
  std::set<Edge> pieces;
  for (std::size_t i = 0; i + 1 < r.pieces.size(); i += 2)
    pieces.insert(edge(r.points[r.pieces[i]], r.points[r.pieces[i + 1]]));
  if (2 * pieces.size() != r.pieces.size()) return "a piece is there twice";
  for (const Edge& e : flagged)
    if (!pieces.count(e)) return "an edge is flagged, but no piece";
  const std::vector<Edge> border = border_of(r);
  for (std::size_t i = 0; i < border.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (cross_inside(border[i], border[j])) return "two edges of the border cross";
  return "";
}

/// The mesh of the whole hull: one piece without holes that uses every vertex. With mesh_fault() and a border that does
/// not cross itself it covers what the border encloses once.
inline std::string disc_fault(const RefinedResult& r) {
  std::set<cl_uint> used;
  for (const auto& c : r.triangles) used.insert(c.begin(), c.end());
  std::size_t vertices = 0;
  for (std::size_t v = 0; v < r.points.size(); ++v) vertices += r.representatives[v] == v;
  if (used.size() != vertices) return "a vertex is in no triangle";
  if (r.triangles.size() + 2 + border_of(r).size() != 2 * vertices) return "the triangles are no disc";
  return "";
}

/// How far from the piece ab its vertex at v is, on the shorter axis, as a fraction; 2 if v is not between the ends on
/// the longer one.
inline double distance_on_axis(const GridPoint& a, const GridPoint& b, const GridPoint& v) {
  const bool by_x = std::llabs(b[0] - a[0]) >= std::llabs(b[1] - a[1]);
  const int along = by_x ? 0 : 1, across = 1 - along;
  const long double whole = (long double)(b[along] - a[along]);
  const long double t = (long double)(v[along] - a[along]) / whole;
  if (!(t > 0 && t < 1)) return 2;
  return std::fabs(double(a[across] + t * (long double)(b[across] - a[across]) - v[across]));
}

/// Each piece of `plain`, the same input not refined, is a chain of pieces with its sources, through the vertices that
/// were put on it, in their order, which are within half a cell, or a cell if rounded the other way; nothing else is a
/// piece; and no input vertex is on another side of a chain than it was of the piece.
inline std::string chain_fault(const RefinedResult& r, const RefinedResult& plain) {
  std::map<Edge, std::vector<cl_uint>> left;
  for (std::size_t i = 0; 2 * i < r.pieces.size(); ++i)
    left[edge(r.points[r.pieces[2 * i]], r.points[r.pieces[2 * i + 1]])] = {
        r.sources.begin() + r.source_offsets[i], r.sources.begin() + r.source_offsets[i + 1]};
  std::map<cl_uint, std::vector<GridPoint>> on;  // by the constraint, which several pieces may have
  std::size_t far = 0, placed = 0, named = 0;
  for (std::size_t i = 0; i < r.origins.size(); ++i)
    if (r.origins[i].s[3] != GCDT_NONE) {
      on[r.origins[i].s[3]].push_back(r.points[r.inputs + i]);
      ++named;
    }
  for (std::size_t i = 0; 2 * i < plain.pieces.size(); ++i) {
    GridPoint a = plain.points[plain.pieces[2 * i]], b = plain.points[plain.pieces[2 * i + 1]];
    if (b < a) std::swap(a, b);
    const int along = std::llabs(b[0] - a[0]) >= std::llabs(b[1] - a[1]) ? 0 : 1;
    std::vector<GridPoint> chain;
    for (const GridPoint& v : on[plain.sources[plain.source_offsets[i]]]) {
      const double distance = distance_on_axis(a, b, v);
      if (distance == 2) continue;  // on another piece of this constraint
      if (distance >= 1) return "a vertex is not beside its piece";
      far += distance > 0.5;
      ++placed;
      chain.push_back(v);
    }
    chain.push_back(a);
    chain.push_back(b);
    const bool down = b[along] < a[along];
    std::sort(chain.begin(), chain.end(),
              [&](const GridPoint& u, const GridPoint& v) { return down ? u[along] > v[along] : u[along] < v[along]; });
    const std::vector<cl_uint> sources(plain.sources.begin() + plain.source_offsets[i],
                                       plain.sources.begin() + plain.source_offsets[i + 1]);
    for (std::size_t j = 0; j + 1 < chain.size(); ++j) {
      const auto link = left.find(edge(chain[j], chain[j + 1]));
      if (link == left.end()) return "a piece is not covered by a chain";
      if (link->second != sources) return "a link has other sources than its piece";
      left.erase(link);
      for (std::size_t v = 0; v < r.inputs; ++v) {
        const GridPoint& p = r.points[v];
        const auto range = std::minmax(chain[j][along], chain[j + 1][along]);
        if (p == a || p == b || p[along] < range.first || p[along] > range.second) continue;
        if (orientation(a, b, p) != orientation(chain[j], chain[j + 1], p)) return "an input vertex changed sides";
      }
    }
  }
  if (placed != named) return "a vertex is on no piece, or on two";
  if (!left.empty()) return "a piece is part of no piece of the input";
  if (far > r.refined.far) return "more vertices are far from their piece than were counted";
  return "";
}

__extension__ typedef __int128 Wide;

/// Triangles with an angle below that with tangent `tangent` / 2^31, exactly.
inline std::uint64_t sharp_triangles(const RefinedResult& r, std::uint64_t tangent) {
  std::uint64_t count = 0;
  for (const auto& c : r.triangles) {
    const GridPoint* p[3] = {&r.points[c[0]], &r.points[c[1]], &r.points[c[2]]};
    bool sharp = false;
    for (int k = 0; k < 3; ++k) {
      const GridPoint &o = *p[k], &a = *p[(k + 1) % 3], &b = *p[(k + 2) % 3];
      const Wide ax = a[0] - o[0], ay = a[1] - o[1], bx = b[0] - o[0], by = b[1] - o[1];
      sharp |= (ax * by - ay * bx) * (Wide(1) << 31) < (ax * bx + ay * by) * Wide(tangent);
    }
    count += sharp;
  }
  return count;
}

}  // namespace gcdt::test
