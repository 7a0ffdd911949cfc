// SPDX-License-Identifier: Apache-2.0
// The independent proof of a result: exact host arithmetic, no device, no code shared with the pipeline. And the
// device's own check, for any mesh.
#pragma once

#include <gcdt/gcdt.hpp>

namespace gcdt {

/// The grid that triangulate() chooses for `points` (or the fixed one), by host arithmetic.
/// Throws coordinate_not_finite or coordinate_outside_grid as triangulate() does.
inline Grid choose_grid(Points points, const std::optional<FixedGrid>& fixed = {}) {
  const gcdt_input input = detail::input(points, {});
  Options options;
  options.grid = fixed;
  detail::ProgressCall none;
  const gcdt_options given = detail::options(options, none);
  gcdt_grid grid = {};
  grid.struct_size = sizeof grid;
  detail::check(gcdt_choose_grid(&input, &given, &grid));
  return detail::grid(grid);
}

/// What `mesh`, valid on `grid`, is worth at the coordinates as they were given; see gcdt_assess.
inline Assessment assess(Points points, const MeshView& mesh, const Grid& grid) {
  const gcdt_input input = detail::input(points, {});
  const gcdt_mesh view = detail::mesh(mesh);
  const gcdt_grid at = detail::grid(grid);
  gcdt_assessment c = {};
  c.struct_size = sizeof c;
  detail::check(gcdt_assess(&input, &view, &at, &c));
  return {c.valid != 0,     c.outline_simple != 0, c.triangles_inverted,
          c.triangles_flat, c.vertices_lost,       c.edges_not_delaunay};
}

/// Proves that `mesh` is the CDT of `points` and `constraints` on `grid`: every triangle
/// counter-clockwise, every link two-sided, the boundary closed and convex, every representative a
/// corner, every constraint of the input a chain of edges, every other edge locally Delaunay with
/// the tie rule. Under Crossing::drop it also proves that exactly the right constraints are missing; under
/// Crossing::split see gcdt_verify.
/// Never throws on a bad mesh: an index that does not exist is a failed verification.
/// O((n + m) log n) expected; thread-safe.
inline Verification verify(Points points, Constraints constraints, const MeshView& mesh, const Grid& grid,
                           Crossing crossing = Crossing::reject) {
  const gcdt_input input = detail::input(points, constraints);
  const gcdt_mesh view = detail::mesh(mesh);
  const gcdt_grid at = detail::grid(grid);
  return detail::verification(gcdt_verify(&input, &view, &at, detail::crossing(crossing)));
}

/// What is said of each triangle of a mesh; null: not verified.
struct RegionView {
  const std::uint32_t *region = nullptr, *depth = nullptr;
  const std::int32_t* winding = nullptr;
};

/// As verify(), of a mesh made with `options`, of which crossing, domain and hole seeds are read; regions are numbered
/// as in canonical order. O((n + m) log n) expected, log n times that for the worst of inputs, more where constraints
/// were dropped. See gcdt_verify_domain.
inline Verification verify_domain(Points points, Constraints constraints, const MeshView& mesh,
                                  const RegionView& regions, const Grid& grid, const Options& options) {
  const gcdt_input input = detail::input(points, constraints);
  const gcdt_mesh view = detail::mesh(mesh);
  const gcdt_regions said = {sizeof said, regions.region, regions.depth, regions.winding};
  const gcdt_grid at = detail::grid(grid);
  detail::ProgressCall none;
  const detail::GivenOptions given(options, none);
  return detail::verification(gcdt_verify_domain(&input, &view, &said, &at, &given.c));
}

/// Of a refined mesh; see gcdt_refined_report.
struct RefinedVerification : Verification {
  std::uint64_t input_angle = 0, beside_angle = 0, short_side = 0, limit = 0;  ///< triangles that are excused
  std::uint64_t target = 0, fixed = 0, refused = 0;                            ///< more of them
  std::uint64_t on_constraints = 0, far = 0;                                   ///< added vertices
  double move = 0;
  std::uint64_t encroached = 0;       ///< if conforming: sides on constraints with a corner in the circle over them
  std::uint64_t refinements = 0;      ///< one after the other; 0 if nothing was added
  std::vector<std::uint8_t> excuses;  ///< one a triangle: GCDT_EXCUSE_...
};

/// Proves a mesh that was made with Options::refine, by its triangles; see gcdt_verify_refined. Of `options` refine,
/// crossing, domain, hole and region seeds are read.
inline RefinedVerification verify_refined(Points points, Constraints constraints, const MeshView& mesh,
                                          const Grid& grid, const Options& options) {
  const gcdt_input input = detail::input(points, constraints);
  const gcdt_mesh view = detail::mesh(mesh);
  const gcdt_grid at = detail::grid(grid);
  detail::ProgressCall none;
  const detail::GivenOptions given(options, none);
  gcdt_refined_report c = {};
  c.struct_size = sizeof c;
  RefinedVerification found;
  found.excuses.resize(mesh.triangles.size());
  static_cast<Verification&>(found) =
      detail::verification(gcdt_verify_refined(&input, &view, &at, &given.c, &c, found.excuses.data()));
  if (!found.valid) return found;
  found.input_angle = c.input_angle, found.beside_angle = c.beside_angle;
  found.short_side = c.short_side, found.limit = c.limit;
  found.target = c.target, found.fixed = c.fixed, found.refused = c.refused;
  found.on_constraints = c.on_constraints, found.far = c.far, found.move = c.move;
  found.encroached = c.encroached, found.refinements = c.refinements;
  return found;
}

/// The device's check of a mesh that covers the hull; `pieces`: the constraints after cleaning. Throws check_failed,
/// naming the first fault. See gcdt_check.
inline void check(const Solver& solver, Points points, Constraints pieces, const MeshView& mesh,
                  const std::optional<FixedGrid>& grid = {}) {
  const gcdt_input input = detail::input(points, pieces);
  const gcdt_mesh view = detail::mesh(mesh);
  Options options;
  options.grid = grid;
  detail::ProgressCall none;
  const gcdt_options given = detail::options(options, none);
  detail::check(gcdt_check(solver.handle(), &input, &view, &given));
}

}  // namespace gcdt
