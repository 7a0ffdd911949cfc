// SPDX-License-Identifier: Apache-2.0
#include "proof/locate.hpp"

#include <algorithm>
#include <set>

namespace gcdt::proof {

namespace {

/// From left to right, at equal x from below: the edges that begin before the sweep line and end behind it, from below.
/// A vertex is passed by removing the edges that end there, then adding those that begin.
class Sweep {
 public:
  Sweep(const Sites& sites, const Completion& mesh, std::uint64_t& steps)
      : sites_(sites), mesh_(mesh), steps_(steps), active_(Below{this}) {
    for (std::uint32_t h = 0; h < 3 * mesh.triangles().size(); ++h) {
      corners_.push_back({corner(h, 0), h / 3});
      // One half-edge an edge: that which has its triangle above it, if there is one.
      if (!rises(h) && mesh.twin(h) != none) continue;
      begins_.push_back({left(h), h});
      ends_.push_back({right(h), h});
    }
    for (auto* list : {&corners_, &begins_, &ends_})
      std::sort(list->begin(), list->end(), [&](const Event& a, const Event& b) {
        return a.vertex != b.vertex ? before(at(a.vertex), at(b.vertex)) : a.number < b.number;
      });
  }

  std::vector<std::uint32_t> run(const std::vector<Vertex>& places) {
    std::vector<std::uint32_t> found;
    std::size_t corner = 0, begin = 0, end = 0;
    for (const Vertex& place : places) {
      // The vertices before the place; then, if there is one at the place, its first triangle is the least.
      while (corner < corners_.size() && before(at(corners_[corner].vertex), place)) {
        const std::uint32_t v = corners_[corner].vertex;
        for (; end < ends_.size() && ends_[end].vertex == v; ++end, ++steps_) active_.erase(ends_[end].number);
        for (; begin < begins_.size() && begins_[begin].vertex == v; ++begin, ++steps_)
          active_.insert(begins_[begin].number);
        for (; corner < corners_.size() && corners_[corner].vertex == v; ++corner) ++steps_;
      }
      ++steps_;
      const bool at_vertex = corner < corners_.size() && !before(place, at(corners_[corner].vertex));
      found.push_back(at_vertex ? corners_[corner].number : above(place));
    }
    return found;
  }

 private:
  struct Event {
    std::uint32_t vertex, number;
  };
  struct Below {
    using is_transparent = void;
    const Sweep* sweep;
    /// Of two edges that the sweep line meets, which do not cross: the later begin decides, or with a common one the
    /// ends do.
    bool operator()(std::uint32_t h, std::uint32_t g) const {
      const std::uint32_t a = sweep->left(h), b = sweep->right(h), c = sweep->left(g), d = sweep->right(g);
      if (a == c) return sweep->turn(a, b, sweep->at(d)) > 0;
      return before(sweep->at(a), sweep->at(c)) ? sweep->turn(a, b, sweep->at(c)) > 0
                                                : sweep->turn(c, d, sweep->at(a)) < 0;
    }
    bool operator()(std::uint32_t h, const Vertex& place) const {
      return sweep->turn(sweep->left(h), sweep->right(h), place) >= 0;
    }
  };

  /// Corner k of the triangle of h, counted from the one across from h.
  std::uint32_t corner(std::uint32_t h, std::uint32_t k) const { return mesh_.triangles()[h / 3][(h + k) % 3]; }
  const Vertex& at(std::uint32_t v) const { return sites_.at[v]; }
  bool rises(std::uint32_t h) const { return before(at(corner(h, 1)), at(corner(h, 2))); }
  std::uint32_t left(std::uint32_t h) const { return corner(h, rises(h) ? 1 : 2); }
  std::uint32_t right(std::uint32_t h) const { return corner(h, rises(h) ? 2 : 1); }
  std::int64_t turn(std::uint32_t a, std::uint32_t b, const Vertex& c) const { return orient(at(a), at(b), c); }

  /// The triangle over the highest edge that is not above the place, which is no vertex; the lesser of two on the edge.
  std::uint32_t above(const Vertex& place) const {
    auto edge = active_.lower_bound(place);
    if (edge == active_.begin()) return none;
    const std::uint32_t h = *--edge, twin = mesh_.twin(h);
    if (turn(left(h), right(h), place) == 0) return twin == none ? h / 3 : std::min(h, twin) / 3;
    return rises(h) ? h / 3 : none;  // else it is under the hull's upper side
  }

  const Sites& sites_;
  const Completion& mesh_;
  std::uint64_t& steps_;
  std::vector<Event> corners_;        // of triangles
  std::vector<Event> begins_, ends_;  // of half-edges
  std::set<std::uint32_t, Below> active_;
};

}  // namespace

std::vector<std::uint32_t> least_triangles(const Sites& sites, const Completion& mesh,
                                           const std::vector<Vertex>& places, std::uint64_t& steps) {
  std::vector<Vertex> order = places;
  std::sort(order.begin(), order.end(), before);
  const auto same = [](const Vertex& a, const Vertex& b) { return a.key() == b.key(); };
  order.erase(std::unique(order.begin(), order.end(), same), order.end());
  if (order.empty()) return {};
  const std::vector<std::uint32_t> found = Sweep(sites, mesh, steps).run(order);
  std::vector<std::uint32_t> triangles;
  for (const Vertex& place : places)
    triangles.push_back(
        found[static_cast<std::size_t>(std::lower_bound(order.begin(), order.end(), place, before) - order.begin())]);
  return triangles;
}

}  // namespace gcdt::proof
