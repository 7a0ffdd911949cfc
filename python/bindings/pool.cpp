// SPDX-License-Identifier: Apache-2.0
// Pools of devices, batches of problems, and batches of polygons.
#include <algorithm>
#include <memory>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/unique_ptr.h>

#include <gcdt/gcdt_pool.hpp>

#include "options.hpp"

namespace gcdt::python {

namespace {

/// A pool for all threads, one after the other. Batches are in host memory and need no turn.
struct SharedPool {
  explicit SharedPool(Pool given) : pool(std::move(given)) {}
  Pool pool;
  TurnLock turns;
};

/// The right to call a pool, for its lifetime. Made without the interpreter's lock.
class PoolTurn {
 public:
  explicit PoolTurn(SharedPool& shared) : shared_(shared), first_(shared.turns.lock()) {}
  ~PoolTurn() {
    if (first_) shared_.turns.unlock();
  }
  PoolTurn(const PoolTurn&) = delete;
  /// Not from a callback of the pool's own call, where the library refuses a second call by itself.
  bool first() const { return first_; }

 private:
  SharedPool& shared_;
  bool first_;
};

BatchResult triangulate_batch(SharedPool& shared, const BatchView& batch, const Options& options) {
  const PoolTurn turn(shared);
  return shared.pool.triangulate(batch, options);
}

nb::dict batch_statistics_dict(const gcdt_batch_statistics& s) {
  nb::dict d;
  d["problems"] = s.problems, d["failed"] = s.failed;
  d["vertices"] = s.vertices, d["constraints"] = s.constraints, d["triangles"] = s.triangles;
  d["ms_call"] = s.ms_call;
  return d;
}

/// The numbers of the problems with errors, ascending.
std::vector<std::uint64_t> failed_problems(const BatchResult& batch) {
  std::vector<std::uint64_t> failed;
  const gcdt_batch_statistics statistics = batch.statistics();
  for (std::uint64_t p = 0; failed.size() < statistics.failed && p < statistics.problems; ++p)
    if (batch.error(p)) failed.push_back(p);
  return failed;
}

/// An array of all problems, and where each problem's begins.
template <class Element>
std::pair<Array<Element>, Array<std::uint64_t>> all_of(const BatchResult& batch, std::int32_t array) {
  Array<std::uint64_t> offsets(batch.size() + 1);
  detail::check(gcdt_batch_copy(batch.handle(), array, nullptr, 0, offsets.data()));
  Array<Element> all(offsets.back());
  detail::check(gcdt_batch_copy(batch.handle(), array, all.data(), all.size(), nullptr));
  return {std::move(all), std::move(offsets)};
}

/// Polygons as a batch: problem p is polygon p, its vertices and one constraint for each.
struct Polygons {
  std::vector<std::uint64_t> vertex_offsets;
  std::vector<Constraint> constraints;

  /// Directions are found for the nonzero rule alone, by exact areas, which takes as long as the rest.
  Polygons(Points coordinates, Span<std::uint64_t> rings, Span<std::uint64_t> polygons, Domain domain)
      : constraints(
            ring_constraints(coordinates, rings, domain == Domain::nonzero ? polygons : Span<std::uint64_t>())) {
    for (const std::uint64_t ring : polygons) vertex_offsets.push_back(rings[ring]);
    for (std::size_t p = 0; p + 1 < vertex_offsets.size(); ++p)
      for (std::uint64_t v = vertex_offsets[p]; v < vertex_offsets[p + 1]; ++v)
        for (std::uint32_t& end : constraints[v]) end -= static_cast<std::uint32_t>(vertex_offsets[p]);
  }
};

/// Adds to the vertex numbers of each problem's triangles where its vertices begin. Numbers beyond its `input_vertices`
/// are of added vertices, which follow those of the input: all problems' one after the other.
void number_globally(Array<std::array<std::uint32_t, 3>>& triangles, const Array<std::uint64_t>& offsets,
                     const std::vector<std::uint64_t>& first_vertex, const Array<std::uint64_t>& first_added) {
  for (std::size_t p = 0; p + 1 < offsets.size(); ++p) {
    const auto base = static_cast<std::uint32_t>(first_vertex[p]);
    const auto own = static_cast<std::uint32_t>(first_vertex[p + 1] - first_vertex[p]);
    const auto added = static_cast<std::uint32_t>(first_vertex.back() + first_added[p] - own);
    for (std::uint64_t t = offsets[p]; t < offsets[p + 1]; ++t)
      for (std::uint32_t& corner : triangles[t]) corner += corner < own ? base : added;
  }
}

/// The coordinates of all added vertices, each problem's on its own grid.
Array<std::array<double, 2>> added_coordinates(const BatchResult& batch, const Array<std::uint64_t>& first_added) {
  Array<std::array<double, 2>> all(first_added.back());
  for (std::size_t p = 0; p + 1 < first_added.size(); ++p) {
    if (first_added[p] == first_added[p + 1]) continue;
    const auto own = grid_coordinates(batch.grid(p), batch.added_on_grid(p));
    std::copy(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(first_added[p]));
  }
  return all;
}

nb::tuple triangulate_polygons(const std::shared_ptr<SharedPool>& shared, const Pairs& coordinates,
                               const Row<std::uint64_t>& ring_offsets, const Row<std::uint64_t>& polygon_offsets,
                               const CallOptions& options) {
  const Points given = points(coordinates);
  const Span<std::uint64_t> rings = span(ring_offsets), polygons = span(polygon_offsets);
  const Options wanted = options.for_call();
  std::unique_ptr<BatchResult> kept;
  std::pair<Array<std::array<std::uint32_t, 3>>, Array<std::uint64_t>> triangles;
  Array<std::array<double, 2>> added;
  {
    nb::gil_scoped_release release;
    const Polygons batch(given, rings, polygons, wanted.domain);
    if (given.size() > 0xffffffffu) throw Error(Status::too_many_vertices, "there are more coordinates than 2^32");
    kept = std::make_unique<BatchResult>(
        triangulate_batch(*shared, {given, batch.vertex_offsets, batch.constraints, batch.vertex_offsets}, wanted));
    triangles = all_of<std::array<std::uint32_t, 3>>(*kept, GCDT_TRIANGLES);
    const auto on_grid = all_of<std::array<std::int32_t, 2>>(*kept, GCDT_ADDED);
    number_globally(triangles.first, triangles.second, batch.vertex_offsets, on_grid.second);
    added = added_coordinates(*kept, on_grid.second);
  }
  return nb::make_tuple(nb::cast(std::move(kept)), handed_over(std::move(triangles.first)),
                        handed_over(std::move(triangles.second)), handed_over(std::move(added)));
}

void bind_batches(nb::module_& m) {
  nb::class_<BatchResult> batch(m, "BatchResult", "The results of a batch, in host memory.");
  batch.def("__len__", &BatchResult::size)
      .def("statistics", [](const BatchResult& self) { return batch_statistics_dict(self.statistics()); })
      .def("failed", [](const BatchResult& self) { return handed_over(failed_problems(self)); })
      .def(
          "error",
          [](const BatchResult& self, std::size_t problem) -> nb::object {
            const auto error = self.error(problem);
            return error ? error_object(*error) : nb::none();
          },
          nb::arg("problem"))
      .def(
          "problem_statistics",
          [](const BatchResult& self, std::size_t problem) {
            return statistics_dict(detail::statistics(self, problem));
          },
          nb::arg("problem"))
      .def(
          "all_of",
          [](const BatchResult& self, const std::string& name) -> nb::object {
#define GCDT_ARRAY(number, array, type, width, ...)                                      \
  if (name == #array) {                                                                  \
    auto [all, offsets] = all_of<detail::Element<type, width>>(self, number);            \
    return nb::make_tuple(handed_over(std::move(all)), handed_over(std::move(offsets))); \
  }
#include <gcdt/arrays.def>
            throw nb::key_error(name.c_str());
          },
          nb::arg("name"));
#define GCDT_ARRAY(number, name, ...)                                      \
  batch.def(                                                               \
      #name,                                                               \
      [](nb::handle_t<BatchResult> self, std::size_t problem) {            \
        const auto own = nb::cast<const BatchResult&>(self).name(problem); \
        return view(own.data(), own.size(), self);                         \
      },                                                                   \
      nb::arg("problem"));
#include <gcdt/arrays.def>
}

nb::list pool_devices(SharedPool& self) {
  std::vector<PoolDevice> devices;
  {
    nb::gil_scoped_release release;
    const PoolTurn turn(self);
    if (!turn.first()) throw Error(Status::in_use, "the pool is in a call");
    devices = self.pool.devices();
  }
  nb::list all;
  for (const PoolDevice& device : devices) {
    nb::dict d = device_dict(device.info);
    d["lost"] = device.lost ? error_object(*device.lost) : nb::none();
    d["problems"] = device.problems, d["vertices"] = device.vertices, d["runs"] = device.runs;
    d["ms_busy"] = device.ms_busy;
    all.append(d);
  }
  return all;
}

}  // namespace

void bind_pool(nb::module_& m) {
  bind_batches(m);
  nb::class_<SharedPool>(m, "Pool", "Any set of devices.")
      .def_static(
          "create",
          [](const std::string& devices, nb::object log) {
            Log calls = python_log(std::move(log));
            nb::gil_scoped_release release;
            return std::make_shared<SharedPool>(Pool(devices, std::move(calls)));
          },
          nb::arg("devices"), nb::arg("log").none())
      .def("devices", &pool_devices)
      .def(
          "triangulate",
          [](const std::shared_ptr<SharedPool>& self, const Pairs& vertices, const Row<std::uint64_t>& vertex_offsets,
             const Rows<std::uint32_t, 2>& constraints, const Row<std::uint64_t>& constraint_offsets,
             const CallOptions& options) {
            const BatchView batch = {points(vertices), span(vertex_offsets), span(constraints),
                                     span(constraint_offsets)};
            const Options wanted = options.for_call();
            nb::gil_scoped_release release;
            return std::make_unique<BatchResult>(triangulate_batch(*self, batch, wanted));
          },
          nb::arg("vertices"), nb::arg("vertex_offsets"), nb::arg("constraints"), nb::arg("constraint_offsets"),
          nb::arg("options"))
      .def("triangulate_polygons", &triangulate_polygons, nb::arg("coordinates"), nb::arg("ring_offsets"),
           nb::arg("polygon_offsets"), nb::arg("options"));
  m.def(
      "ring_constraints",
      [](const Pairs& coordinates, const Row<std::uint64_t>& ring_offsets, const Row<std::uint64_t>& polygon_offsets) {
        return handed_over(ring_constraints(points(coordinates), span(ring_offsets), span(polygon_offsets)));
      },
      nb::arg("coordinates"), nb::arg("ring_offsets"), nb::arg("polygon_offsets"));
}

}  // namespace gcdt::python
