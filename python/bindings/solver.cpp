// SPDX-License-Identifier: Apache-2.0
// Solvers and their results.
#include <memory>

#include "results.hpp"

namespace gcdt::python {

namespace {

/// The arrays that the mesh has when it is made, by their names in gcdt/arrays.def.
nb::dict arrays_of(Triangulation&& mesh) {
  nb::dict arrays;
#define GCDT_ARRAY(number, name, ...) arrays[#name] = handed_over(std::move(mesh.name));
#include <gcdt/arrays.def>
  arrays["added"] = handed_over(std::move(mesh.added));
  return arrays;
}

nb::tuple both(std::unique_ptr<DeviceResult> result, Triangulation&& mesh) {
  nb::dict statistics = statistics_dict(mesh.statistics);
  return nb::make_tuple(nb::cast(std::move(result)), arrays_of(std::move(mesh)), std::move(statistics));
}

/// A result on the device and its arrays, for which room is made meanwhile (as Solver::triangulate does, which keeps
/// no result).
nb::tuple triangulate(const std::shared_ptr<SharedSolver>& shared, const Pairs& vertices,
                      const Rows<std::uint32_t, 2>& constraints, const CallOptions& options) {
  const Points given = points(vertices);
  const Constraints pairs = span(constraints);
  const Options wanted = options.for_call();
  Triangulation mesh;
  std::unique_ptr<DeviceResult> kept;
  {
    nb::gil_scoped_release release;
    const SharedSolver::Turn turn(*shared);
    const auto start = std::chrono::steady_clock::now();
    const auto room = detail::room(mesh, given.size(), pairs.size(), wanted);
    const double room_ms = detail::milliseconds_since(start);
    const gcdt_input input = detail::input(given, pairs);
    gcdt_solver* solver = turn.solver().handle();
    Result result(detail::made<gcdt_result>(wanted, solver, gcdt_result_release, [&](gcdt_options c, auto** made) {
      c.host_room = room.data(), c.host_room_count = room.size();
      return gcdt_triangulate(solver, &input, &c, made);
    }));
    result.download(mesh);
    mesh.statistics.ms.call += room_ms;
    kept = std::make_unique<DeviceResult>(shared, std::move(result));
  }
  return both(std::move(kept), std::move(mesh));
}

nb::tuple adopt(const std::shared_ptr<SharedSolver>& shared, const Pairs& vertices,
                const Rows<std::uint32_t, 3>& triangles, const Rows<std::uint32_t, 2>& constraints,
                const CallOptions& options) {
  const Points given = points(vertices);
  const auto corners = span(triangles);
  const Constraints pairs = span(constraints);
  const Options wanted = options.for_call();
  Triangulation mesh;
  std::unique_ptr<DeviceResult> kept;
  {
    nb::gil_scoped_release release;
    const SharedSolver::Turn turn(*shared);
    Result result = turn.solver().adopt(given, corners, pairs, wanted);
    result.download(mesh);
    kept = std::make_unique<DeviceResult>(shared, std::move(result));
  }
  return both(std::move(kept), std::move(mesh));
}

nb::tuple refine(DeviceResult& self, const CallOptions& options) {
  Options own = options.for_call();
  const Refinement wanted = own.refine.value();
  own.refine.reset();
  Triangulation mesh;
  Result refined = self.ask([&](const Result& r) {
    Result made = r.refine(wanted, own);
    made.download(mesh);
    return made;
  });
  return both(std::make_unique<DeviceResult>(self.shared_solver(), std::move(refined)), std::move(mesh));
}

nb::dict quality_dict(const Quality& q) {
  nb::dict d;
  d["triangles"] = q.triangles;
  d["least_angle"] = q.least_angle, d["largest_angle"] = q.largest_angle;
  d["least_angle_triangle"] = q.least_angle_triangle, d["largest_angle_triangle"] = q.largest_angle_triangle;
  d["least_area"] = q.least_area, d["largest_area"] = q.largest_area, d["area"] = q.area;
  d["least_doubled"] = q.least_doubled, d["largest_doubled"] = q.largest_doubled, d["doubled"] = q.doubled;
  return d;
}

void bind_results(nb::module_& m) {
  nb::class_<DeviceResult> result(m, "Result", "A mesh in device memory.");
  result.def("release", &DeviceResult::release, "Gives the device memory back to the solver.")
      .def_prop_ro("released", &DeviceResult::released)
      .def("refine", &refine, nb::arg("options"))
      .def(
          "count", [](const DeviceResult& self, int array) { return self.get().count(array); }, nb::arg("array"))
      .def(
          "locate",
          [](DeviceResult& self, const Pairs& xy, bool with_weights) -> nb::object {
            const Points where = points(xy);
            Array<std::array<double, 3>> weights;
            Array<std::int32_t> triangles =
                self.ask([&](const Result& r) { return r.locate(where, with_weights ? &weights : nullptr); });
            if (!with_weights) return handed_over(std::move(triangles));
            return nb::make_tuple(handed_over(std::move(triangles)), handed_over(std::move(weights)));
          },
          nb::arg("points"), nb::arg("weights"))
      .def(
          "interpolate",
          [](DeviceResult& self, const Pairs& xy, const Row<double>& values, double outside) {
            const Points where = points(xy);
            return handed_over(self.ask([&](const Result& r) { return r.interpolate(where, span(values), outside); }));
          },
          nb::arg("points"), nb::arg("values"), nb::arg("outside"))
      .def("quality",
           [](DeviceResult& self) { return quality_dict(self.ask([](const Result& r) { return r.quality(); })); });
#define GCDT_DERIVED_ARRAY(number, name, ...) \
  result.def(#name, [](DeviceResult& self) { return handed_over(self.ask([](const Result& r) { return r.name(); })); });
#include <gcdt/arrays.def>
}

}  // namespace

void bind_solver(nb::module_& m) {
  bind_results(m);
  nb::class_<SharedSolver>(m, "Solver", "A device with its programs and memory.")
      .def_static(
          "create",
          [](const std::string& device, nb::object log) {
            Log calls = python_log(std::move(log));
            nb::gil_scoped_release release;
            return std::make_shared<SharedSolver>(Solver(device, std::move(calls)));
          },
          nb::arg("device"), nb::arg("log").none())
      .def("device",
           [](SharedSolver& self) {
             DeviceInfo info;
             {
               nb::gil_scoped_release release;
               info = SharedSolver::Turn(self).solver().device();
             }
             return device_dict(info);
           })
      .def(
          "trim", [](SharedSolver& self) { SharedSolver::Turn(self).solver().trim(); },
          nb::call_guard<nb::gil_scoped_release>())
      .def("triangulate", &triangulate, nb::arg("vertices"), nb::arg("constraints"), nb::arg("options"))
      .def("adopt", &adopt, nb::arg("vertices"), nb::arg("triangles"), nb::arg("constraints"), nb::arg("options"));
}

}  // namespace gcdt::python
