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
  gcdt_mesh view = GCDT_MESH_INIT;
  view.triangles = reinterpret_cast<const std::uint32_t*>(mesh.triangles.data);
  view.triangle_count = mesh.triangles.size;
  view.neighbours = reinterpret_cast<const std::int32_t*>(mesh.neighbours);
  view.constrained = mesh.constrained;
  view.added = reinterpret_cast<const std::int32_t*>(mesh.added.data), view.added_count = mesh.added.size;
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
