// SPDX-License-Identifier: Apache-2.0
// Proves that the triangles cover the convex hull exactly once and that every representative is a corner.
//
// The proof: every triangle is counter-clockwise and every directed edge is in one triangle. Then the boundaries of
// the triangles add up to the half-edges without a twin, and the number of triangles over a point is the
// winding number of that boundary around it. The boundary is one closed polygon that never turns right and turns
// around once, so that is 1 inside and 0 outside. All representatives are corners, so the inside is their hull,
// and none is inside an edge, since the triangles around it would cover something twice.
#include "proof/mesh.hpp"

#include <algorithm>

namespace gcdt::proof {

Sites::Sites(std::vector<Vertex> vertices) : at(std::move(vertices)), representative(at.size()) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(at.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = {at[i].key(), i};
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && order[i].first == order[i - 1].first;
    representative[order[i].second] = same ? representative[order[i - 1].second] : order[i].second;
    distinct += !same;
  }
  flat = true;
  for (std::size_t i = 0; i < order.size() && flat; ++i)
    flat = orient(at[order.front().second], at[order.back().second], at[order[i].second]) == 0;
}

std::string Mesh::triangle_name(std::uint32_t t) const {
  const auto& corners = view_.triangles[t];
  return say("triangle ", t, " (", corners[0], ", ", corners[1], ", ", corners[2], ")");
}

std::string Mesh::prove_topology() {
  auto reason = check_triangles();
  if (reason.empty()) {
    sort_stars();
    reason = check_stars();
  }
  if (!reason.empty()) return reason;
  match_twins();
  if (view_.neighbours) reason = check_given_neighbours();
  if (reason.empty()) reason = check_boundary();
  return reason;
}

std::string Mesh::check_triangles() const {
  if (view_.triangles.size() > 2 * sites_.distinct)
    return say(view_.triangles.size(), " triangles are more than ", sites_.distinct, " distinct vertices can have");
  for (std::uint32_t t = 0; t < view_.triangles.size(); ++t) {
    const auto& corners = view_.triangles[t];
    for (std::uint32_t v : corners) {
      if (v >= sites_.at.size()) return say(triangle_name(t), ": vertex ", v, " does not exist");
      if (!sites_.is_representative(v))
        return say(triangle_name(t), ": vertex ", v, " is a duplicate of vertex ", sites_.representative[v]);
    }
    if (orient(at(corners[0]), at(corners[1]), at(corners[2])) <= 0)
      return say(triangle_name(t), " is not counter-clockwise");
  }
  return {};
}

void Mesh::sort_stars() {
  first_.assign(sites_.at.size() + 2, 0);
  leaving_.resize(half_edges());
  for (std::uint32_t h = 0; h < half_edges(); ++h) ++first_[from(h) + 2];
  for (std::size_t v = 2; v < first_.size(); ++v) first_[v] += first_[v - 1];
  for (std::uint32_t h = 0; h < half_edges(); ++h) leaving_[first_[from(h) + 1]++] = {to(h), h};
  for (std::uint32_t v = 0; v < sites_.at.size(); ++v)
    std::sort(leaving_.begin() + first_[v], leaving_.begin() + first_[v + 1], [&](const Leaving& a, const Leaving& b) {
      const int order = compare_angles({at(v), at(a.to)}, {at(v), at(b.to)});
      if (order != 0) return order < 0;
      return a.to != b.to ? a.to < b.to : a.half_edge < b.half_edge;
    });
}

std::string Mesh::check_stars() const {
  for (std::uint32_t v = 0; v < sites_.at.size(); ++v) {
    if (first_[v] == first_[v + 1] && sites_.is_representative(v))
      return say("vertex ", v, " is a corner of no triangle");
    for (std::uint32_t i = first_[v] + 1; i < first_[v + 1]; ++i)
      if (leaving_[i].to == leaving_[i - 1].to)
        return say("the directed edge ", v, " -> ", leaving_[i].to,
                   " is in two triangles: ", triangle_name(leaving_[i - 1].half_edge / 3), " and ",
                   triangle_name(leaving_[i].half_edge / 3));
  }
  return {};
}

std::uint32_t Mesh::find(std::uint32_t origin, std::uint32_t target) const {
  const auto begin = leaving_.begin() + first_[origin], end = leaving_.begin() + first_[origin + 1];
  const auto found = std::lower_bound(begin, end, target, [&](const Leaving& a, std::uint32_t w) {
    const int order = compare_angles({at(origin), at(a.to)}, {at(origin), at(w)});
    return order != 0 ? order < 0 : a.to < w;
  });
  return found != end && found->to == target ? found->half_edge : none;
}

void Mesh::match_twins() {
  twins_.resize(half_edges());
  for (std::uint32_t h = 0; h < half_edges(); ++h) twins_[h] = find(to(h), from(h));
}

std::string Mesh::check_given_neighbours() const {
  for (std::uint32_t h = 0; h < half_edges(); ++h) {
    const std::int64_t given = view_.neighbours[h / 3][h % 3];
    const std::int64_t right = twins_[h] == none ? -1 : std::int64_t(twins_[h] / 3);
    if (given != right)
      return say(triangle_name(h / 3), ": the neighbour across ", edge_name(h), " is ", right, ", not ", given);
  }
  return {};
}

std::string Mesh::check_boundary() const {
  std::vector<std::uint32_t> boundary_from(sites_.at.size(), none);
  std::uint64_t count = 0;
  std::uint32_t first = none;
  for (std::uint32_t h = 0; h < half_edges(); ++h) {
    if (twins_[h] != none) continue;
    if (boundary_from[from(h)] != none) return say("the boundary passes vertex ", from(h), " twice");
    boundary_from[from(h)] = h;
    first = h;
    ++count;
  }
  if (count == 0) return "the mesh has no boundary";
  auto reason = check_turns(boundary_from, first, count);
  if (reason.empty() && view_.triangles.size() != 2 * sites_.distinct - 2 - count)
    reason = say(view_.triangles.size(), " triangles, but ", sites_.distinct, " distinct vertices with ", count,
                 " on the hull have ", 2 * sites_.distinct - 2 - count);
  return reason;
}

/// The boundary, followed from half-edge `first`, returns to it after all `count` edges, never turns right or back,
/// and its direction passes the angle 0 once.
std::string Mesh::check_turns(const std::vector<std::uint32_t>& boundary_from, std::uint32_t first,
                              std::uint64_t count) const {
  std::uint64_t steps = 0, rounds = 0;
  std::uint32_t h = first;
  do {
    const std::uint32_t following = boundary_from[to(h)];
    if (following == none) return say("the boundary ends at vertex ", to(h));
    const Direction in(at(from(h)), at(to(h))), out(at(from(following)), at(to(following)));
    const std::int64_t turn = cross(in, out);
    if (turn < 0 || (turn == 0 && in.lower() != out.lower()))
      return say("the boundary is not convex at vertex ", to(h), ": it comes from vertex ", from(h),
                 " and goes to vertex ", to(following));
    rounds += in.lower() && !out.lower();
    h = following;
    ++steps;
  } while (h != first && steps <= count);
  if (h != first || steps != count)
    return say("the boundary is not one closed polygon: vertex ", from(first), " is not on all of it");
  if (rounds != 1) return say("the boundary through vertex ", from(first), " turns around ", rounds, " times");
  return {};
}

Mesh::Exit Mesh::leave(std::uint32_t v, std::uint32_t w) const {
  const Direction ray(at(v), at(w));
  const auto begin = leaving_.begin() + first_[v], end = leaving_.begin() + first_[v + 1];
  auto last = std::upper_bound(begin, end, ray, [&](const Direction& d, const Leaving& a) {
    return compare_angles(d, {at(v), at(a.to)}) < 0;
  });
  if (last == begin) last = end;  // the triangle over angle 0
  --last;
  const std::uint32_t h = last->half_edge, previous = apex(h);
  if (compare_angles(ray, {at(v), at(last->to)}) == 0) return {true, h, last->to};
  if (compare_angles(ray, {at(v), at(previous)}) == 0) return {true, proof::previous(h), previous};
  return {false, next(h), none};
}

}  // namespace gcdt::proof
