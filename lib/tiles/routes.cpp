// SPDX-License-Identifier: Apache-2.0
#include "tiles/routes.hpp"

namespace gcdt::tiles {

namespace {

/// A link in the direction of its constraint, from which it turns by less than a quarter.
template <class PointOf>
Constraint along(const Constraint& constraint, const Constraint& link, PointOf&& point) {
  const GridPoint a = point(constraint[0]), b = point(constraint[1]), p = point(link[0]), q = point(link[1]);
  const std::int64_t turn = (std::int64_t{b[0]} - a[0]) * (std::int64_t{q[0]} - p[0]) +
                            (std::int64_t{b[1]} - a[1]) * (std::int64_t{q[1]} - p[1]);
  return turn > 0 ? link : Constraint{link[1], link[0]};
}

}  // namespace

Routed take_routes(const GridInput& input, const SplitSeam& split, const std::vector<bool>& is_routed) {
  const auto sources_of = [&](std::uint32_t c) { return split.seam.sources_of(c, split.tiles); };
  Routed routed;
  std::vector<std::uint32_t> ids = split.seam.ids;
  for (const GridPoint& p : array_of<GridPoint>(split.made, GCDT_ADDED)) {
    ids.push_back(static_cast<std::uint32_t>(input.n() + routed.added.size()));
    routed.added.push_back(p);
  }
  const auto point = [&](std::uint32_t v) { return v < input.n() ? input.at(v) : routed.added[v - input.n()]; };
  for (const Constraint& pair : array_of<Constraint>(split.made, GCDT_ADDED_CROSSINGS))
    routed.crossing.push_back({sources_of(pair[0]).at(0), sources_of(pair[1]).at(0)});
  std::vector<std::pair<std::uint32_t, Constraint>> links;
  const ProblemMesh mesh(split.made);
  for (std::uint32_t piece = 0; piece < mesh.pieces.size(); ++piece) {
    const Constraint link = {ids[mesh.pieces[piece][0]], ids[mesh.pieces[piece][1]]};
    for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i)
      for (const std::uint32_t c : sources_of(mesh.sources[i]))
        if (is_routed[c]) links.emplace_back(c, along(input.constraints[c], link, point));
  }
  std::sort(links.begin(), links.end());
  std::size_t next = 0;
  const auto add = [&](const Constraint& ends, std::uint32_t owner) {
    routed.constraints.push_back(ends);
    routed.owners.push_back(owner);
  };
  for (std::uint32_t c = 0; c < is_routed.size(); ++c) {
    routed.count += is_routed[c];
    if (!is_routed[c]) add(input.constraints[c], c);
    for (; next < links.size() && links[next].first == c; ++next) add(links[next].second, c);
  }
  return routed;
}

}  // namespace gcdt::tiles
