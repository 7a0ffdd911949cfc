// SPDX-License-Identifier: Apache-2.0
// The independent proof of a result: exact host arithmetic, no device, no code shared with the pipeline.
#pragma once

#include <gcdt/detail.hpp>

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
  const std::int32_t status = gcdt_verify(&input, &view, &at, detail::crossing(crossing));
  if (status != GCDT_ERROR_NOT_VALID) {
    detail::check(status);
    return {true, {}};
  }
  gcdt_error error = GCDT_ERROR_INIT;
  gcdt_last_error(nullptr, &error);
  return {false, error.message};
}

}  // namespace gcdt
