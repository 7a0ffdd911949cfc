// SPDX-License-Identifier: Apache-2.0
#include "proof/delaunay.hpp"

#include <algorithm>

namespace gcdt::proof {

bool inside_circle(const Sites& sites, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  if (d == a || d == b || d == c) return false;
  std::array<Vertex, 3> corners = {sites.at[a], sites.at[b], sites.at[c]};
  const Vertex other = sites.at[d];
  const Wide exact = incircle(corners[0], corners[1], corners[2], other);
  if (exact != 0) return exact > 0;
  const auto least = std::min_element(corners.begin(), corners.end(), before);
  if (before(other, *least)) return true;
  // Where the least corner goes down, the plane through the corners goes up at d iff d is across from that corner.
  *least = other;
  return orient(corners[0], corners[1], corners[2]) < 0;
}

namespace {

using Edge = std::uint32_t;  // directed; e ^ 1 is e reversed

/// Edges around vertices. Left of an edge is the face that the next edge around its end, clockwise, continues.
class Subdivision {
 public:
  Subdivision(const Sites& sites, std::uint64_t& steps) : sites_(sites), steps_(steps) {}

  struct Ends {
    Edge left, right;  ///< of the hull: counter-clockwise from the least vertex, clockwise from the greatest
  };
  /// Of [begin, end), at least two sites in order.
  Ends build(const std::uint32_t* begin, const std::uint32_t* end) {
    if (end - begin == 2) {
      const Edge e = make(begin[0], begin[1]);
      return {e, e ^ 1};
    }
    if (end - begin == 3) return build_three(begin);
    const std::uint32_t* middle = begin + (end - begin) / 2;
    const Ends left = build(begin, middle), right = build(middle, end);
    return merge(left, right);
  }

  DelaunayMesh triangles() const {
    DelaunayMesh mesh;
    std::vector<std::uint32_t> half_edge(origin_.size(), none);
    for (Edge e = 0; e < origin_.size(); ++e) {
      if (origin_[e] == none || half_edge[e] != none) continue;
      const Edge f = left_next(e), g = left_next(f);
      if (left_next(g) != e || sites_.turn(from(e), from(f), from(g)) <= 0) continue;
      const auto t = static_cast<std::uint32_t>(mesh.triangles.size());
      mesh.triangles.push_back({from(e), from(f), from(g)});
      half_edge[e] = 3 * t + 2, half_edge[f] = 3 * t, half_edge[g] = 3 * t + 1;
    }
    mesh.twins.assign(3 * mesh.triangles.size(), none);
    for (Edge e = 0; e < origin_.size(); ++e)
      if (half_edge[e] != none) mesh.twins[half_edge[e]] = half_edge[e ^ 1];
    return mesh;
  }

 private:
  std::uint32_t from(Edge e) const { return origin_[e]; }
  std::uint32_t to(Edge e) const { return origin_[e ^ 1]; }
  Edge left_next(Edge e) const { return clockwise_[e ^ 1]; }
  bool is_left(std::uint32_t v, Edge e) const { return sites_.turn(v, from(e), to(e)) > 0; }
  bool is_right(std::uint32_t v, Edge e) const { return sites_.turn(v, to(e), from(e)) > 0; }

  Edge make(std::uint32_t a, std::uint32_t b) {
    Edge e = static_cast<Edge>(origin_.size());
    if (unused_.empty()) {
      origin_.resize(e + 2);
      counterclockwise_.resize(e + 2);
      clockwise_.resize(e + 2);
    } else {
      e = unused_.back();
      unused_.pop_back();
    }
    origin_[e] = a, origin_[e ^ 1] = b;
    for (const Edge side : {e, e ^ 1}) counterclockwise_[side] = clockwise_[side] = side;
    return e;
  }

  /// Joins the rings of edges around two origins, or cuts one ring in two.
  void splice(Edge a, Edge b) {
    std::swap(counterclockwise_[a], counterclockwise_[b]);
    clockwise_[counterclockwise_[a]] = a;
    clockwise_[counterclockwise_[b]] = b;
  }

  /// A new edge from the end of a to the origin of b, in the face left of both.
  Edge connect(Edge a, Edge b) {
    const Edge e = make(to(a), from(b));
    splice(e, left_next(a));
    splice(e ^ 1, b);
    return e;
  }

  void remove(Edge e) {
    splice(e, clockwise_[e]);
    splice(e ^ 1, clockwise_[e ^ 1]);
    origin_[e] = origin_[e ^ 1] = none;
    unused_.push_back(e);
  }

  Ends build_three(const std::uint32_t* v) {
    const Edge a = make(v[0], v[1]), b = make(v[1], v[2]);
    splice(a ^ 1, b);
    const std::int64_t side = sites_.turn(v[0], v[1], v[2]);
    if (side == 0) return {a, b ^ 1};
    const Edge c = connect(b, a);
    return side > 0 ? Ends{a, b ^ 1} : Ends{c ^ 1, c};
  }

  Ends merge(Ends left, Ends right) {
    Edge low_left = left.right, low_right = right.left;
    for (;; ++steps_) {  // down to the lower common tangent
      if (is_left(from(low_right), low_left))
        low_left = left_next(low_left);
      else if (is_right(from(low_left), low_right))
        low_right = counterclockwise_[low_right ^ 1];
      else
        break;
    }
    Edge base = connect(low_right ^ 1, low_left);
    if (from(low_left) == from(left.left)) left.left = base ^ 1;
    if (from(low_right) == from(right.right)) right.right = base;
    for (;; ++steps_) {  // up from edge to edge between the halves
      Edge on_left = counterclockwise_[base ^ 1], on_right = clockwise_[base];
      const bool left_there = is_right(to(on_left), base), right_there = is_right(to(on_right), base);
      if (!left_there && !right_there) return {left.left, right.right};
      if (left_there) on_left = without_covered(on_left, base, counterclockwise_);
      if (right_there) on_right = without_covered(on_right, base, clockwise_);
      const bool take_right = !left_there || (right_there && inside_circle(sites_, to(on_left), from(on_left),
                                                                           from(on_right), to(on_right)));
      base = take_right ? connect(on_right, base ^ 1) : connect(base ^ 1, on_left ^ 1);
    }
  }

  /// The first of the edges around a vertex, from `candidate` on, that is Delaunay with `base`; removes those before.
  Edge without_covered(Edge candidate, Edge base, const std::vector<Edge>& following) {
    for (Edge next = following[candidate]; inside_circle(sites_, to(base), from(base), to(candidate), to(next));
         next = following[candidate]) {
      remove(candidate);
      candidate = next;
      ++steps_;
    }
    return candidate;
  }

  const Sites& sites_;
  std::uint64_t& steps_;
  std::vector<std::uint32_t> origin_;               // none: not in use
  std::vector<Edge> counterclockwise_, clockwise_;  // the next edge around the origin
  std::vector<Edge> unused_;
};

}  // namespace

DelaunayMesh delaunay(const Sites& sites, std::uint64_t& steps) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < sites.at.size(); ++v)
    if (sites.is_representative(v)) order.push_back(v);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return before(sites.at[a], sites.at[b]); });
  Subdivision subdivision(sites, steps);
  subdivision.build(order.data(), order.data() + order.size());
  return subdivision.triangles();
}

}  // namespace gcdt::proof
