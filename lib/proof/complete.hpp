// SPDX-License-Identifier: Apache-2.0
// A sequential CDT in exact host arithmetic, for the proof of domains: what is left of a mesh does not tell what was
// removed, but the mesh is unique, so another way to it tells. Half-edges are numbered as in mesh.hpp.
#pragma once

#include <array>
#include <vector>

#include "proof/cavity.hpp"
#include "proof/delaunay.hpp"

namespace gcdt::proof {

/// Divide and conquer for the vertices (delaunay.hpp), then the constraints one by one: the triangles that one
/// crosses are removed, and what is left on either side triangulated (cavity.hpp). The sites are not all on one
/// line.
///
/// In random order, k constraints that do not cross take O(n log n + n log^2 k) expected steps, and one for each edge
/// on a constraint. What they cross: Agarwal, Arge and Yi (I/O-efficient construction of constrained Delaunay
/// triangulations, 2005), as put by Shewchuk and Brown (cavity.hpp). The ways to these edges: they are looked
/// for around both ends at once, so for the edge uv that comes to be at most 2 min(deg u, deg v) triangles are looked
/// at, edges that it removes aside. By looking backwards, it is a random one of the i that are there, and the sum of
/// that minimum over all 3 n edges of a planar graph is below 18 n (Chiba and Nishizeki 1985: below 2 a |E|, where the
/// arboricity a is at most 3). So the i-th takes O(n / i), and all of them O(n log k).
class Completion {
 public:
  /// `steps` grows by every vertex, edge or triangle that is looked at.
  Completion(const Sites& sites, std::uint64_t& steps);

  /// Makes the constraint a chain of edges, unless it crosses an earlier one: then it changes nothing and returns
  /// false. Ends are representatives that differ.
  bool constrain(std::uint32_t a, std::uint32_t b);

  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  bool constrained(std::uint32_t h) const { return constrained_[h] != 0; }
  std::uint32_t twin(std::uint32_t h) const { return twins_[h]; }

  /// Puts the triangles into canonical order (docs/contract.md, 5).
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
  /// A part of a constraint between two vertices next to each other on it.
  struct Part {
    std::uint32_t half_edge;             ///< that it runs along, or none
    std::vector<std::uint32_t> crossed;  ///< else: the half-edges that it crosses, from its right to its left
  };
  /// The edges on one side of those that a constraint crosses, in a row, its interior on their left.
  struct Border {
    std::vector<std::uint32_t> vertices;
    std::vector<Side> outer;
    std::vector<std::uint32_t> beyond;  ///< the place here of an edge's other side: it hangs into the interior; or none
  };
  class Search;

  std::uint32_t apex(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t from(std::uint32_t h) const { return apex(next(h)); }
  std::uint32_t to(std::uint32_t h) const { return apex(previous(h)); }
  Side side(std::uint32_t h) const { return {twins_[h], constrained(h)}; }

  bool find_parts(std::uint32_t a, std::uint32_t b, std::vector<Part>& parts);
  std::uint32_t follow(std::uint32_t v, std::uint32_t w, const Step& step, Part& part);
  void replace_crossed(const std::vector<std::uint32_t>& crossed);
  Border border(const std::vector<std::uint32_t>& path);
  std::uint32_t fill(const Border& border, const std::uint32_t* free);
  void constrain_edge(std::uint32_t h);
  void put(std::uint32_t t, const Corners& corners, const std::array<Side, 3>& sides);
  void flip(std::uint32_t h);
  bool must_flip(std::uint32_t h) const;
  void restore();

  const Sites& sites_;
  std::uint64_t& steps_;
  std::vector<Corners> triangles_;
  std::vector<std::uint32_t> twins_;
  std::vector<char> constrained_;
  std::vector<std::uint32_t> leaving_;  // by vertex: one half-edge that leaves it
  std::vector<std::uint32_t> suspects_;
  std::vector<std::uint32_t> place_;  // by half-edge: on the border that is made, none elsewhere
  Cavity cavity_;
};

}  // namespace gcdt::proof
