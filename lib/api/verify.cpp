// SPDX-License-Identifier: Apache-2.0
// The C interface: what needs no device.
#include <algorithm>
#include <cstddef>

#include <gcdt/detail.hpp>

#include "api/state.hpp"
#include "mesh/grid.hpp"
#include "proof/domain.hpp"
#include "proof/grid.hpp"
#include "proof/refined.hpp"
#include "query/imported.hpp"
#include "solve/memory.hpp"
#include "solve/refine.hpp"

using namespace gcdt;
using namespace gcdt::api;

Grid gcdt::api::read_grid(const gcdt_grid* given) {
  const gcdt_grid c = read_struct(given, "gcdt_grid");
  require(c.kind >= GCDT_GRID_BINARY && c.kind <= GCDT_GRID_FIXED, "gcdt_grid.kind is none of GCDT_GRID_...");
  return detail::grid(c);
}

MeshView gcdt::api::read_mesh(const gcdt_mesh* mesh) {
  const gcdt_mesh m = read_struct(mesh, "gcdt_mesh", offsetof(gcdt_mesh, added));
  require(m.triangles || m.triangle_count == 0, "gcdt_mesh.triangles is null");
  require(m.added || m.added_count == 0, "gcdt_mesh.added is null");
  MeshView view;
  view.triangles = {reinterpret_cast<const std::array<std::uint32_t, 3>*>(m.triangles),
                    static_cast<std::size_t>(m.triangle_count)};
  view.neighbours = reinterpret_cast<const std::array<std::int32_t, 3>*>(m.neighbours);
  view.constrained = m.constrained;
  view.added = {reinterpret_cast<const std::array<std::int32_t, 2>*>(m.added), static_cast<std::size_t>(m.added_count)};
  if (m.added_origins)
    view.added_origin = {reinterpret_cast<const std::array<std::uint32_t, 4>*>(m.added_origins), view.added.size()};
  return view;
}

namespace {

/// As read_mesh, of a mesh made with `crossing`.
MeshView read_mesh(const gcdt_mesh* mesh, Crossing crossing) {
  const MeshView view = api::read_mesh(mesh);
  require(crossing == Crossing::split || view.added.size() == 0, "only GCDT_CROSSING_SPLIT adds vertices");
  return view;
}

/// A grid without defect, for points on it.
Grid read_whole_grid(const gcdt_grid* given) {
  const Grid grid = read_grid(given);
  const std::string defect = proof::grid_defect(grid);
  require(defect.empty(), defect.c_str());
  return grid;
}

/// The status of a verification, and what guarded() may have caught while `prove` ran.
template <class Prove>
std::int32_t judged(Prove&& prove) {
  std::int32_t status = GCDT_OK;
  const std::int32_t thrown = guarded(nullptr, [&] {
    const Verification found = prove();
    if (!found.valid) status = failed(nullptr, GCDT_ERROR_NOT_VALID, found.reason.c_str());
  });
  return thrown != GCDT_OK ? thrown : status;
}

}  // namespace

double gcdt_grid_cell(uint64_t cell_units, int32_t cell_decimals, int32_t cell_exponent) {
  double edge = 0;
  guarded(nullptr, [&] { edge = cell_edge(cell_units, cell_decimals, cell_exponent); });
  return edge;
}

int32_t gcdt_grid_coordinates(const gcdt_grid* grid, const int32_t* points, uint64_t count, double* coordinates) {
  return guarded(nullptr, [&] {
    const Grid known = read_whole_grid(grid);
    require((points && coordinates) || count == 0, "points or coordinates is null");
    for (uint64_t i = 0; i < 2 * count; ++i)
      if (points[i] < 0)
        throw Error(
            Status::invalid_argument,
            "point " + std::to_string(i / 2) + " is not on the grid: " + std::to_string(points[i]) + " is negative",
            {i / 2, i % 2});
    const proof::Coordinates exact(known);
    for (uint64_t i = 0; i < 2 * count; ++i) coordinates[i] = exact.at(i % 2, points[i]);
  });
}

int32_t gcdt_grid_points(const gcdt_grid* grid, const double* coordinates, uint64_t count, int32_t* points) {
  return guarded(nullptr, [&] {
    const Grid known = read_whole_grid(grid);
    require((points && coordinates) || count == 0, "points or coordinates is null");
    std::vector<std::int32_t> placed(2 * count);
    for (uint64_t i = 0; i < 2 * count; ++i) {
      const auto refuse = [&](Status status, const char* why) {
        throw Error(status, "a coordinate of point " + std::to_string(i / 2) + why, {i / 2, i % 2});
      };
      if (!proof::is_finite(coordinates[i])) refuse(Status::coordinate_not_finite, " is not finite");
      const auto at = proof::nearest_at(known, i % 2, coordinates[i]);
      if (!at) refuse(Status::coordinate_outside_grid, " is outside the grid");
      placed[i] = *at;
    }
    std::copy(placed.begin(), placed.end(), points);
  });
}

uint64_t gcdt_required_bytes(uint64_t n, uint64_t m, uint64_t crossed) { return device_bytes_needed(n, m, crossed); }

uint64_t gcdt_required_bytes_refined(uint64_t n, uint64_t m, uint64_t crossed, uint64_t added) {
  return refined_bytes_needed(n, m, crossed, added);
}

int32_t gcdt_choose_grid(const gcdt_input* input, const gcdt_options* fixed, gcdt_grid* grid) {
  return guarded(nullptr, [&] {
    const Points points = read_points(read_struct(input, "gcdt_input"));
    const gcdt_grid chosen = detail::grid(proof::choose_grid(points, read_options(fixed).grid));
    require(grid, "grid is null");
    grid->struct_size = sizeof *grid;
    write_struct(chosen, grid, "gcdt_grid");
  });
}

int32_t gcdt_verify(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_grid* grid, int32_t crossing) {
  return judged([&] {
    const gcdt_input given = read_struct(input, "gcdt_input");
    const Crossing made = read_crossing(crossing, "crossing");
    return proof::verify(read_points(given), read_constraints(given), read_mesh(mesh, made), read_grid(grid), made);
  });
}

int32_t gcdt_verify_domain(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_regions* regions,
                           const gcdt_grid* grid, const gcdt_options* options) {
  return judged([&] {
    const gcdt_input given = read_struct(input, "gcdt_input");
    const Options made = read_options(options);
    require(!made.refine, "refined meshes are verified by gcdt_verify_refined: gcdt_options.refine must be null");
    const MeshView view = read_mesh(mesh, made.crossing);
    proof::RegionView said;
    if (regions) {
      const gcdt_regions r = read_struct(regions, "gcdt_regions");
      said = {r.regions, r.depths, r.windings};
    }
    return proof::verify_domain(read_points(given), read_constraints(given), view, said, read_grid(grid), made);
  });
}

int32_t gcdt_verify_refined(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_grid* grid,
                            const gcdt_options* options, gcdt_refined_report* report, uint8_t* excuses) {
  return judged([&] {
    using proof::Excuse;
    const gcdt_input given = read_struct(input, "gcdt_input");
    const Options made = read_options(options);
    require(made.refine.has_value(), "gcdt_options.refine is null");
    require(made.crossing != Crossing::split, "refined meshes are not verified under GCDT_CROSSING_SPLIT");
    check_refinement(*made.refine, made, given.vertex_count);
    if (report) read_struct(report, "gcdt_refined_report");
    const Grid at = read_whole_grid(grid);
    const MeshView view = api::read_mesh(mesh);
    const proof::RefinedProof proved =
        proof::verify_refined(read_points(given), read_constraints(given), view, at, made);
    if (!proved.reason.empty()) return Verification{false, proved.reason};
    if (excuses)
      std::transform(proved.excuses.begin(), proved.excuses.end(), excuses,
                     [](Excuse excuse) { return static_cast<uint8_t>(excuse); });
    if (report) {
      const auto count = [&](Excuse excuse) { return proved.excused[static_cast<std::size_t>(excuse)]; };
      gcdt_refined_report c = {};
      c.input_angle = count(Excuse::input_angle), c.beside_angle = count(Excuse::beside_angle);
      c.short_side = count(Excuse::short_side), c.limit = count(Excuse::limit);
      c.target = count(Excuse::target), c.fixed = count(Excuse::fixed), c.refused = count(Excuse::refused);
      c.on_constraints = proved.on_chains, c.far = proved.far, c.move = proved.move * at.cell();
      c.encroached = proved.encroached, c.refinements = proved.refinements;
      write_struct(c, report, "gcdt_refined_report");
    }
    return Verification{true, {}};
  });
}

int32_t gcdt_check(gcdt_solver* solver, const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_options* options) {
  return guarded_call(solver, [&] {
    const gcdt_input given = read_struct(input, "gcdt_input");
    const MeshView view = read_mesh(mesh);
    require(view.added.size() == 0, "added vertices of a mesh to be checked are vertices of the input");
    require(view.triangles.size() == 0 || (view.neighbours && view.constrained),
            "gcdt_mesh.neighbours or constrained is null");
    require(view.triangles.size() <= 2 * max_vertices, "gcdt_mesh.triangle_count is too large");
    require(given.constraint_count <= GCDT_MAX_CONSTRAINTS, "gcdt_input.constraint_count is too large");
    State& state = *solver->state;
    state.settle();
    state.runtime.memory().begin_call();
    check_imported(state.runtime, state.primitives, read_points(given), read_constraints(given), view,
                   read_options(options).grid);
  });
}
