// SPDX-License-Identifier: Apache-2.0
// The host's proof of a domain: the whole mesh is made once more, by another algorithm, and proved as any mesh is;
// its regions are flooded one by one; what they leave must be the mesh that is to be verified.
#include "proof/domain.hpp"

#include "proof/whole.hpp"

namespace gcdt::proof {

namespace {

std::string compare_region(const Comparison& comparison, const Flood& flood, std::uint32_t g, const RegionView& given) {
  const std::uint32_t r = flood.region[comparison.right_of()[g]];
  if (given.region && given.region[g] != r)
    return say(comparison.name(g), " is in region ", r, ", not ", given.region[g]);
  if (given.depth && given.depth[g] != flood.depth[r])
    return say(comparison.name(g), " has depth ", flood.depth[r], ", not ", given.depth[g]);
  if (given.winding && given.winding[g] != flood.winding[r])
    return say(comparison.name(g), " has winding number ", flood.winding[r], ", not ", given.winding[g]);
  return {};
}

std::string prove(Points points, Constraints constraints, const MeshView& view, const RegionView& regions,
                  const Grid& grid, const Options& options, std::uint64_t& steps) {
  std::optional<Sites> placed;
  std::string reason = place_sites(points, constraints, view.added, grid, placed);
  if (!reason.empty()) return reason;
  const Sites& sites = *placed;
  if (sites.flat) return verify(points, constraints, view, grid, options.crossing).reason;
  Rebuilt rebuilt{sites, static_cast<std::uint32_t>(points.size()), constraints, options.crossing, steps};
  reason = rebuilt.run();
  if (!reason.empty()) return reason;
  const Completion& mesh = *rebuilt.mesh;
  MeshView whole;
  whole.triangles = mesh.triangles();
  whole.added = view.added;
  const Verification proved = verify(points, constraints, whole, grid, options.crossing);
  if (!proved.valid) return say("the whole mesh made for comparison is not valid: ", proved.reason);
  Mesh whole_mesh(sites, whole);
  whole_mesh.prove_topology();
  const Flood flood(mesh, whole_mesh, rebuilt.paths);
  std::vector<char> flags(3 * mesh.triangles().size());
  for (std::uint32_t h = 0; h < flags.size(); ++h) flags[h] = mesh.constrained(h);
  const std::vector<char> keep = chosen(sites, mesh, flood, grid, options, steps);
  Comparison comparison(mesh, keep, flags, view);
  reason = comparison.run();
  for (std::uint32_t g = 0; g < view.triangles.size() && reason.empty(); ++g)
    reason = compare_region(comparison, flood, g, regions);
  return reason;
}

}  // namespace

Verification verify_domain(Points points, Constraints constraints, const MeshView& mesh, const RegionView& regions,
                           const Grid& grid, const Options& options, std::uint64_t* steps) {
  std::uint64_t taken = 0;
  const std::string reason = prove(points, constraints, mesh, regions, grid, options, taken);
  if (steps) *steps = taken;
  return {reason.empty(), reason};
}

}  // namespace gcdt::proof
