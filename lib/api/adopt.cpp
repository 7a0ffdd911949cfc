// SPDX-License-Identifier: Apache-2.0
// The C interface: results of meshes that are there already.
#include "query/adopt.hpp"

#include "api/state.hpp"

using namespace gcdt;
using namespace gcdt::api;

int32_t gcdt_adopt(gcdt_solver* solver, const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_options* options,
                   gcdt_result** result) {
  return guarded_call(solver, [&] {
    give_result(solver->state, result, [&] {
      const gcdt_input given = read_struct(input, "gcdt_input");
      const MeshView made = read_mesh(mesh);
      const Triangles triangles = made.triangles;
      require(made.added.empty(), "added vertices of a mesh to be adopted are vertices of the input");
      require(triangles.size() <= 2 * max_vertices, "gcdt_mesh.triangle_count is too large");
      const Points points = read_points(given);
      const Constraints constraints = read_constraints(given);
      Options wanted = read_options(options);
      require(wanted.crossing == Crossing::reject && wanted.domain == Domain::hull && !wanted.regions,
              "a mesh to be adopted is taken as it is: gcdt_options.crossing, domain and regions must be 0");
      require(!wanted.refine, "a mesh to be adopted is taken as it is: gcdt_options.refine must be null");
      wanted.canonical = true;
      const std::vector<Constraint> edges = edges_of(triangles, points.size());
      State& state = *solver->state;
      std::vector<Constraint> all(constraints.begin(), constraints.end());
      all.insert(all.end(), edges.begin(), edges.end());
      DeviceTriangulation whole;
      try {
        whole = state.triangulate(source_of(state.runtime, points, all), wanted);
      } catch (const Error& error) {
        throw mesh_error(error, constraints, edges);
      }
      return adopt(state.runtime, state.primitives, std::move(whole), triangles,
                   static_cast<std::uint32_t>(constraints.size()));
    });
  });
}
