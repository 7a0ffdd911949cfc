// SPDX-License-Identifier: Apache-2.0
// The host's proof of a mesh: the grid, then the topology, the constraints, the flags and the Delaunay property.
#include <algorithm>

#include "proof/delaunay.hpp"
#include "proof/mesh.hpp"

namespace gcdt::proof {

/// Positive iff d is inside the circle through a, b, c (counter-clockwise), zero iff on it.
/// With S = 2^31 - 1: squared lengths are at most 2 S^2 < 2^63 and areas at most S^2 < 2^62 (twice the largest
/// triangle in a square of side S), so each of the three products is below 2^125.
Wide incircle(Vertex a, Vertex b, Vertex c, Vertex d) {
  auto lift = [&](Vertex v) {
    const std::int64_t x = std::int64_t(v.x) - d.x, y = std::int64_t(v.y) - d.y;
    return static_cast<Wide>(x * x + y * y);
  };
  return lift(a) * orient(d, b, c) + lift(b) * orient(d, c, a) + lift(c) * orient(d, a, b);
}

std::string place_sites(Points points, Constraints constraints, Span<std::array<std::int32_t, 2>> added,
                        const Grid& grid, std::optional<Sites>& sites) {
  if (points.size() > max_vertices) return say(points.size(), " vertices are more than ", max_vertices);
  if (constraints.size() >= none) return say(constraints.size(), " constraints are more than ", none - 1);
  for (std::size_t c = 0; c < constraints.size(); ++c)
    for (std::uint32_t v : constraints[c])
      if (v >= points.size()) return say("constraint ", c, ": vertex ", v, " does not exist");
  std::string reason;
  std::vector<Vertex> vertices = quantise(points, grid, reason);
  if (!reason.empty()) return reason;
  if (added.size() > max_vertices - vertices.size())
    return say(vertices.size(), " and ", added.size(), " added vertices are more than ", max_vertices);
  for (const auto& [x, y] : added) {
    if (x < 0 || y < 0) return say("added vertex ", vertices.size(), " is outside the grid");
    vertices.push_back({x, y});
  }
  sites.emplace(std::move(vertices));
  return {};
}

namespace {

/// The failure of unconstrained half-edge h, which has a twin, to be the right diagonal (docs/contract.md, 4).
std::string check_diagonal(const Mesh& mesh, std::uint32_t h) {
  const Vertex a = mesh.at(mesh.from(h)), b = mesh.at(mesh.to(h)), c = mesh.at(mesh.apex(h));
  const Vertex d = mesh.at(mesh.apex(mesh.twin(h)));
  const Wide inside = incircle(a, b, c, d);
  if (inside < 0) return {};
  if (inside > 0)
    return say(mesh.edge_name(h), " is not locally Delaunay: vertex ", mesh.apex(mesh.twin(h)),
               " is inside the circle of ", mesh.triangle_name(h / 3));
  const Vertex least_end = before(a, b) ? a : b, least_other = before(c, d) ? c : d;
  if (before(least_end, least_other)) return {};
  return say(mesh.edge_name(h), " is the wrong diagonal of four cocircular vertices: it must end at vertex ",
             before(c, d) ? mesh.apex(h) : mesh.apex(mesh.twin(h)));
}

std::string check_delaunay(const Mesh& mesh, const Sources& sources) {
  for (std::uint32_t h = 0; h < mesh.half_edges(); ++h) {
    if (mesh.twin(h) == none || mesh.twin(h) < h || sources[h] != none) continue;
    auto reason = check_diagonal(mesh, h);
    if (!reason.empty()) return reason;
  }
  return {};
}

std::string check_flags(const Mesh& mesh, const std::uint8_t* constrained, const Sources& sources) {
  for (std::uint32_t h = 0; h < mesh.half_edges(); ++h) {
    if (h % 3 == 0 && constrained[h / 3] > 7)
      return say(mesh.triangle_name(h / 3), " has flags of edges it does not have");
    const bool flag = constrained[h / 3] >> h % 3 & 1;
    if (flag == (sources[h] != none)) continue;
    const auto where = say(mesh.edge_name(h), " of ", mesh.triangle_name(h / 3));
    if (flag) return say(where, " is flagged as constrained, but no constraint runs along it");
    return say(where, " is not flagged as constrained, but constraint ", sources[h], " runs along it");
  }
  return {};
}

/// The first failure, or an empty text.
std::string prove(Points points, Constraints constraints, const MeshView& view, const Grid& grid, Crossing crossing) {
  std::optional<Sites> placed;
  auto reason = place_sites(points, constraints, view.added, grid, placed);
  if (!reason.empty()) return reason;
  const Sites& sites = *placed;
  const auto inputs = static_cast<std::uint32_t>(points.size());
  reason = check_added(sites, inputs);
  if (!reason.empty()) return reason;
  if (sites.flat) {
    if (view.added.size() > 0) return "vertices were added, but all are on one line";
    if (view.triangles.size() == 0) return {};
    return say(view.triangles.size(), " triangles, but the ", sites.distinct, " distinct vertices are all on one line");
  }
  Mesh mesh(sites, view);
  reason = mesh.prove_topology();
  Sources sources;
  if (reason.empty())
    reason = crossing == Crossing::split ? prove_split(sites, mesh, inputs, constraints, sources)
                                         : prove_constraints(sites, mesh, constraints, crossing, sources);
  if (reason.empty() && view.constrained) reason = check_flags(mesh, view.constrained, sources);
  if (reason.empty()) reason = check_delaunay(mesh, sources);
  return reason;
}

}  // namespace

Verification verify(Points points, Constraints constraints, const MeshView& mesh, const Grid& grid, Crossing crossing) {
  const std::string reason = prove(points, constraints, mesh, grid, crossing);
  return {reason.empty(), reason};
}

}  // namespace gcdt::proof
