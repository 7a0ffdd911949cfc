// SPDX-License-Identifier: Apache-2.0
// Between the types of C++ and those of C. Not part of the interface.
#pragma once

#include <chrono>
#include <exception>
#include <new>

#include <gcdt/statuses.hpp>
#include <gcdt/types.hpp>

namespace gcdt::detail {

/// Throws what the last failed call of this thread said, unless `code` is GCDT_OK. Pairs that cross are taken from
/// `solver`, which has all of them.
inline void check(std::int32_t code, const gcdt_solver* solver = nullptr) {
  if (code == GCDT_OK) return;
  if (code == GCDT_ERROR_HOST_MEMORY) throw std::bad_alloc();
  gcdt_error error = GCDT_ERROR_INIT;
  gcdt_last_error(code == GCDT_ERROR_CONSTRAINTS_CROSS ? solver : nullptr, &error);
  throw Error(status_of(code), error.message, {error.indices, error.indices + error.index_count}, error.pair_count,
              code > -20000 ? code : 0);
}

template <class Ask>
DeviceInfo device_info(Ask&& ask) {
  gcdt_device_info c = {};
  c.struct_size = sizeof c;
  check(ask(&c));
  DeviceInfo info;
  info.name = c.name, info.vendor = c.vendor, info.platform = c.platform;
  info.driver = c.driver, info.version = c.version;
  info.is_gpu = c.is_gpu != 0, info.is_cpu = c.is_cpu != 0;
  info.atomics64 = c.atomics64 != 0, info.fp64 = c.fp64 != 0, info.subgroups = c.subgroups != 0;
  info.compute_units = c.compute_units, info.largest_work_group = c.largest_work_group;
  info.memory_bytes = c.memory_bytes, info.largest_buffer_bytes = c.largest_buffer_bytes;
  info.local_bytes = c.local_bytes;
  return info;
}

inline Grid grid(const gcdt_grid& c) {
  Grid grid;
  grid.kind = static_cast<Grid::Kind>(c.kind);
  grid.origin = {c.origin[0], c.origin[1]};
  grid.cell_units = c.cell_units, grid.cell_decimals = c.cell_decimals, grid.cell_exponent = c.cell_exponent;
  grid.largest_move = c.largest_move;
  return grid;
}

inline gcdt_grid grid(const Grid& grid) {
  gcdt_grid c = {};
  c.struct_size = sizeof c;
  c.kind = static_cast<std::int32_t>(grid.kind);
  c.origin[0] = grid.origin[0], c.origin[1] = grid.origin[1];
  c.cell_units = grid.cell_units, c.cell_decimals = grid.cell_decimals, c.cell_exponent = grid.cell_exponent;
  c.largest_move = grid.largest_move;
  return c;
}

inline std::int32_t coordinate_type(Points::Type type) {
  switch (type) {
    case Points::Type::float32: return GCDT_FLOAT32;
    case Points::Type::int32: return GCDT_INT32;
    case Points::Type::int64: return GCDT_INT64;
    default: return GCDT_FLOAT64;
  }
}

inline gcdt_input input(Points points, Constraints constraints) {
  static_assert(sizeof(Constraint) == 2 * sizeof(std::uint32_t), "arrays of arrays are packed");
  gcdt_input c = GCDT_INPUT_INIT;
  c.coordinate_type = coordinate_type(points.type());
  c.vertices = points.data(), c.vertex_count = points.size();
  c.constraints = reinterpret_cast<const std::uint32_t*>(constraints.data()), c.constraint_count = constraints.size();
  return c;
}

inline gcdt_mesh mesh(const MeshView& mesh) {
  gcdt_mesh view = GCDT_MESH_INIT;
  view.triangles = reinterpret_cast<const std::uint32_t*>(mesh.triangles.data());
  view.triangle_count = mesh.triangles.size();
  view.neighbours = reinterpret_cast<const std::int32_t*>(mesh.neighbours);
  view.constrained = mesh.constrained;
  view.added = reinterpret_cast<const std::int32_t*>(mesh.added.data()), view.added_count = mesh.added.size();
  if (mesh.added_origin.size() == mesh.added.size())
    view.added_origins = reinterpret_cast<const std::uint32_t*>(mesh.added_origin.data());
  return view;
}

inline Verification verification(std::int32_t status) {
  if (status != GCDT_ERROR_NOT_VALID) {
    detail::check(status);
    return {true, {}};
  }
  gcdt_error error = GCDT_ERROR_INIT;
  gcdt_last_error(nullptr, &error);
  return {false, error.message};
}

/// A progress function on its way through C, and what it threw.
struct ProgressCall {
  const Progress* function = nullptr;
  std::exception_ptr thrown;

  static std::int32_t call(void* user, const char* phase, double done) {
    auto* self = static_cast<ProgressCall*>(user);
    try {
      return (*self->function)(phase, done);
    } catch (...) {
      self->thrown = std::current_exception();
      return 0;
    }
  }
};

inline const double* seeds(const std::vector<std::array<double, 2>>& points) {
  return points.empty() ? nullptr : points.data()->data();
}

inline std::int32_t crossing(Crossing crossing) {
  return crossing == Crossing::split  ? GCDT_CROSSING_SPLIT
         : crossing == Crossing::drop ? GCDT_CROSSING_DROP
                                      : GCDT_CROSSING_REJECT;
}

/// Refers to what `refine` refers to.
inline gcdt_refinement refinement(const Refinement& refine) {
  gcdt_refinement c = GCDT_REFINEMENT_INIT;
  c.least_angle = refine.least_angle, c.most_area = refine.most_area, c.least_length = refine.least_length;
  c.most_added = refine.most_added;
  static_assert(static_cast<int>(Splits::none) == GCDT_SPLITS_NONE, "splits are numbered alike");
  c.splits = static_cast<std::int32_t>(refine.splits), c.conforming = refine.conforming;
  c.sizes = refine.sizes.data(), c.size_count = refine.sizes.size();
  c.region_areas = refine.region_areas.data(), c.region_area_count = refine.region_areas.size();
  return c;
}

/// Refers to `options` and `progress`; without Options::refine.
inline gcdt_options options(const Options& options, ProgressCall& progress) {
  gcdt_options c = GCDT_OPTIONS_INIT;
  c.crossing = crossing(options.crossing);
  c.check = options.check, c.canonical = options.canonical;
  if (options.grid) {
    c.fixed_grid = 1;
    c.grid_x = options.grid->x, c.grid_y = options.grid->y, c.grid_cell = options.grid->cell.c_str();
  }
  if (options.progress) c.progress = ProgressCall::call, c.progress_user = &progress;
  static_assert(static_cast<int>(Domain::outer_holes) == GCDT_DOMAIN_OUTER_HOLES, "domains are numbered alike");
  c.domain = static_cast<std::int32_t>(options.domain), c.regions = options.regions;
  c.hole_seeds = seeds(options.hole_seeds), c.hole_seed_count = options.hole_seeds.size();
  c.region_seeds = seeds(options.region_seeds), c.region_seed_count = options.region_seeds.size();
  c.distinct = options.distinct;
  c.tiles = options.tiles;
  c.pinned = options.pinned;
  return c;
}

/// Options as C has them, together with what they refer to.
struct GivenOptions {
  GivenOptions(const Options& options, ProgressCall& progress) : c(detail::options(options, progress)) {
    if (!options.refine) return;
    refine_ = refinement(*options.refine);
    c.refine = &refine_;
  }
  GivenOptions(const GivenOptions&) = delete;
  GivenOptions& operator=(const GivenOptions&) = delete;

  gcdt_options c;

 private:
  gcdt_refinement refine_ = {};
};

/// The handle that call(options as C has them, where to put it) makes. What the progress function throws comes through,
/// and so do errors of the call; `solver`, which may be null, is as for check().
template <class Handle, class Call>
Handle* made(const Options& options, const gcdt_solver* solver, void (*release)(Handle*), Call&& call) {
  ProgressCall progress{&options.progress, nullptr};
  const GivenOptions given(options, progress);
  Handle* handle = nullptr;
  const std::int32_t status = call(given.c, &handle);
  if (progress.thrown) {
    release(handle);
    std::rethrow_exception(progress.thrown);
  }
  check(status, solver);
  return handle;
}

inline double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Gives the arrays of `to` as many elements as the result will have at most, or nearly always, and returns what of
/// that it will use, as far as is known; the rest, of which no page is touched, is only addresses. Nothing for few
/// vertices, or if there is no memory for it: then room is made when the size is known; and nothing for too many, which
/// the call refuses.
inline std::vector<gcdt_host_memory> room(Triangulation& to, std::size_t n, std::size_t m, const Options& options) {
  constexpr std::size_t least = std::size_t{1} << 15;  // vertices that are worth it
  if (n < least || n > max_vertices) return {};
  // By what arrays have one element for, and which results have them (gcdt/arrays.def).
  struct Elements {
    std::size_t triangle, vertex, piece, piece_bound, source, dropped, added;
  };
  const Elements most = {2 * n, n, m, m + 1, m, 0, 0};
  Elements likely = most;
  if (options.domain != Domain::hull) likely.triangle /= 2;  // nobody knows what is outside
  const struct {
    bool always, with_added, with_origins, with_regions;
  } wanted = {true, false, false, options.regions || options.domain != Domain::hull};
  std::vector<gcdt_host_memory> used;
  const auto add = [&](auto& array, std::size_t elements, std::size_t elements_used) {
    array.resize(elements);
    used.push_back({array.data(), elements_used * sizeof array[0]});
  };
  try {
#define GCDT_ARRAY(number, name, type, width, per, there, ...) \
  if (wanted.there && most.per > 0) add(to.name, most.per, likely.per);
#include <gcdt/arrays.def>
  } catch (const std::exception&) {
    return {};
  }
  return used;
}

using LogFunction = std::function<void(int level, const char* message)>;

inline std::unique_ptr<LogFunction> boxed(LogFunction log) {
  return log ? std::make_unique<LogFunction>(std::move(log)) : nullptr;
}

inline std::unique_ptr<Trace> boxed(Trace trace) { return trace ? std::make_unique<Trace>(std::move(trace)) : nullptr; }

/// For a log function behind `user`. What it throws is dropped.
inline void call_log(void* user, std::int32_t level, const char* message) {
  try {
    (*static_cast<LogFunction*>(user))(level, message);
  } catch (...) {
  }
}

/// For a trace behind `user`. What it throws is dropped.
inline void call_trace(void* user, const gcdt_trace_span* c) {
  try {
    TraceSpan span;
    span.device = c->device, span.device_number = c->device_number;
    span.phase = c->phase, span.name = c->name, span.on_device = c->on_device != 0;
    span.begin_ns = c->begin_ns, span.end_ns = c->end_ns;
    (*static_cast<Trace*>(user))(span);
  } catch (...) {
  }
}

/// `log` and `trace` may be null.
inline gcdt_solver_options solver_options(LogFunction* log, Trace* trace = nullptr) {
  gcdt_solver_options c = GCDT_SOLVER_OPTIONS_INIT;
  if (log) c.log = call_log, c.log_user = log;
  if (trace) c.trace = call_trace, c.trace_user = trace;
  return c;
}

inline Statistics statistics(const gcdt_result* result) {
  gcdt_statistics c = {};
  c.struct_size = sizeof c;
  check(gcdt_result_statistics(result, &c));
  Statistics s;
#define GCDT_STATISTIC(member, name) s.name = c.member;
#define GCDT_STATISTIC_HIDDEN GCDT_STATISTIC
#define GCDT_STATISTIC_TEXT GCDT_STATISTIC
#include <gcdt/statistics.def>
  s.grid = grid(c.grid);
  s.rounded_pair = {c.rounded_pair[0], c.rounded_pair[1]};
  for (std::size_t i = 0; const char* note = gcdt_result_note(result, i); ++i) s.notes.emplace_back(note);
  return s;
}

}  // namespace gcdt::detail
