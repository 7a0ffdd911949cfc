// SPDX-License-Identifier: Apache-2.0
// Between the types of C++ and those of C. Not part of the interface.
#pragma once

#include <exception>
#include <new>

#include <gcdt/types.hpp>

namespace gcdt::detail {

inline Status status_of(std::int32_t code) {
  switch (code) {
    case GCDT_OK: return Status::ok;
    case GCDT_ERROR_COORDINATE_NOT_FINITE: return Status::coordinate_not_finite;
    case GCDT_ERROR_COORDINATE_OUTSIDE_GRID: return Status::coordinate_outside_grid;
    case GCDT_ERROR_INDEX_OUT_OF_RANGE: return Status::index_out_of_range;
    case GCDT_ERROR_TOO_MANY_VERTICES: return Status::too_many_vertices;
    case GCDT_ERROR_CONSTRAINTS_CROSS: return Status::constraints_cross;
    case GCDT_ERROR_NO_DEVICE: return Status::no_device;
    case GCDT_ERROR_ROUND_LIMIT: return Status::round_limit;
    case GCDT_ERROR_CHECK_FAILED: return Status::check_failed;
    case GCDT_ERROR_CANCELLED: return Status::cancelled;
    case GCDT_ERROR_WORKSPACE_TOO_SMALL: return Status::workspace_too_small;
    case GCDT_ERROR_BUFFER_TOO_SMALL: return Status::buffer_too_small;
    case GCDT_ERROR_WRONG_CONTEXT: return Status::wrong_context;
    case GCDT_ERROR_BUFFER_ACCESS: return Status::buffer_access;
    case GCDT_ERROR_BUFFERS_OVERLAP: return Status::buffers_overlap;
    case GCDT_ERROR_IN_USE: return Status::in_use;
    case GCDT_ERROR_VERTICES_COINCIDE: return Status::vertices_coincide;
    case GCDT_ERROR_OUT_OF_MEMORY:
    case -4:   // CL_MEM_OBJECT_ALLOCATION_FAILURE
    case -5:   // CL_OUT_OF_RESOURCES
    case -6:   // CL_OUT_OF_HOST_MEMORY
    case -61:  // CL_INVALID_BUFFER_SIZE
      return Status::out_of_memory;
    case GCDT_ERROR_INVALID_ARGUMENT:
    case GCDT_ERROR_STRUCT_SIZE: return Status::invalid_argument;
    default: return Status::device_failed;
  }
}

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

/// Refers to `options` and `progress`.
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
  return c;
}

/// The handle that call(options as C has them, where to put it) makes. What the progress function throws comes through,
/// and so do errors of the call; `solver`, which may be null, is as for check().
template <class Handle, class Call>
Handle* made(const Options& options, const gcdt_solver* solver, void (*release)(Handle*), Call&& call) {
  ProgressCall progress{&options.progress, nullptr};
  const gcdt_options given = detail::options(options, progress);
  Handle* handle = nullptr;
  const std::int32_t status = call(given, &handle);
  if (progress.thrown) {
    release(handle);
    std::rethrow_exception(progress.thrown);
  }
  check(status, solver);
  return handle;
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
  s.n = c.n, s.m = c.m, s.vertices_merged = c.vertices_merged;
  s.constraints_zero = c.constraints_zero, s.constraints_pieces = c.constraints_pieces;
  s.constraints_overlapping = c.constraints_overlapping;
  s.crossings = c.crossings, s.constraints_dropped = c.constraints_dropped;
  s.vertices_added = c.vertices_added, s.triangles = c.triangles;
  s.constraints_split = c.constraints_split, s.constraint_move = c.constraint_move;
  s.grid = grid(c.grid);
  s.ms.core = c.ms_core, s.ms.full = c.ms_full, s.ms.build = c.ms_build, s.ms.order = c.ms_order;
  s.ms.insert = c.ms_insert, s.ms.constrain = c.ms_constrain, s.ms.flip = c.ms_flip;
  s.ms.check = c.ms_check, s.ms.output = c.ms_output;
  s.rounds.insert = c.rounds_insert, s.rounds.flip = c.rounds_flip;
  s.flips = c.flips, s.history_depth = c.history_depth, s.location_steps = c.location_steps;
  s.launches = c.launches, s.read_backs = c.read_backs, s.crossed_pairs = c.crossed_pairs;
  s.peak_device_bytes = c.peak_device_bytes, s.held_device_bytes = c.held_device_bytes;
  s.device = c.device, s.driver = c.driver, s.platform = c.platform, s.version = c.version;
  s.cases.edge_splits = c.edge_splits, s.cases.constraint_hits = c.constraint_hits;
  s.cases.existing_edges = c.existing_edges, s.cases.pieces_walked = c.pieces_walked;
  s.cases.chain_vertices = c.chain_vertices, s.cases.holes = c.holes;
  s.cases.symbolic_chain_vertices = c.symbolic_chain_vertices;
  s.ms.clean = c.ms_clean, s.ms.domain = c.ms_domain, s.regions = c.regions, s.triangles_removed = c.triangles_removed;
  s.deepest = c.deepest, s.open_parity = c.open_parity, s.open_winding = c.open_winding;
  s.ms.call = c.ms_call, s.ms.walk = c.ms_walk, s.ms.gather = c.ms_gather;
  s.cases.pairs_cut_one_corner = c.pairs_cut_one_corner, s.cases.pairs_from_one_corner = c.pairs_from_one_corner;
  s.cases.pairs_cut_two_corners = c.pairs_cut_two_corners, s.cases.pairs_cut_and_from = c.pairs_cut_and_from;
  s.vertices_rounded_together = c.vertices_rounded_together;
  s.rounded_pair = {c.rounded_pair[0], c.rounded_pair[1]};
  for (std::size_t i = 0; const char* note = gcdt_result_note(result, i); ++i) s.notes.emplace_back(note);
  return s;
}

}  // namespace gcdt::detail
