// SPDX-License-Identifier: Apache-2.0
// The C++17 interface, header-only over gcdt.h: points and constraints in, the exact constrained Delaunay
// triangulation (CDT) out. No OpenCL header is needed. Threads, blocking and memory: as gcdt.h says.
#pragma once

#include <algorithm>
#include <chrono>
#include <exception>

#include <gcdt/detail.hpp>
#include <gcdt/types.hpp>

namespace gcdt {

/// All OpenCL devices of all platforms, in the order that selects them by number; without those that
/// have no compiler or no OpenCL 1.2. Empty if there is none (never an error). Thread-safe.
inline std::vector<DeviceInfo> devices() {
  std::size_t count = 0;
  detail::check(gcdt_device_count(&count));
  std::vector<DeviceInfo> all;
  for (std::size_t i = 0; i < count; ++i)
    all.push_back(detail::device_info([&](gcdt_device_info* info) { return gcdt_device_get(i, info); }));
  return all;
}

/// The device that `spec` selects, by number. `auto` (a GPU if there is one, else a CPU), `cpu`,
/// `gpu`, a number, or a part of a name (letter case aside); empty: the variable GCDT_DEVICE, else `auto`.
/// If several names match, the first is taken and `ambiguous` (may be null) is set.
/// Throws no_device, with what to install, if none fits.
inline std::size_t select_device(const std::string& spec, bool* ambiguous = nullptr) {
  std::size_t number = 0;
  std::int32_t several = 0;
  detail::check(gcdt_device_select(spec.c_str(), &number, &several));
  if (ambiguous) *ambiguous = several != 0;
  return number;
}

/// Says what the solver does: programs built, memory taken. `level`: GCDT_LOG_WARNING or GCDT_LOG_INFORMATION.
using Log = std::function<void(int level, const char* message)>;

/// The doubles nearest to the coordinates of grid points; see gcdt_grid_coordinates.
inline Array<std::array<double, 2>> grid_coordinates(const Grid& grid, Span<std::array<std::int32_t, 2>> points) {
  const gcdt_grid at = detail::grid(grid);
  Array<std::array<double, 2>> coordinates(points.size());
  detail::check(gcdt_grid_coordinates(&at, reinterpret_cast<const std::int32_t*>(points.data()), points.size(),
                                      reinterpret_cast<double*>(coordinates.data())));
  return coordinates;
}

/// Values for vertices that Crossing::split has added, from those of the input; see gcdt_added_values. Throws
/// invalid_argument if there is not one value for each vertex, or not one pair for each added one.
inline std::vector<double> added_values(Points vertices, Constraints constraints, Span<std::array<double, 2>> added,
                                        Span<Constraint> crossings, Span<double> vertex_values) {
  if (vertex_values.size() != vertices.size() || crossings.size() != added.size())
    throw Error(Status::invalid_argument, "there is not one value for each vertex, or not one pair for each added one");
  const gcdt_input input = detail::input(vertices, constraints);
  std::vector<double> values(added.size());
  detail::check(gcdt_added_values(&input, reinterpret_cast<const double*>(added.data()),
                                  reinterpret_cast<const std::uint32_t*>(crossings.data()), added.size(),
                                  vertex_values.data(), values.data()));
  return values;
}

/// The same with vertices that Options::refine has added; see gcdt_refined_values. `origins`: empty, or one for each.
inline std::vector<double> added_values(Points vertices, Constraints constraints, Span<std::array<double, 2>> added,
                                        Span<Constraint> crossings, Span<std::array<std::uint32_t, 4>> origins,
                                        Span<double> vertex_values) {
  if (origins.empty()) return added_values(vertices, constraints, added, crossings, vertex_values);
  if (vertex_values.size() != vertices.size() || crossings.size() != added.size() || origins.size() != added.size())
    throw Error(Status::invalid_argument,
                "there is not one value for each vertex, or not one origin for each added one");
  const gcdt_input input = detail::input(vertices, constraints);
  std::vector<double> values(added.size());
  detail::check(gcdt_refined_values(
      &input, reinterpret_cast<const double*>(added.data()), reinterpret_cast<const std::uint32_t*>(crossings.data()),
      reinterpret_cast<const std::uint32_t*>(origins.data()), added.size(), vertex_values.data(), values.data()));
  return values;
}

/// The grid points to which coordinates are rounded; see gcdt_grid_points.
inline std::vector<std::array<std::int32_t, 2>> grid_points(const Grid& grid, Span<std::array<double, 2>> coordinates) {
  const gcdt_grid at = detail::grid(grid);
  std::vector<std::array<std::int32_t, 2>> points(coordinates.size());
  detail::check(gcdt_grid_points(&at, reinterpret_cast<const double*>(coordinates.data()), coordinates.size(),
                                 reinterpret_cast<std::int32_t*>(points.data())));
  return points;
}

/// The constraints of rings, one for each of `points`; see gcdt_ring_constraints. `ring_offsets`: the first vertex of
/// each ring, and the vertex count. `polygon_offsets`: the same for the rings of polygons; empty: no polygons.
inline std::vector<Constraint> ring_constraints(Points points, Span<std::uint64_t> ring_offsets,
                                                Span<std::uint64_t> polygon_offsets = {}) {
  const gcdt_input input = detail::input(points, {});
  gcdt_rings rings = GCDT_RINGS_INIT;
  rings.ring_offsets = ring_offsets.data(), rings.ring_count = ring_offsets.size() - !ring_offsets.empty();
  rings.polygon_offsets = polygon_offsets.data(),
  rings.polygon_count = polygon_offsets.size() - !polygon_offsets.empty();
  std::vector<Constraint> constraints(points.size());
  detail::check(
      gcdt_ring_constraints(&input, &rings, reinterpret_cast<std::uint32_t*>(constraints.data()), constraints.size()));
  return constraints;
}

/// A triangulation in device memory, until it is asked for or the object is gone. Move-only.
class Result {
 public:
  explicit Result(gcdt_result* handle) : handle_(handle) {}
  /// The C handle, which the object keeps.
  gcdt_result* handle() const { return handle_.get(); }

  std::size_t triangle_count() const { return count(GCDT_TRIANGLES); }
  /// Elements of an array (GCDT_TRIANGLES ...).
  std::size_t count(std::int32_t array) const {
    return static_cast<std::size_t>(gcdt_result_count(handle_.get(), array));
  }

  /// Copies to host memory, by the names of the arrays in gcdt/arrays.def: triangles(), neighbours() and so on, and
  /// those made on demand: vertex_triangles(), hull() and edge_pieces(). Each blocks.
#define GCDT_ARRAY(number, name, type, width, ...) \
  Array<detail::Element<type, width>> name() const { return copy<detail::Element<type, width>>(number); }
#define GCDT_DERIVED_ARRAY GCDT_ARRAY
#include <gcdt/arrays.def>
  Statistics statistics() const { return detail::statistics(handle_.get()); }

  /// Areas and angles, measured on the device. Blocks.
  Quality quality() const {
    gcdt_quality c = {};
    c.struct_size = sizeof c;
    detail::check(gcdt_result_quality(handle_.get(), &c));
    return {c.triangles,  c.least_angle,  c.largest_angle, c.least_angle_triangle, c.largest_angle_triangle,
            c.least_area, c.largest_area, c.area,          c.least_doubled,        c.largest_doubled,
            c.doubled};
  }
  /// What the call that made this would have made with `wanted` as Options::refine; refined further, if it was refined;
  /// what was adopted, too. This stays as it is. Of `options` check, canonical and progress are read, the rest must be
  /// as it is at first. See gcdt_result_refine. Blocks.
  Result refine(const Refinement& wanted, const Options& options = {}) const {
    const gcdt_refinement c = detail::refinement(wanted);
    return Result(detail::made<gcdt_result>(
        options, nullptr, gcdt_result_release,
        [&](const gcdt_options& given, auto** made) { return gcdt_result_refine(handle(), &c, &given, made); }));
  }
  /// Where points are: the least triangle that holds each, border included, or -1. See gcdt_locate. Blocks.
  Array<std::int32_t> locate(Points points) const { return locate(points, static_cast<double*>(nullptr)); }
  /// The same with the points' weights in their triangles, in any vector.
  template <class Allocator>
  Array<std::int32_t> locate(Points points, std::vector<std::array<double, 3>, Allocator>* weights) const {
    if (!weights) return locate(points);
    const std::size_t before = weights->size();
    if (before < points.size()) weights->resize(points.size());
    try {
      Array<std::int32_t> triangles = locate(points, weights->empty() ? nullptr : weights->data()->data());
      weights->resize(points.size());
      return triangles;
    } catch (...) {
      weights->resize(before);  // as it was: an error writes nothing
      throw;
    }
  }
  /// The values at points, linear in each triangle; `vertex_values`: one a vertex, added ones last. See
  /// gcdt_interpolate. Throws invalid_argument if they are not as many. Blocks.
  Array<double> interpolate(Points points, Span<double> vertex_values, double outside) const {
    if (vertex_values.size() != count(GCDT_REPRESENTATIVES))
      throw Error(Status::invalid_argument, "there is not one value for each vertex");
    Array<double> values(points.size());
    detail::check(gcdt_interpolate(handle_.get(), detail::coordinate_type(points.type()), points.data(), points.size(),
                                   vertex_values.data(), outside, values.data()));
    return values;
  }

  /// All of it. Blocks. What that takes, room for the arrays included, is in statistics.ms.call.
  Triangulation download() const {
    Triangulation all;
    download(all);
    return all;
  }
  /// The same to arrays that are there: room is used again where it is enough, and not more than four times that.
  void download(Triangulation& all) const {
    const auto start = std::chrono::steady_clock::now();
    const double before = statistics().ms.call;
    Copies copies(*this);
#define GCDT_ARRAY(number, name, ...) copies.add(number, all.name);
#include <gcdt/arrays.def>
    copies.run();
    all.statistics = statistics();
    all.added = grid_coordinates(all.statistics.grid, all.added_on_grid);
    all.statistics.ms.call = before + detail::milliseconds_since(start);
  }

 private:
  /// Copies to be made together.
  class Copies {
   public:
    explicit Copies(const Result& from) : from_(from) {}
    template <class T>
    void add(std::int32_t array, Array<T>& to) {
      const std::size_t count = from_.count(array);
      if (to.capacity() / 4 > count) Array<T>().swap(to);
      to.clear();  // so that nothing is moved
      to.resize(count);
      arrays_.push_back(array);
      destinations_.push_back(to.data());
      capacities_.push_back(to.size());
    }
    void run() const {
      detail::check(gcdt_result_copy_arrays(from_.handle(), arrays_.data(), destinations_.data(), capacities_.data(),
                                            arrays_.size()));
    }

   private:
    const Result& from_;
    std::vector<std::int32_t> arrays_;
    std::vector<void*> destinations_;
    std::vector<std::uint64_t> capacities_;
  };
  template <class T>
  Array<T> copy(std::int32_t array) const {
    Array<T> values;
    Copies copies(*this);
    copies.add(array, values);
    copies.run();
    return values;
  }
  Array<std::int32_t> locate(Points points, double* weights) const {
    Array<std::int32_t> triangles(points.size());
    detail::check(gcdt_locate(handle_.get(), detail::coordinate_type(points.type()), points.data(), points.size(),
                              triangles.data(), weights));
    return triangles;
  }
  struct Release {
    void operator()(gcdt_result* result) const { gcdt_result_release(result); }
  };
  std::unique_ptr<gcdt_result, Release> handle_;
};

/// Triangulates on one device and keeps its programs and memory between calls.
/// Distinct objects may be used from distinct threads; one object by one thread at a time. Move-only.
class Solver {
 public:
  /// `device`: as for select_device. Throws no_device or device_failed.
  /// `trace`: called for everything that takes time, by the thread that is in a call.
  explicit Solver(const std::string& device = {}, Log log = {}, Trace trace = {})
      : log_(detail::boxed(std::move(log))), trace_(detail::boxed(std::move(trace))) {
    gcdt_solver_options options = detail::solver_options(log_.get(), trace_.get());
    options.device = device.c_str();
    gcdt_solver* solver = nullptr;
    detail::check(gcdt_solver_create(&options, &solver));
    handle_.reset(solver);
    device_ = detail::device_info([&](gcdt_device_info* info) { return gcdt_solver_device(solver, info); });
  }
  /// Takes over a handle; `log`, if any, is what it was created with.
  explicit Solver(gcdt_solver* handle, std::unique_ptr<Log> log = {}) : log_(std::move(log)), handle_(handle) {
    device_ = detail::device_info([&](gcdt_device_info* info) { return gcdt_solver_device(handle, info); });
  }

  /// The C handle, which the object keeps.
  gcdt_solver* handle() const { return handle_.get(); }
  const DeviceInfo& device() const { return device_; }

  /// The CDT of `points` under `constraints` (paper: Fan et al., gCDT, 2026, sections 4 to 8), in device memory.
  ///
  /// `points`: 0 to max_vertices vertices; `constraints`: 0 to 2^31 - 1 pairs of vertex numbers.
  /// Fewer than three distinct vertices, or all on one line: no triangles and a note, no error.
  /// On error nothing is returned and the object can be used again. Throws Error (see Status), and what the
  /// progress function throws. Blocks until the mesh is complete.
  Result solve(Points points, Constraints constraints = {}, const Options& options = {}) {
    return solve(points, constraints, options, {});
  }
  /// The same, copied to host memory, in which room is made while the device works (gcdt_options.host_room).
  Triangulation triangulate(Points points, Constraints constraints = {}, const Options& options = {}) {
    const auto start = std::chrono::steady_clock::now();
    Triangulation all;
    const std::vector<gcdt_host_memory> room = detail::room(all, points.size(), constraints.size(), options);
    const double room_ms = detail::milliseconds_since(start);
    solve(points, constraints, options, room).download(all);
    all.statistics.ms.call += room_ms;
    return all;
  }

  /// A result of a mesh that is there already, with the numbers and first corners of its triangles; `constraints` run
  /// along its edges and are flagged. See gcdt_adopt: any mesh without overlaps, Delaunay or not, convex or not. Throws
  /// check_failed for others. Of `options` grid, progress and check are read.
  Result adopt(Points points, Span<std::array<std::uint32_t, 3>> triangles, Constraints constraints = {},
               const Options& options = {}) {
    const gcdt_input input = detail::input(points, constraints);
    MeshView view;
    view.triangles = triangles;
    const gcdt_mesh mesh = detail::mesh(view);
    return Result(detail::made<gcdt_result>(
        options, handle(), gcdt_result_release,
        [&](const gcdt_options& given, auto** result) { return gcdt_adopt(handle(), &input, &mesh, &given, result); }));
  }

  /// Gives the device memory back that is kept and that no result holds, and the host memory kept for transfers,
  /// whose threads it ends.
  void trim() { detail::check(gcdt_solver_trim(handle_.get())); }

 private:
  Result solve(Points points, Constraints constraints, const Options& options,
               const std::vector<gcdt_host_memory>& room) {
    const gcdt_input input = detail::input(points, constraints);
    return Result(
        detail::made<gcdt_result>(options, handle(), gcdt_result_release, [&](gcdt_options given, auto** result) {
          given.host_room = room.data(), given.host_room_count = room.size();
          return gcdt_triangulate(handle(), &input, &given, result);
        }));
  }
  struct Release {
    void operator()(gcdt_solver* solver) const { gcdt_solver_release(solver); }
  };
  std::unique_ptr<Log> log_;      // the handle has its address
  std::unique_ptr<Trace> trace_;  // so it does of this
  std::unique_ptr<gcdt_solver, Release> handle_;
  DeviceInfo device_;
};

/// One call: makes a Solver on `device`, triangulates, and drops it. See Solver::solve.
inline Triangulation triangulate(Points points, Constraints constraints = {}, const Options& options = {},
                                 const std::string& device = {}) {
  return Solver(device).triangulate(points, constraints, options);
}

/// See gcdt_required_bytes. Bytes of device memory; the default for `crossed` is the worst case.
inline std::uint64_t required_bytes(std::uint64_t n, std::uint64_t m, std::uint64_t crossed = ~std::uint64_t(0)) {
  return gcdt_required_bytes(n, m, crossed);
}

/// See gcdt_required_bytes_refined. `added`: Refinement::most_added.
inline std::uint64_t required_bytes_refined(std::uint64_t n, std::uint64_t m, std::uint64_t added,
                                            std::uint64_t crossed = ~std::uint64_t(0)) {
  return gcdt_required_bytes_refined(n, m, crossed, added);
}

/// "major.minor.patch" of the library.
inline const char* version() { return gcdt_version(); }

}  // namespace gcdt
