// SPDX-License-Identifier: Apache-2.0
#include "prove.hpp"

#include "refinement.hpp"

namespace gcdt::command {

MeshView view_of(const Triangulation& mesh) {
  MeshView view;
  view.triangles = mesh.triangles;
  view.neighbours = mesh.neighbours.data();
  view.constrained = mesh.constrained.data();
  view.added = mesh.added_on_grid;
  view.added_origin = mesh.added_origin;
  return view;
}

Verification prove(const io::Input& input, const Triangulation& mesh, const Options& options) {
  const MeshView view = view_of(mesh);
  const Grid& grid = mesh.statistics.grid;
  if (options.refine) {
    const RefinedVerification found = verify_refined_but(uncovered(mesh.statistics), input, view, grid, options);
    if (found.refinements > 1) return {false, "added vertices are not in order"};
    return found;
  }
  if (!options.regions && options.domain == Domain::hull)
    return gcdt::verify(input.vertices, input.constraints, view, grid, options.crossing);
  const RegionView said = {mesh.region.data(), mesh.depth.data(), mesh.winding.data()};
  return gcdt::verify_domain(input.vertices, input.constraints, view, said, grid, options);
}

}  // namespace gcdt::command
