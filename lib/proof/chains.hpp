// SPDX-License-Identifier: Apache-2.0
// The constraints of a refined mesh as chains of its edges (docs/refinement.md, "What is promised").
#pragma once

#include <algorithm>
#include <vector>

#include "proof/whole.hpp"

namespace gcdt::proof {

/// An edge of the mesh that was refined, on a constraint or on the hull. Its first end is the lesser in (x, y).
struct Piece {
  std::uint32_t a, b;
  bool constrained;  ///< else it is on the hull alone
  bool keeps_left, keeps_right;
  std::uint32_t seed_left, seed_right;  ///< region seeds of the sides, or none

  bool split() const { return chain.size() > 2; }
  std::vector<std::uint32_t> chain = {};  ///< vertices from a to b
  bool sharp_a = false, sharp_b = false;  ///< find_sharp_ends (mending.hpp)
};

/// Places along a piece: steps on its longer axis, from a on. What is off it is measured on the other axis.
class Ruler {
 public:
  Ruler(Vertex a, Vertex b)
      : a_(a),
        b_(b),
        by_x_(b.x - std::int64_t(a.x) >= std::abs(b.y - std::int64_t(a.y))),
        down_(!by_x_ && b.y < a.y),
        length_(place(b)) {}

  std::int64_t length() const { return length_; }
  std::int64_t place(Vertex v) const {
    if (by_x_) return v.x - std::int64_t(a_.x);
    return down_ ? a_.y - std::int64_t(v.y) : v.y - std::int64_t(a_.y);
  }
  /// The distance of v on the shorter axis, times length(). Below 2^62.
  std::int64_t off(Vertex v) const { return std::abs(orient(a_, b_, v)); }
  bool is_near(Vertex v) const { return off(v) <= length_ / 2 || 2 * Wide(off(v)) <= length_; }
  bool is_far(Vertex v) const { return !is_near(v) && off(v) < length_; }
  bool by_x() const { return by_x_; }

 private:
  Vertex a_, b_;
  bool by_x_, down_;
  std::int64_t length_;
};

/// Finds chains in a mesh whose corners exist. Edges that are neither flagged nor on the border are no part of any,
/// where there are flags; else all may be.
class ChainSearch {
 public:
  ChainSearch(const Sites& sites, std::uint32_t inputs, const MeshView& view);

  /// Fills piece.chain, or returns what is wrong. A vertex between the ends is an added one within half a cell of the
  /// piece, or, where not both sides are kept, within a cell. Ends: each vertex is tried once.
  std::string find(Piece& piece, std::uint32_t number);

 private:
  std::uint32_t next_link(const Piece& piece, const Ruler& ruler, std::uint32_t from, std::uint32_t number) const;

  const Sites& sites_;
  const std::uint32_t inputs_;
  std::vector<std::uint64_t> first_;  // by vertex, of its elements in `to_`
  std::vector<std::uint32_t> to_;     // vertices at the other ends of its edges
  std::vector<std::uint32_t> tried_;  // by vertex, the last piece for which it led nowhere or is in the chain
};

/// Empty if no input vertex is on another side of a chain than it is of its piece, or in between.
std::string prove_sides(const Sites& sites, std::uint32_t inputs, const std::vector<Piece>& pieces);

}  // namespace gcdt::proof
