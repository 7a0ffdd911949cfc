// SPDX-License-Identifier: Apache-2.0
// The C interface: statuses, devices, solvers, triangulation of host arrays.
#include "api/state.hpp"

#include <gcdt/statuses.hpp>
#include <string_view>

#include "device/host_room.hpp"
#include "device/transfer_chunks.hpp"
#include "phases/order.hpp"
#include "phases/pinned_input.hpp"
#include "solve/refine_result.hpp"

using namespace gcdt;

namespace gcdt::api {

namespace {

// Without a destructor, so that the library can be unloaded while threads live.
struct ThreadDetail {
  std::int32_t status;
  char message[4001];
  std::uint64_t indices[20];
  std::size_t index_count;
  std::uint64_t pair_count;
};
thread_local ThreadDetail thread_detail;

template <std::size_t N>
void cut(char (&to)[N], std::string_view from) {
  to[from.copy(to, N - 1)] = '\0';
}

}  // namespace

std::int32_t code_of(const Error& error) {
  if (error.opencl_code() != 0) return error.opencl_code();
  const detail::StatusRow* row = detail::row_of(error.status());
  return row ? row->code : GCDT_ERROR_INTERNAL;
}

std::int32_t failed(State* state, std::int32_t status, const char* message, const std::vector<std::uint64_t>& indices,
                    std::uint64_t pair_count) noexcept {
  ThreadDetail& detail = thread_detail;
  detail.status = status;
  cut(detail.message, message);
  detail.index_count = std::min(indices.size(), std::size(detail.indices));
  std::copy_n(indices.begin(), detail.index_count, detail.indices);
  detail.pair_count = pair_count;
  if (!state) return status;
  try {
    state->detail = {status, message, indices, pair_count};
    state->runtime.log(GCDT_LOG_WARNING, message);
  } catch (...) {  // out of memory: the number says enough
    state->detail.status = status;
  }
  return status;
}

Error too_small(std::uint64_t elements, std::uint64_t capacity, const char* name) {
  return Error(
      Status::buffer_too_small,
      std::to_string(elements) + " " + name + " do not fit where there is room for " + std::to_string(capacity),
      {elements, capacity});
}

namespace {

std::vector<std::array<double, 2>> read_seeds(const char* name, const double* xy, std::uint64_t count) {
  require(xy || count == 0, (std::string(name) + " is null").c_str());
  require(count <= max_vertices, (std::string(name) + " are too many").c_str());
  std::vector<std::array<double, 2>> seeds(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    seeds[i] = {xy[2 * i], xy[2 * i + 1]};
    for (std::uint64_t axis = 0; axis < 2; ++axis)
      if (!(seeds[i][axis] - seeds[i][axis] == 0))
        throw Error(Status::coordinate_not_finite, std::string(name) + ": seed " + std::to_string(i) + " is not finite",
                    {i, axis});
  }
  return seeds;
}

}  // namespace

Crossing read_crossing(std::int32_t crossing, const char* name) {
  switch (crossing) {
    case GCDT_CROSSING_REJECT: return Crossing::reject;
    case GCDT_CROSSING_DROP: return Crossing::drop;
    case GCDT_CROSSING_SPLIT: return Crossing::split;
  }
  throw Error(Status::invalid_argument, std::string(name) + " is none of GCDT_CROSSING_...");
}

namespace {

constexpr std::size_t least_options = offsetof(gcdt_options, domain);  // of the first version

}  // namespace

Refinement read_refinement(const gcdt_refinement* given) {
  const gcdt_refinement c = read_struct(given, "gcdt_refinement");
  Refinement refine;
  refine.least_angle = c.least_angle, refine.most_area = c.most_area, refine.least_length = c.least_length;
  refine.most_added = c.most_added;
  require(c.splits >= GCDT_SPLITS_ALL && c.splits <= GCDT_SPLITS_NONE,
          "gcdt_refinement.splits is none of GCDT_SPLITS_...");
  refine.splits = static_cast<Splits>(c.splits);
  refine.conforming = c.conforming != 0;
  require(c.sizes || c.size_count == 0, "gcdt_refinement.sizes is null");
  require(c.region_areas || c.region_area_count == 0, "gcdt_refinement.region_areas is null");
  refine.sizes = {c.sizes, static_cast<std::size_t>(c.size_count)};
  refine.region_areas = {c.region_areas, static_cast<std::size_t>(c.region_area_count)};
  return refine;
}

Options read_options(const gcdt_options* given, std::uint32_t most_tiles) {
  Options options;
  if (!given) return options;
  const gcdt_options c = read_struct(given, "gcdt_options", least_options);
  options.crossing = read_crossing(c.crossing, "gcdt_options.crossing");
  options.check = c.check != 0;
  options.canonical = c.canonical != 0;
  if (c.fixed_grid) options.grid = FixedGrid{c.grid_x, c.grid_y, c.grid_cell ? c.grid_cell : "1"};
  require(c.domain >= GCDT_DOMAIN_HULL && c.domain <= GCDT_DOMAIN_OUTER_HOLES,
          "gcdt_options.domain is none of GCDT_DOMAIN_...");
  options.domain = static_cast<Domain>(c.domain);
  options.regions = c.regions != 0;
  options.distinct = c.distinct != 0;
  if (c.tiles > most_tiles)
    throw Error(Status::invalid_argument, most_tiles == 1 ? "gcdt_options.tiles: only a pool cuts a problem into tiles"
                                                          : "gcdt_options.tiles is more than GCDT_MAX_TILES");
  options.tiles = c.tiles;
  options.pinned = c.pinned != 0;
  options.hole_seeds = read_seeds("gcdt_options.hole_seeds", c.hole_seeds, c.hole_seed_count);
  options.region_seeds = read_seeds("gcdt_options.region_seeds", c.region_seeds, c.region_seed_count);
  if (c.refine) options.refine = read_refinement(c.refine);
  if (c.progress)
    options.progress = [call = c.progress, user = c.progress_user](const char* phase, double done) {
      return call(user, phase, done) != 0;
    };
  return options;
}

namespace {

/// Threads that make the caller's room ready, as long as the object lives.
runtime::HostRoom make_room(const runtime::Runtime& runtime, const gcdt_options* options, std::uint64_t vertices) {
  if (!options) return {};
  const gcdt_options given = read_struct(options, "gcdt_options", least_options);
  require(given.host_room || given.host_room_count == 0, "gcdt_options.host_room is null");
  std::vector<runtime::HostRoom::Range> ranges;
  for (std::uint64_t i = 0; i < given.host_room_count; ++i) {
    const auto [memory, bytes] = given.host_room[i];
    require(memory || bytes == 0, "gcdt_options.host_room has a range that is null");
    ranges.push_back({static_cast<unsigned char*>(memory), static_cast<std::size_t>(bytes)});
  }
  if (!runtime::prepares_host_memory(runtime) || vertices < Tuning::least_prepared_vertices) return {};
  return {ranges, runtime.tuning().room_threads};
}

}  // namespace

Points::Type read_type(std::int32_t coordinate_type) {
  switch (coordinate_type) {
    case GCDT_FLOAT64: return Points::Type::float64;
    case GCDT_FLOAT32: return Points::Type::float32;
    case GCDT_INT32: return Points::Type::int32;
    case GCDT_INT64: return Points::Type::int64;
  }
  throw Error(Status::invalid_argument,
              "coordinate_type is none of GCDT_FLOAT64, GCDT_FLOAT32, GCDT_INT32, GCDT_INT64");
}

Points read_points(const gcdt_input& input) {
  require(input.vertices || input.vertex_count == 0, "gcdt_input.vertices is null");
  check_vertex_count(input.vertex_count);
  return part_of(read_type(input.coordinate_type), input.vertices, 0, static_cast<std::size_t>(input.vertex_count));
}

Constraints read_constraints(const gcdt_input& input) {
  require(input.constraints || input.constraint_count == 0, "gcdt_input.constraints is null");
  check_constraint_count(input.constraint_count);
  return {reinterpret_cast<const Constraint*>(input.constraints), static_cast<std::size_t>(input.constraint_count)};
}

gcdt_device_info device_info(const DeviceInfo& info) {
  gcdt_device_info c = {};
  cut(c.name, info.name);
  cut(c.vendor, info.vendor);
  cut(c.platform, info.platform);
  cut(c.driver, info.driver);
  cut(c.version, info.version);
  c.is_gpu = info.is_gpu, c.is_cpu = info.is_cpu;
  c.atomics64 = info.atomics64, c.fp64 = info.fp64, c.subgroups = info.subgroups;
  c.compute_units = info.compute_units, c.largest_work_group = info.largest_work_group;
  c.memory_bytes = info.memory_bytes, c.largest_buffer_bytes = info.largest_buffer_bytes;
  c.local_bytes = info.local_bytes;
  return c;
}

gcdt_solver_options read_solver_options(const gcdt_solver_options* options) {
  if (options) return read_struct(options, "gcdt_solver_options", offsetof(gcdt_solver_options, trace));
  return GCDT_SOLVER_OPTIONS_INIT;
}

runtime::Log read_log(gcdt_log_function call, void* user) {
  if (!call) return {};
  return [call, user](int level, const char* message) { call(user, level, message); };
}

Trace read_trace(gcdt_trace_function call, void* user) {
  if (!call) return {};
  return [call, user](const TraceSpan& span) {
    const gcdt_trace_span c = {sizeof c,          span.device.c_str(), span.device_number, span.phase.c_str(),
                               span.name.c_str(), span.on_device,      span.begin_ns,      span.end_ns};
    call(user, &c);
  };
}

// A copy that failed does not read any more. A wait that failed says nothing of the copy.
void State::settle() {
  for (const cl::Event& event : pending_copies) {
    const cl_int waited = event.wait();
    if (waited == CL_SUCCESS) continue;
    cl_int status = CL_QUEUED;
    const cl_int asked = event.getInfo(CL_EVENT_COMMAND_EXECUTION_STATUS, &status);
    if (asked != CL_SUCCESS || status > CL_COMPLETE) runtime.fail("clWaitForEvents", "a copy of a result", waited);
  }
  pending_copies.clear();
}

void State::end_failed_call() noexcept {
  runtime.attempt("clFinish", "after an error", [&] { return runtime.try_finish(); });
  runtime.tracer().clear();
  primitives.release();
}

DeviceTriangulation State::triangulate(InputSource source, const Options& options) {
  settle();
  runtime.memory().begin_call();
  return gcdt::triangulate(runtime, primitives, std::move(source), options);
}

DeviceTriangulation State::refine(const DeviceTriangulation& made, const Options& options) {
  settle();
  runtime.memory().begin_call();
  return refine_result(runtime, primitives, made, options);
}

}  // namespace gcdt::api

using namespace gcdt::api;

const char* gcdt_version(void) { return GCDT_VERSION; }

const char* gcdt_strerror(int32_t status) {
  const char* sentence =
      status < 0 && status > -20000 ? "an OpenCL call failed; its code is the status" : "unknown status";
  gcdt::detail::row_of(status, [&](const auto& row) { sentence = row.sentence; });
  return sentence;
}

int32_t gcdt_last_error(const gcdt_solver* solver, gcdt_error* error) {
  return guarded(nullptr, [&] {
    gcdt_error c = {};
    if (solver) {
      const Detail& d = solver->state->detail;
      c = {0, d.status, d.message.c_str(), d.indices.data(), d.indices.size(), d.pair_count};
    } else {
      const ThreadDetail& d = thread_detail;
      c = {0, d.status, d.message, d.indices, d.index_count, d.pair_count};
    }
    write_struct(c, error, "gcdt_error");
  });
}

int32_t gcdt_device_count(size_t* count) {
  return guarded(nullptr, [&] {
    require(count, "count is null");
    *count = runtime::all_devices().size();
  });
}

int32_t gcdt_device_get(size_t number, gcdt_device_info* info) {
  return guarded(nullptr, [&] {
    const auto all = runtime::all_devices();
    if (number >= all.size())
      throw Error(Status::no_device,
                  "there is no device " + std::to_string(number) + ", only " + std::to_string(all.size()));
    write_struct(device_info(runtime::describe(all[number])), info, "gcdt_device_info");
  });
}

int32_t gcdt_device_select(const char* spec, size_t* number, int32_t* ambiguous) {
  return guarded(nullptr, [&] {
    require(number, "number is null");
    bool several = false;
    *number = runtime::choose_device(spec ? spec : "", &several);
    if (ambiguous) *ambiguous = several;
  });
}

int32_t gcdt_solver_create(const gcdt_solver_options* options, gcdt_solver** solver) {
  return guarded(nullptr, [&] {
    require(solver, "solver is null");
    const gcdt_solver_options given = read_solver_options(options);
    const std::size_t number = runtime::choose_device(given.device ? given.device : "", nullptr);
    const std::vector<cl::Device> all = runtime::all_devices();
    if (number >= all.size()) throw Error(Status::no_device, "the chosen OpenCL device is gone");
    auto made = std::make_unique<gcdt_solver>();
    made->state = std::make_shared<State>(cl::Context(), all[number], read_log(given.log, given.log_user),
                                          read_trace(given.trace, given.trace_user));
    *solver = made.release();
  });
}

void gcdt_solver_release(gcdt_solver* solver) { delete solver; }

int32_t gcdt_solver_device(const gcdt_solver* solver, gcdt_device_info* info) {
  return guarded_call(solver,
                      [&] { write_struct(device_info(solver->state->runtime.info()), info, "gcdt_device_info"); });
}

int32_t gcdt_solver_trim(gcdt_solver* solver) {
  return guarded_call(solver, [&] {
    solver->state->settle();
    solver->state->runtime.memory().trim();
    solver->state->runtime.release_transfer_chunks();
  });
}

int32_t gcdt_triangulate(gcdt_solver* solver, const gcdt_input* input, const gcdt_options* options,
                         gcdt_result** result) {
  return guarded_call(solver, [&] {
    State& state = *solver->state;
    give_result(solver->state, result, [&] {
      const gcdt_input given = read_struct(input, "gcdt_input");
      const Points points = read_points(given);
      const Constraints constraints = read_constraints(given);
      const InputSource source = source_of(state.runtime, points, constraints);
      const Options wanted = read_options(options);
      const runtime::HostRoom room = make_room(state.runtime, options, given.vertex_count);
      const PinnedInput pinned(*state.pinned, points, constraints, wanted);
      return state.triangulate(source, wanted);
    });
  });
}
