// SPDX-License-Identifier: Apache-2.0
// Constraints in small meshes: random ones that do not cross, and what becomes of them, by brute force on the host.
#pragma once

#include "mesh_fixture.hpp"

namespace fixture {

/// Exact: do the interiors of segments pq and rs meet, other than at a vertex of both?
inline std::int64_t turn(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
inline int sign(std::int64_t v) { return (v > 0) - (v < 0); }
inline bool cross(const Point& p, const Point& q, const Point& r, const Point& s) {
  return sign(turn(p, q, r)) * sign(turn(p, q, s)) < 0 && sign(turn(r, s, p)) * sign(turn(r, s, q)) < 0;
}

/// Random constraints that cross no other one, kept greedily; overlaps and vertices on them are welcome.
inline std::vector<Constraint> random_constraints(const std::vector<Point>& points, std::size_t wanted,
                                                  Random& random) {
  std::vector<Constraint> kept;
  for (std::size_t tries = 0; tries < 8 * wanted && kept.size() < wanted; ++tries) {
    const Constraint c = {std::uint32_t(random.below(points.size())), std::uint32_t(random.below(points.size()))};
    bool free = true;
    for (const Constraint& k : kept) free &= !cross(points[c[0]], points[c[1]], points[k[0]], points[k[1]]);
    if (free) kept.push_back(c);
  }
  return kept;
}

/// The edges of the mesh that are marked, as pairs of vertices.
inline std::set<Constraint> edges_of(const HostMesh& m) {
  std::set<Constraint> all;
  for (std::uint32_t e = 0; e < m.edges; ++e) all.insert(ends_of_edge(m, e));
  return all;
}

inline std::set<Constraint> marked_edges(const HostMesh& m) {
  std::set<Constraint> all;
  for (std::uint32_t e = 0; e < m.edges; ++e)
    if (m.marks[e] & GCDT_MARK_CONSTRAINED) all.insert(ends_of_edge(m, e));
  return all;
}

/// What a constrain phase meets with in a mesh whose border is the convex hull, so that no piece leaves the finite
/// faces.
struct Met {
  std::uint64_t pairs = 0;                   // of faces and pieces that cross them
  std::array<std::uint64_t, 4> of_two = {};  // the cases of figure 6, in the order of kernels/constrain/constrain.cl
};

/// By brute force: all pieces that cross an edge, in the order in which they are met along it.
inline Met met_by(const HostMesh& m, const std::set<Constraint>& pieces) {
  Met met;
  const auto crossing = [&](std::uint32_t u, std::uint32_t v) {
    std::vector<Constraint> found;
    if (u >= m.n || v >= m.n) return found;
    for (const Constraint& c : pieces)
      if (cross(m.points[c[0]], m.points[c[1]], m.points[u], m.points[v])) found.push_back(c);
    // The distance from u is |turn(c, u)| of |turn(c, u)| + |turn(c, v)|.
    const auto at = [&](const Constraint& c, std::uint32_t end) {
      return static_cast<__int128>(std::abs(turn(m.points[c[0]], m.points[c[1]], m.points[end])));
    };
    std::sort(found.begin(), found.end(),
              [&](const Constraint& c, const Constraint& d) { return at(c, u) * at(d, v) < at(d, u) * at(c, v); });
    return found;
  };
  std::map<Constraint, std::uint64_t> sides_crossed;
  for (const cl_uint4& f : m.corners)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t w = f.s[k], u = f.s[(k + 1) % 3], v = f.s[(k + 2) % 3];
      const std::vector<Constraint> found = crossing(u, v);
      for (const Constraint& c : found) ++sides_crossed[c];
      if (found.size() < 2) continue;
      const auto comes_from_w = [&](const Constraint& c) { return c[0] == w || c[1] == w; };
      const auto cuts_off_u = [&](const Constraint& c) {
        return cross(m.points[c[0]], m.points[c[1]], m.points[u], m.points[w]);
      };
      const Constraint &first = found.front(), &last = found.back();
      const int from = comes_from_w(first) + comes_from_w(last);
      ++met.of_two[from == 2 ? 1 : from == 1 ? 3 : cuts_off_u(first) == cuts_off_u(last) ? 0 : 2];
    }
  for (const auto& [piece, sides] : sides_crossed) met.pairs += sides / 2 + 1;  // an edge has two sides
  return met;
}

/// What docs/contract.md, 3, makes of one constraint, by brute force: the edges between the vertices on it, each
/// with its lower number first. None if it has no length.
inline std::vector<Constraint> pieces_of(const std::vector<Point>& points, const Constraint& c) {
  const Point &p = points[c[0]], &q = points[c[1]];
  std::vector<Constraint> pieces;
  if (c[0] == c[1]) return pieces;
  std::vector<std::pair<std::int64_t, std::uint32_t>> on;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    const std::int64_t t = (q[0] - p[0]) * (points[v][0] - p[0]) + (q[1] - p[1]) * (points[v][1] - p[1]);
    const std::int64_t whole = (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]);
    if (turn(p, q, points[v]) == 0 && t >= 0 && t <= whole) on.push_back({t, v});
  }
  std::sort(on.begin(), on.end());
  for (std::size_t i = 0; i + 1 < on.size(); ++i)
    pieces.push_back({std::min(on[i].second, on[i + 1].second), std::max(on[i].second, on[i + 1].second)});
  return pieces;
}

/// Pieces on a device, the smaller vertex of each first.
inline std::set<Constraint> read_pieces(runtime::Runtime& runtime, const Pieces& pieces) {
  std::vector<cl_uint2> ends(pieces.count);
  runtime.read(pieces.ends, ends.data(), ends.size());
  std::set<Constraint> all;
  for (const cl_uint2& e : ends) all.insert({std::min(e.s[0], e.s[1]), std::max(e.s[0], e.s[1])});
  return all;
}

/// The same constraints by the numbers that points `from` have among `to`.
inline std::vector<Constraint> renumbered(const std::vector<Constraint>& constraints, const std::vector<Point>& from,
                                          const std::vector<Point>& to) {
  std::map<Point, std::uint32_t> number;
  for (std::uint32_t v = 0; v < to.size(); ++v) number[to[v]] = v;
  std::vector<Constraint> same;
  for (const Constraint& c : constraints) same.push_back({number.at(from[c[0]]), number.at(from[c[1]])});
  return same;
}

inline std::set<Constraint> expected_pieces(const std::vector<Point>& points,
                                            const std::vector<Constraint>& constraints) {
  std::set<Constraint> all;
  for (const Constraint& c : constraints)
    for (const Constraint& piece : pieces_of(points, c)) all.insert(piece);
  return all;
}

}  // namespace fixture
