// SPDX-License-Identifier: Apache-2.0
// A plain sequential CDT with the symbolic vertices, for tests of single phases: incremental insertion
// and flips as in the textbook, on the predicates of the library.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "common/predicates.h"

namespace gcdt::test {

using device::u32;  // the macros of shared.h name it
using Point = std::array<std::int32_t, 2>;

struct Face {
  std::array<std::uint32_t, 3> corners;
  std::array<int, 3> neighbours;
  std::array<bool, 3> constrained;
};

/// All vertices but `left_out` are inserted, in the order of their numbers.
class SequentialMesh {
 public:
  explicit SequentialMesh(std::vector<Point> points, std::uint32_t left_out = GCDT_NONE) : points_(std::move(points)) {
    faces_.push_back({{n(), n() + 1, n() + 2}, {-1, -1, -1}, {false, false, false}});
    for (std::uint32_t v = 0; v < n(); ++v)
      if (v != left_out) insert(v);
  }

  std::uint32_t n() const { return static_cast<std::uint32_t>(points_.size()); }
  const std::vector<Face>& faces() const { return faces_; }
  bool finite(int f) const {
    return faces_[f].corners[0] < n() && faces_[f].corners[1] < n() && faces_[f].corners[2] < n();
  }
  device::Vertex vertex(std::uint32_t v) const {
    return v < n() ? device::gcdt_finite_vertex(points_[v][0], points_[v][1])
                   : device::gcdt_symbolic_vertex(static_cast<int>(v - n()));
  }
  int orient(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return device::gcdt_sign64(device::gcdt_orient2d(vertex(a), vertex(b), vertex(c)));
  }

  /// Makes ab an edge and flags it: edges in the way are flipped away in turn (Sloan 1993), at random
  /// where that puts another one in the way, so that it ends. No vertex lies inside ab and no flagged
  /// edge crosses it. The mesh is not Delaunay before restore().
  void constrain(std::uint32_t a, std::uint32_t b) {
    std::minstd_rand random;
    for (;;) {
      bool crossed = false;
      for (int f = 0; f < static_cast<int>(faces_.size()); ++f)
        for (int k = 0; k < 3; ++k) {
          if (faces_[f].neighbours[k] < 0 || !crosses(a, b, corner(f, k + 1), corner(f, k + 2))) continue;
          crossed = true;
          if (convex(f, k) && (!crosses(a, b, corner(f, k), apex(f, k)) || random() % 2)) flip(f, k);
        }
      if (!crossed) break;
    }
    for (Face& face : faces_)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t p = face.corners[(k + 1) % 3], q = face.corners[(k + 2) % 3];
        if ((p == a && q == b) || (p == b && q == a)) face.constrained[k] = true;
      }
  }
  /// Flags the edge of face f across from corner k on both sides.
  void flag(int f, int k) {
    const int g = faces_[f].neighbours[k];
    faces_[f].constrained[k] = true;
    if (g >= 0) faces_[g].constrained[corner_to(g, f)] = true;
  }
  /// Flips until every unconstrained edge is locally Delaunay.
  void restore() {
    for (bool changed = true; changed;) {
      changed = false;
      for (int f = 0; f < static_cast<int>(faces_.size()); ++f)
        for (int k = 0; k < 3; ++k)
          if (must_flip(f, k)) {
            flip(f, k);
            changed = true;
          }
    }
  }
  /// The interiors of segments ab and pq meet in one point.
  bool crosses(std::uint32_t a, std::uint32_t b, std::uint32_t p, std::uint32_t q) const {
    if (p >= n() && q >= n()) return false;
    return orient(a, b, p) * orient(a, b, q) < 0 && orient(p, q, a) * orient(p, q, b) < 0;
  }

 private:
  std::uint32_t corner(int f, int k) const { return faces_[f].corners[k % 3]; }
  int corner_to(int g, int f) const {
    int j = 0;
    while (faces_[g].neighbours[j] != f) ++j;
    return j;
  }
  std::uint32_t apex(int f, int k) const {
    const int g = faces_[f].neighbours[k];
    return corner(g, corner_to(g, f));
  }
  bool must_flip(int f, int k) const {
    if (faces_[f].neighbours[k] < 0 || faces_[f].constrained[k]) return false;
    return device::gcdt_must_flip(vertex(corner(f, k + 1)), vertex(apex(f, k)), vertex(corner(f, k + 2)),
                                  vertex(corner(f, k)));
  }
  /// The two faces at edge k of f form a strictly convex quadrilateral.
  bool convex(int f, int k) const {
    const std::uint32_t p = corner(f, k), a = corner(f, k + 1), b = corner(f, k + 2), q = apex(f, k);
    return orient(p, a, q) > 0 && orient(p, q, b) > 0;
  }

  struct Side {
    int neighbour;
    bool constrained;
  };
  Side side(int f, int k) const { return {faces_[f].neighbours[k % 3], faces_[f].constrained[k % 3]}; }
  /// Writes face f, and the links back of those neighbours that linked to `former[k]`.
  void put(int f, std::array<std::uint32_t, 3> corners, std::array<Side, 3> sides, std::array<int, 3> former) {
    faces_[f].corners = corners;
    for (int k = 0; k < 3; ++k) {
      faces_[f].neighbours[k] = sides[k].neighbour;
      faces_[f].constrained[k] = sides[k].constrained;
      if (former[k] >= 0 && sides[k].neighbour >= 0)
        faces_[sides[k].neighbour].neighbours[corner_to(sides[k].neighbour, former[k])] = f;
    }
  }
  int add_face() {
    faces_.push_back({{0, 0, 0}, {-1, -1, -1}, {false, false, false}});
    return static_cast<int>(faces_.size()) - 1;
  }

  // f = (p, a, b), g = (q, b, a)  become  f = (p, a, q), g = (p, q, b)
  //
  //        p                p
  //      / f \            / | \.
  //     a-----b    ->    a f|g b
  //      \ g /            \ | /
  //        q                q
  void flip(int f, int k) {
    const int g = faces_[f].neighbours[k], j = corner_to(g, f);
    const std::uint32_t p = corner(f, k), a = corner(f, k + 1), b = corner(f, k + 2), q = corner(g, j);
    const Side pa = side(f, k + 2), bp = side(f, k + 1), aq = side(g, j + 1), qb = side(g, j + 2);
    put(f, {p, a, q}, {aq, {g, false}, pa}, {g, -1, -1});
    put(g, {p, q, b}, {qb, bp, {f, false}}, {-1, f, -1});
  }

  void insert(std::uint32_t v) {
    int f = last_;
    for (bool walking = true; walking;) {
      walking = false;
      for (int k = 0; k < 3 && !walking; ++k)
        if (orient(corner(f, k + 1), corner(f, k + 2), v) < 0) {
          f = faces_[f].neighbours[k];
          walking = true;
        }
    }
    int on = -1;
    for (int k = 0; k < 3; ++k)
      if (orient(corner(f, k + 1), corner(f, k + 2), v) == 0) on = k;
    if (on < 0)
      split_face(f, v);
    else
      split_edge(f, on, v);
    last_ = f;
    while (!suspects_.empty()) {
      const int s = suspects_.back();
      suspects_.pop_back();
      int k = 0;
      while (corner(s, k) != v) ++k;
      if (!must_flip(s, k)) continue;
      suspects_.push_back(faces_[s].neighbours[k]);
      suspects_.push_back(s);
      flip(s, k);
    }
  }

  void split_face(int f, std::uint32_t v) {
    const std::uint32_t a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
    const Side bc = side(f, 0), ca = side(f, 1), ab = side(f, 2);
    const int g = add_face(), h = add_face();
    put(g, {b, c, v}, {Side{h, false}, {f, false}, bc}, {-1, -1, f});
    put(h, {c, a, v}, {Side{f, false}, {g, false}, ca}, {-1, -1, f});
    put(f, {a, b, v}, {Side{g, false}, {h, false}, ab}, {-1, -1, -1});
    suspects_ = {f, g, h};
  }

  void split_edge(int f, int k, std::uint32_t v) {
    const int g = faces_[f].neighbours[k], j = corner_to(g, f);
    const std::uint32_t p = corner(f, k), a = corner(f, k + 1), b = corner(f, k + 2), q = corner(g, j);
    const Side pa = side(f, k + 2), bp = side(f, k + 1), aq = side(g, j + 1), qb = side(g, j + 2);
    const int h = add_face(), i = add_face();
    put(h, {b, p, v}, {Side{f, false}, {g, false}, bp}, {-1, -1, f});
    put(i, {a, q, v}, {Side{g, false}, {f, false}, aq}, {-1, -1, g});
    put(f, {p, a, v}, {Side{i, false}, {h, false}, pa}, {-1, -1, -1});
    put(g, {q, b, v}, {Side{h, false}, {i, false}, qb}, {-1, -1, -1});
    suspects_ = {f, g, h, i};
  }

  std::vector<Point> points_;
  std::vector<Face> faces_;
  std::vector<int> suspects_;
  int last_ = 0;
};

}  // namespace gcdt::test
