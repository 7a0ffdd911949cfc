// SPDX-License-Identifier: Apache-2.0
#include "prove.hpp"

#include <fmt/format.h>

namespace gcdt::command {

MeshView view_of(const io::MeshArrays& mesh) {
  MeshView view;
  view.triangles = mesh.triangles;
  view.neighbours = mesh.neighbours.data();
  view.constrained = mesh.constrained.data();
  view.added = mesh.added_on_grid;
  view.added_origin = mesh.added_origin;
  return view;
}

namespace {

/// The proof does not look for places outside of the convex hull, so what the limit of vertices has left may be
/// refused.
bool may_be(std::uint8_t said, std::uint8_t found) { return said == GCDT_EXCUSE_LIMIT && found == GCDT_EXCUSE_REFUSED; }

/// As the mesh is, and why triangles were left as the result says.
Verification prove_refined(const io::Input& input, const io::MeshArrays& mesh, const Options& options) {
  const RefinedVerification found =
      verify_refined(input.vertices, input.constraints, view_of(mesh), mesh.statistics.grid, options);
  if (!found.valid) return found;
  if (found.refinements > 1) return {false, "added vertices are not in order"};
  for (std::size_t t = 0; t < mesh.excuse.size(); ++t)
    if (found.excuses[t] != mesh.excuse[t] && !may_be(mesh.excuse[t], found.excuses[t]))
      return {false, fmt::format("triangle {} was left for reason {}, but what the mesh shows is {}", t, mesh.excuse[t],
                                 found.excuses[t])};
  return found;
}

}  // namespace

Verification prove(const io::Input& input, const io::MeshArrays& mesh, const Options& options) {
  const MeshView view = view_of(mesh);
  const Grid& grid = mesh.statistics.grid;
  if (options.refine) return prove_refined(input, mesh, options);
  if (!options.regions && options.domain == Domain::hull)
    return gcdt::verify(input.vertices, input.constraints, view, grid, options.crossing);
  const RegionView said = {mesh.region.data(), mesh.depth.data(), mesh.winding.data()};
  return gcdt::verify_domain(input.vertices, input.constraints, view, said, grid, options);
}

}  // namespace gcdt::command
