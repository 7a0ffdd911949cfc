// SPDX-License-Identifier: Apache-2.0
#include "tiles/routes.hpp"

namespace gcdt::tiles {

namespace {

/// Turns a link in the direction of its constraint, from which it turns by less than a quarter.
void turn_along(const std::array<GridPoint, 2>& constraint, Link& link) {
  const auto& [a, b] = constraint;
  const auto& [p, q] = link.points;
  const std::int64_t turn = (std::int64_t{b[0]} - a[0]) * (std::int64_t{q[0]} - p[0]) +
                            (std::int64_t{b[1]} - a[1]) * (std::int64_t{q[1]} - p[1]);
  if (turn > 0) return;
  std::swap(link.ends[0], link.ends[1]);
  std::swap(link.points[0], link.points[1]);
}

const std::array<GridPoint, 2>& points_of(const std::vector<OpenConstraint>& open, std::uint32_t number) {
  const auto found = std::lower_bound(open.begin(), open.end(), number,
                                      [](const OpenConstraint& a, std::uint32_t b) { return a.number < b; });
  if (found == open.end() || found->number != number)
    throw Error(Status::check_failed, "tiles: a constraint is routed that is a tile's");
  return found->points;
}

bool is_among(const std::vector<std::uint32_t>& numbers, std::uint32_t number) {
  return std::binary_search(numbers.begin(), numbers.end(), number);
}

}  // namespace

Routed take_routes(std::uint64_t n, const SplitSeam& split, std::vector<std::uint32_t> owners) {
  const auto sources_of = [&](std::uint32_t c) { return split.seam.sources_of(c, split.tiles); };
  Routed routed;
  routed.owners = std::move(owners);
  std::vector<std::uint32_t> ids = split.seam.ids;
  for (const GridPoint& p : array_of<GridPoint>(split.made, GCDT_ADDED)) {
    ids.push_back(static_cast<std::uint32_t>(n + routed.added.size()));
    routed.added.push_back(p);
  }
  const std::size_t own = split.seam.points.size();
  const auto point = [&](std::uint32_t v) { return v < own ? split.seam.points[v] : routed.added[v - own]; };
  for (const Constraint& pair : array_of<Constraint>(split.made, GCDT_ADDED_CROSSINGS))
    routed.crossing.push_back({sources_of(pair[0]).at(0), sources_of(pair[1]).at(0)});
  const ProblemMesh mesh(split.made);
  for (std::uint32_t piece = 0; piece < mesh.pieces.size(); ++piece) {
    const auto& [a, b] = mesh.pieces[piece];
    for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i)
      for (const std::uint32_t c : sources_of(mesh.sources[i])) {
        if (!is_among(routed.owners, c)) continue;
        Link link = {c, {ids[a], ids[b]}, {point(a), point(b)}};
        turn_along(points_of(split.open, c), link);
        routed.links.push_back(link);
      }
  }
  std::sort(routed.links.begin(), routed.links.end(), [](const Link& a, const Link& b) {
    return std::make_pair(a.owner, a.ends) < std::make_pair(b.owner, b.ends);
  });
  return routed;
}

Replaced::Replaced(const GivenConstraints& given, const Routed& routed) {
  const auto add = [&](std::uint32_t number, const Constraint& both) {
    ends.push_back(both);
    constraints.numbers.push_back(number);
  };
  const bool with_points = !given.end_points.empty();
  auto link = std::lower_bound(routed.links.begin(), routed.links.end(), given.first,
                               [](const Link& a, std::uint64_t b) { return a.owner < b; });
  for (std::size_t c = 0; c < given.size(); ++c) {
    const std::uint32_t number = given.number_of(c);
    if (!is_among(routed.owners, number)) {
      add(number, given.ends[c]);
      if (with_points) constraints.end_points.push_back(given.end_points[c]);
    }
    for (; link != routed.links.end() && link->owner == number; ++link) {
      add(number, link->ends);
      if (with_points) constraints.end_points.push_back(link->points);
    }
  }
  constraints.ends = ends;
  constraints.count = given.count;
}

}  // namespace gcdt::tiles
