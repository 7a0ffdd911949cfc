// SPDX-License-Identifier: Apache-2.0
// What the proof knows of the mesh. Half-edge h = 3 t + k is the edge of triangle t across from its corner k:
//
//              apex = corner k
//               / \              from(h) = corner k + 1
//              /   \             to(h)   = corner k + 2
//     corner  /  t  \  corner    twin(h) = the half-edge to(h) -> from(h), or `none` on the boundary
//      k + 1 ---h--> k + 2
#pragma once

#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "proof/grid.hpp"

namespace gcdt::proof {

constexpr std::uint32_t none = 0xffffffffu;

/// The parts in a row, numbers in plain decimal whatever the global locale is.
template <class... Parts>
std::string say(const Parts&... parts) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  (out << ... << parts);
  return out.str();
}

/// Twice the signed area of abc, positive if counter-clockwise. Less than 2^62 in size.
inline std::int64_t orient(Vertex a, Vertex b, Vertex c) {
  const std::int64_t abx = std::int64_t(b.x) - a.x, aby = std::int64_t(b.y) - a.y;
  const std::int64_t acx = std::int64_t(c.x) - a.x, acy = std::int64_t(c.y) - a.y;
  return abx * acy - aby * acx;
}

/// A direction that is not zero. Its components are below 2^31 in size, so products are below 2^62.
struct Direction {
  std::int64_t x = 0, y = 0;
  Direction(Vertex from, Vertex to) : x(std::int64_t(to.x) - from.x), y(std::int64_t(to.y) - from.y) {}
  bool lower() const { return y < 0 || (y == 0 && x < 0); }  ///< angle in [pi, 2 pi)
};

inline std::int64_t cross(Direction a, Direction b) { return a.x * b.y - a.y * b.x; }

/// -1, 0, 1: the angle of a in [0, 2 pi) is smaller than that of b, equal, larger.
inline int compare_angles(Direction a, Direction b) {
  if (a.lower() != b.lower()) return a.lower() ? 1 : -1;
  const std::int64_t turn = cross(a, b);
  return turn > 0 ? -1 : turn < 0;
}

/// The input vertices on the grid.
struct Sites {
  std::vector<Vertex> at;
  std::vector<std::uint32_t> representative;  ///< the least number on the same grid point
  std::uint64_t distinct = 0;
  bool flat = false;  ///< fewer than three distinct ones, or all on one line

  explicit Sites(std::vector<Vertex> vertices);
  bool is_representative(std::uint32_t v) const { return representative[v] == v; }
  std::int64_t turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const { return orient(at[a], at[b], at[c]); }
};

/// The half-edges that follow h and precede it around its triangle.
inline std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
inline std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

class Mesh {
 public:
  Mesh(const Sites& sites, const MeshView& view) : sites_(sites), view_(view) {}

  /// Proves the first sentence of docs/contract.md, 4, and the links, and prepares what follows here.
  /// Returns the first failure, or an empty text.
  std::string prove_topology();

  std::uint32_t half_edges() const { return static_cast<std::uint32_t>(3 * view_.triangles.size()); }
  std::uint32_t apex(std::uint32_t h) const { return view_.triangles[h / 3][h % 3]; }
  std::uint32_t from(std::uint32_t h) const { return apex(next(h)); }
  std::uint32_t to(std::uint32_t h) const { return apex(previous(h)); }
  std::uint32_t twin(std::uint32_t h) const { return twins_[h]; }
  const Vertex& at(std::uint32_t v) const { return sites_.at[v]; }
  std::string edge_name(std::uint32_t h) const { return say("edge ", from(h), "-", to(h)); }
  std::string triangle_name(std::uint32_t t) const;

  /// What a ray from vertex v towards vertex w meets first.
  struct Exit {
    bool along_edge = false;         ///< true: it runs along `half_edge` (in either direction) to `end`
    std::uint32_t half_edge = none;  ///< false: it crosses `half_edge`, across from v
    std::uint32_t end = none;
  };
  /// Only after prove_topology succeeded; w != v.
  Exit leave(std::uint32_t v, std::uint32_t w) const;

 private:
  struct Leaving {  // a half-edge by the vertex that it leads to
    std::uint32_t to, half_edge;
  };

  std::string check_triangles() const;
  void sort_stars();
  std::string check_stars() const;
  void match_twins();
  std::uint32_t find(std::uint32_t from, std::uint32_t to) const;
  std::string check_given_neighbours() const;
  std::string check_boundary() const;
  std::string check_turns(const std::vector<std::uint32_t>& boundary_from, std::uint32_t first,
                          std::uint64_t count) const;

  const Sites& sites_;
  const MeshView& view_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> first_;  // of vertex v's half-edges in leaving_: [first_[v], first_[v + 1])
  std::vector<Leaving> leaving_;      // sorted around each vertex by angle, then by `to`
};

/// The constraint that each half-edge is part of: the least number, or none; equal on both sides of an edge.
using Sources = std::vector<std::uint32_t>;

/// A constraint of positive length between representatives.
struct Segment {
  std::uint32_t a, b;  ///< a < b
  std::uint32_t constraint;
};

/// The distinct segments, each with the least constraint that it is.
std::vector<Segment> distinct_segments(const Sites& sites, Constraints constraints);

/// A row of half-edges from one end of a segment to the other.
using Chain = std::vector<std::uint32_t>;

/// Fills `chain` if the segment is one, and returns none; else the half-edge that it crosses first.
std::uint32_t find_chain(const Mesh& mesh, const Segment& segment, Chain& chain);

/// The constraint runs along the chain.
void record(const Mesh& mesh, const Chain& chain, std::uint32_t constraint, Sources& sources);

/// Visits the half-edges that `segment` crosses between their ends, in order, seen from where it comes from, until
/// visit(half_edge) returns true.
template <class Visit>
void walk_across(const Mesh& mesh, const Segment& segment, Visit&& visit) {
  for (std::uint32_t v = segment.a; v != segment.b;) {
    const auto exit = mesh.leave(v, segment.b);
    if (exit.along_edge) {
      v = exit.end;
      continue;
    }
    // Through triangles until one has its apex on the segment.
    for (std::uint32_t h = exit.half_edge;;) {
      if (visit(h)) return;
      h = mesh.twin(h);
      v = mesh.apex(h);
      const std::int64_t side = orient(mesh.at(segment.a), mesh.at(segment.b), mesh.at(v));
      if (side == 0) break;
      // h runs from the segment's left to its right; the next one must run from right to left, as seen from here.
      h = side > 0 ? next(h) : previous(h);
    }
  }
}

/// Puts the vertices of the input and then the added ones on the grid. Returns the first failure of these, of an index
/// or of a count to be possible.
std::string place_sites(Points points, Constraints constraints, Span<std::array<std::int32_t, 2>> added,
                        const Grid& grid, std::optional<Sites>& sites);

/// Crossing::split. Vertices from `inputs` on must be no duplicates, and in order of x and y.
std::string check_added(const Sites& sites, std::uint32_t inputs);

/// Proves that the constraints were split (split.cpp), and fills `sources`. Returns the first failure.
std::string prove_split(const Sites& sites, const Mesh& mesh, std::uint32_t inputs, Constraints constraints,
                        Sources& sources);

/// Proves docs/contract.md, 3, from the constraints of the input and fills `sources`. Returns the first failure.
std::string prove_constraints(const Sites& sites, const Mesh& mesh, Constraints constraints, Crossing crossing,
                              Sources& sources);

}  // namespace gcdt::proof
