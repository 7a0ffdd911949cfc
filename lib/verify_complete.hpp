// SPDX-License-Identifier: Apache-2.0
// A sequential CDT in exact host arithmetic, for the proof of domains: what is left of a mesh does not tell what was
// removed, but the mesh is unique, so another way to it tells. Half-edges are numbered as in verify_mesh.hpp.
#pragma once

#include <array>
#include <random>
#include <vector>

#include "verify_mesh.hpp"

namespace gcdt::proof {

/// > 0 if d is inside the circle through a, b, c (counter-clockwise), 0 on it.
Wide incircle(Vertex a, Vertex b, Vertex c, Vertex d);

/// The order that decides ties: x first.
bool before(Vertex a, Vertex b);

/// Sweeps from left to right, then inserts constraints by flips (Sloan 1993); Lawson's flips restore the Delaunay
/// property after each step. The sites are not all on one line.
class Completion {
 public:
  explicit Completion(const Sites& sites);

  /// Makes the constraint a chain of edges, unless it crosses an earlier one: then it changes nothing and returns
  /// false. Ends are representatives that differ.
  bool constrain(std::uint32_t a, std::uint32_t b);

  /// Calls visit(h, along) for an edge's half-edge, one of each edge of the chain from a to b, which exists; `along`:
  /// whether the half-edge runs from a to b.
  template <class Visit>
  void follow(std::uint32_t a, std::uint32_t b, Visit&& visit) const {
    for (std::uint32_t v = a; v != b;) {
      const Step step = leave(v, b);
      visit(step.half_edge, from(step.half_edge) == v);
      v = step.end;
    }
  }

  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  bool constrained(std::uint32_t h) const { return constrained_[h] != 0; }
  std::uint32_t twin(std::uint32_t h) const { return twins_[h]; }

  /// Puts the triangles into canonical order (contract 5).
  void sort();

 private:
  using Corners = std::array<std::uint32_t, 3>;
  struct Side {
    std::uint32_t twin;
    bool constrained;
  };
  struct Step {
    bool along_edge;  ///< the segment runs along half_edge to `end`; else it crosses half_edge
    std::uint32_t half_edge;
    std::uint32_t end;
  };

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t apex(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t from(std::uint32_t h) const { return apex(next(h)); }
  std::uint32_t to(std::uint32_t h) const { return apex(previous(h)); }
  std::int64_t turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orient(sites_.at[a], sites_.at[b], sites_.at[c]);
  }
  Side side(std::uint32_t h) const { return {twins_[h], constrained(h)}; }

  std::uint32_t add(const Corners& corners);
  void put(std::uint32_t t, const Corners& corners, const std::array<Side, 3>& sides);
  void flip(std::uint32_t h);
  bool must_flip(std::uint32_t h) const;
  void restore();
  void start(const std::vector<std::uint32_t>& order, std::size_t line);
  void append(std::uint32_t v, std::uint32_t last);
  template <class Visit>
  void around(std::uint32_t v, Visit&& visit) const;
  Step leave(std::uint32_t v, std::uint32_t w) const;
  std::uint32_t find(std::uint32_t a, std::uint32_t b) const;
  bool crosses(std::uint32_t a, std::uint32_t b, std::uint32_t p, std::uint32_t q) const;
  template <class Visit>
  std::uint32_t cross(std::uint32_t v, std::uint32_t w, Visit&& visit) const;
  bool is_free(std::uint32_t a, std::uint32_t b) const;
  void clear(std::uint32_t a, std::uint32_t b);

  const Sites& sites_;
  std::vector<Corners> triangles_;
  std::vector<std::uint32_t> twins_;
  std::vector<char> constrained_;
  std::vector<std::uint32_t> leaving_;  // by vertex: one half-edge that leaves it
  std::vector<std::uint32_t> hull_next_, hull_previous_;
  std::vector<std::uint32_t> hull_edge_;  // by vertex on the hull: the half-edge to the next one
  std::vector<std::uint32_t> suspects_;
  std::minstd_rand random_;
};

}  // namespace gcdt::proof
