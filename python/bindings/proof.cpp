// SPDX-License-Identifier: Apache-2.0
// Verification and assessment, on the host and on the device.
#include <optional>

#include <nanobind/stl/optional.h>

#include <gcdt/verify.hpp>

#include "results.hpp"

namespace gcdt::python {

namespace {

/// A mesh in numpy's memory; what is None is not looked at.
struct GivenMesh {
  Rows<std::uint32_t, 3> triangles;
  std::optional<Rows<std::int32_t, 3>> neighbours;
  std::optional<Row<std::uint8_t>> constrained;
  Rows<std::int32_t, 2> added;
  std::optional<Rows<std::uint32_t, 4>> origins;

  MeshView view() const {
    MeshView mesh;
    mesh.triangles = span(triangles);
    if (neighbours) mesh.neighbours = span(*neighbours).data();
    if (constrained) mesh.constrained = constrained->data();
    mesh.added = span(added);
    if (origins) mesh.added_origin = span(*origins);
    return mesh;
  }
};

nb::tuple verdict(const Verification& v) { return nb::make_tuple(v.valid, v.reason); }

nb::dict assessed(const Pairs& vertices, const GivenMesh& mesh, const nb::dict& grid) {
  const Points given = points(vertices);
  const Grid on = grid_of(grid);
  Assessment a;
  {
    nb::gil_scoped_release release;
    a = assess(given, mesh.view(), on);
  }
  nb::dict d;
  d["valid"] = a.valid, d["outline_simple"] = a.outline_simple, d["triangles_inverted"] = a.triangles_inverted;
  d["triangles_flat"] = a.triangles_flat, d["vertices_lost"] = a.vertices_lost;
  d["edges_not_delaunay"] = a.edges_not_delaunay;
  return d;
}

}  // namespace

void bind_proof(nb::module_& m) {
  nb::class_<GivenMesh>(m, "GivenMesh", "A mesh in host memory.")
      .def(
          "__init__",
          [](GivenMesh* self, Rows<std::uint32_t, 3> triangles, std::optional<Rows<std::int32_t, 3>> neighbours,
             std::optional<Row<std::uint8_t>> constrained, Rows<std::int32_t, 2> added,
             std::optional<Rows<std::uint32_t, 4>> origins) {
            new (self) GivenMesh{std::move(triangles), std::move(neighbours), std::move(constrained), std::move(added),
                                 std::move(origins)};
          },
          nb::arg("triangles"), nb::arg("neighbours").none(), nb::arg("constrained").none(), nb::arg("added"),
          nb::arg("origins").none());
  m.def(
      "choose_grid",
      [](const Pairs& vertices, const CallOptions& options) {
        return grid_dict(choose_grid(points(vertices), options.options.grid));
      },
      nb::arg("vertices"), nb::arg("options"));
  m.def(
      "verify",
      [](const Pairs& vertices, const Rows<std::uint32_t, 2>& constraints, const GivenMesh& mesh,
         const std::optional<Row<std::uint32_t>>& region, const std::optional<Row<std::uint32_t>>& depth,
         const std::optional<Row<std::int32_t>>& winding, const nb::dict& grid, const CallOptions& options) {
        const Points given = points(vertices);
        const Constraints pairs = span(constraints);
        const RegionView regions = {region ? region->data() : nullptr, depth ? depth->data() : nullptr,
                                    winding ? winding->data() : nullptr};
        const Grid on = grid_of(grid);
        Verification found;
        {
          nb::gil_scoped_release release;
          const bool of_domain = options.options.domain != Domain::hull || region;
          if (options.refine)
            found = verify_refined(given, pairs, mesh.view(), on, options.for_proof());
          else
            found = of_domain ? verify_domain(given, pairs, mesh.view(), regions, on, options.options)
                              : verify(given, pairs, mesh.view(), on, options.options.crossing);
        }
        return verdict(found);
      },
      nb::arg("vertices"), nb::arg("constraints"), nb::arg("mesh"), nb::arg("region").none(), nb::arg("depth").none(),
      nb::arg("winding").none(), nb::arg("grid"), nb::arg("options"));
  m.def("assess", &assessed, nb::arg("vertices"), nb::arg("mesh"), nb::arg("grid"));
  m.def(
      "added_values",
      [](const Pairs& vertices, const Rows<std::uint32_t, 2>& constraints, const Rows<double, 2>& added,
         const Rows<std::uint32_t, 2>& crossings, const Rows<std::uint32_t, 4>& origins, const Row<double>& values) {
        return handed_over(added_values(points(vertices), span(constraints), span(added), span(crossings),
                                        span(origins), span(values)));
      },
      nb::arg("vertices"), nb::arg("constraints"), nb::arg("added"), nb::arg("crossings"), nb::arg("origins"),
      nb::arg("values"));
}

}  // namespace gcdt::python
