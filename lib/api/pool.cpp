// SPDX-License-Identifier: Apache-2.0
// The C interface: pools of devices and batches of problems.
#include <gcdt/gcdt_pool.h>
#include <gcdt/detail.hpp>

#include "api/pool.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

// Problems without constraints may come without their offsets.
struct ReadBatch {
  BatchInput batch;
  std::vector<std::uint64_t> no_offsets;  ///< of arrays that are null
};

void require_ascending(const std::uint64_t* offsets, std::uint64_t problems, const char* name) {
  for (std::uint64_t p = 0; p < problems; ++p)
    if (offsets[p] > offsets[p + 1])
      throw Error(Status::invalid_argument, std::string(name) + " fall from problem " + std::to_string(p) + " on", {p});
}

ReadBatch read_batch(const gcdt_batch_input* input) {
  const gcdt_batch_input given = read_struct(input, "gcdt_batch_input");
  ReadBatch read;
  BatchInput& batch = read.batch;
  batch.type = read_type(given.coordinate_type);
  batch.problems = given.problem_count;
  if (batch.problems == 0) return read;
  if (batch.problems > most_problems)
    throw Error(Status::invalid_argument, std::to_string(batch.problems) + " problems; at most 2^30 fit a batch");
  require(given.vertex_offsets, "gcdt_batch_input.vertex_offsets is null");
  require(given.constraint_offsets || !given.constraints, "gcdt_batch_input.constraint_offsets is null");
  require_ascending(given.vertex_offsets, batch.problems, "gcdt_batch_input.vertex_offsets");
  if (given.constraint_offsets)
    require_ascending(given.constraint_offsets, batch.problems, "gcdt_batch_input.constraint_offsets");
  const auto none = [&](const std::uint64_t* offsets) { return !offsets || offsets[batch.problems] == offsets[0]; };
  require(given.vertices || none(given.vertex_offsets), "gcdt_batch_input.vertices is null");
  require(given.constraints || none(given.constraint_offsets), "gcdt_batch_input.constraints is null");
  // There are no places in an array that is not there.
  if (!given.vertices || !given.constraints) read.no_offsets.assign(batch.problems + 1, 0);
  batch.vertex_offsets = given.vertices ? given.vertex_offsets : read.no_offsets.data();
  batch.constraint_offsets = given.constraints ? given.constraint_offsets : read.no_offsets.data();
  batch.vertices = given.vertices;
  batch.constraints = reinterpret_cast<const Constraint*>(given.constraints);
  return read;
}

struct View {
  const unsigned char* data = nullptr;
  std::uint64_t count = 0;
};

View view(const gcdt_batch& batch, std::uint64_t problem, std::int32_t array) {
  const std::size_t bytes = known_array(array).element_bytes;
  const auto kind = static_cast<std::size_t>(array);
  if (batch.made.errors.count(static_cast<std::uint32_t>(problem)) > 0 || kind >= array_slots) return {};
  const auto [result, place] = batch.made.at(problem);
  if (result->begins[kind].empty()) return {};
  const std::uint64_t begin = result->begins[kind][place], end = result->begins[kind][place + 1];
  return {result->arrays[kind].bytes.get() + begin * bytes, end - begin};
}

void require_problem(const gcdt_batch* batch, std::uint64_t problem) {
  require(batch, "batch is null");
  if (problem >= batch->made.places.size())
    throw Error(Status::invalid_argument, "there is no problem " + std::to_string(problem) + " in a batch of " +
                                              std::to_string(batch->made.places.size()));
}

}  // namespace

namespace gcdt::api {

gcdt_pool_options read_pool_options(const gcdt_pool_options* options) {
  if (options) return read_struct(options, "gcdt_pool_options", offsetof(gcdt_pool_options, memory_bytes));
  return GCDT_POOL_OPTIONS_INIT;
}

void make_pool(std::vector<DevicePool::Member> members, const gcdt_pool_options& options, gcdt_pool** pool) {
  if (options.memory_bytes > 0)
    for (DevicePool::Member& member : members) member.hook.tuning.memory_bytes = options.memory_bytes;
  auto made = std::make_unique<gcdt_pool>();
  made->devices = std::make_unique<DevicePool>(std::move(members), read_log(options.log, options.log_user),
                                               read_trace(options.trace, options.trace_user));
  if (options.spill_directory) made->devices->spill_to(options.spill_directory);
  if (options.pinned_results) made->devices->pin_results();
  *pool = made.release();
}

void copy_batch(const gcdt_batch& batch, std::int32_t array, void* destination, std::uint64_t capacity,
                std::uint64_t* offsets) {
  const std::uint64_t problems = batch.made.places.size(), bytes = known_array(array).element_bytes;
  std::uint64_t all = 0;
  for (std::uint64_t p = 0; p < problems; ++p) all += view(batch, p, array).count;
  if (destination && capacity < all) throw too_small(all, capacity);
  auto* to = static_cast<unsigned char*>(destination);
  std::uint64_t at = 0;
  for (std::uint64_t p = 0; p < problems; ++p) {
    const View from = view(batch, p, array);
    if (offsets) offsets[p] = at;
    if (to && from.count > 0) std::memcpy(to + at * bytes, from.data, from.count * bytes);
    at += from.count;
  }
  if (offsets) offsets[problems] = at;
}

}  // namespace gcdt::api

int32_t gcdt_pool_create(const gcdt_pool_options* options, gcdt_pool** pool) {
  return guarded(nullptr, [&] {
    require(pool, "pool is null");
    const gcdt_pool_options given = read_pool_options(options);
    const std::vector<std::size_t> chosen = runtime::choose_devices(given.devices ? given.devices : "");
    const std::vector<cl::Device> all = runtime::all_devices();
    std::vector<DevicePool::Member> members;
    for (const std::size_t number : chosen) {
      if (number >= all.size()) throw Error(Status::no_device, "a chosen OpenCL device is gone");
      members.push_back({cl::Context(), all[number], {}});
    }
    make_pool(std::move(members), given, pool);
  });
}

void gcdt_pool_release(gcdt_pool* pool) { delete pool; }

size_t gcdt_pool_device_count(const gcdt_pool* pool) { return pool ? pool->devices->size() : 0; }

int32_t gcdt_pool_device_get(const gcdt_pool* pool, size_t number, gcdt_pool_device* device) {
  return guarded(nullptr, [&] {
    require(pool, "pool is null");
    if (number >= pool->devices->size())
      throw Error(Status::invalid_argument, "there is no device " + std::to_string(number) + " in the pool, only " +
                                                std::to_string(pool->devices->size()));
    const DeviceReport& report = pool->devices->report(number);
    gcdt_pool_device c = {};
    c.status = report.lost ? code_of(*report.lost) : GCDT_OK;
    c.message = report.lost ? report.lost->what() : "";
    c.problems = report.problems, c.vertices = report.vertices, c.runs = report.runs;
    c.ms_busy = report.milliseconds;
    c.info = device_info(report.info);
    c.info.struct_size = sizeof c.info;
    write_struct(c, device, "gcdt_pool_device");
  });
}

int32_t gcdt_pool_triangulate(gcdt_pool* pool, const gcdt_batch_input* input, const gcdt_options* options,
                              gcdt_batch** batch) {
  if (pool && pool->in_call.test_and_set())
    return failed(nullptr, GCDT_ERROR_IN_USE, "the pool is in a call, of another thread or of a callback's caller");
  const std::int32_t status = guarded(nullptr, [&] {
    const auto start = std::chrono::steady_clock::now();
    require(pool, "pool is null");
    require(batch, "batch is null");
    const ReadBatch read = read_batch(input);
    Options wanted = read_options(options, GCDT_MAX_TILES);
    if (wanted.refine) {
      require(wanted.tiles <= 1, "a problem in tiles is not refined: gcdt_options.tiles must be 0 or 1");
      wanted.tiles = 1;
    }
    auto made = std::make_unique<gcdt_batch>();
    made->made = tiles::triangulate(*pool->devices, read.batch, wanted);
    gcdt_batch_statistics& s = made->statistics;
    s.problems = read.batch.problems;
    if (s.problems > 0) {
      s.vertices = read.batch.vertex_offsets[s.problems] - read.batch.vertex_offsets[0];
      s.constraints = read.batch.constraint_offsets[s.problems] - read.batch.constraint_offsets[0];
    }
    s.failed = made->made.errors.size();
    for (const ForestResult& result : made->made.results) s.triangles += result.triangles();
    s.ms_call = milliseconds_since(start);
    *batch = made.release();
  });
  if (pool) pool->in_call.clear();
  return status;
}

int32_t gcdt_batch_problem(const gcdt_batch* batch, uint64_t problem, gcdt_problem* info) {
  return guarded(nullptr, [&] {
    require_problem(batch, problem);
    gcdt_problem c = {};
    c.message = "";
    const auto& errors = batch->made.errors;
    if (const auto found = errors.find(static_cast<std::uint32_t>(problem)); found != errors.end()) {
      const Error& error = found->second;
      c.status = code_of(error);
      c.message = error.what();
      c.indices = error.indices().data(), c.index_count = error.indices().size();
      c.pair_count = error.pair_count();
      c.grid = detail::grid(Grid());
    } else {
      const auto [result, place] = batch->made.at(problem);
      c.grid = detail::grid(result->grids[place]);
      c.triangles = view(*batch, problem, GCDT_TRIANGLES).count;
      c.refine_complete = 1;
      if (!result->begins[GCDT_ADDED].empty()) {  // a result of one
        const Statistics& s = result->statistics;
        c.crossings = s.crossings, c.vertices_added = s.vertices_added, c.constraints_split = s.constraints_split;
        c.constraint_move = s.constraint_move;
        c.refine_complete = s.refine.complete;
        c.refine_rounds = s.refine.rounds, c.refine_added = s.refine.added;
        c.refine_left = s.refine.left_input_angle + s.refine.left_beside_angle + s.refine.left_grid +
                        s.refine.left_fixed + s.refine.left_refused + s.refine.left_limit;
      }
      if (!result->together.empty()) {
        c.vertices_rounded_together = result->together[place].count;
        std::copy_n(result->together[place].first.begin(), 2, c.rounded_pair);
      }
      c.tiles = result->tiles.tiles, c.seam_vertices = result->tiles.seam_vertices;
    }
    write_struct(c, info, "gcdt_problem", offsetof(gcdt_problem, crossings));
  });
}

int32_t gcdt_batch_array(const gcdt_batch* batch, uint64_t problem, int32_t array, const void** data, uint64_t* count) {
  return guarded(nullptr, [&] {
    require_problem(batch, problem);
    require(data && count, "data or count is null");
    const View found = view(*batch, problem, array);
    *data = found.data;
    *count = found.count;
  });
}

int32_t gcdt_batch_copy(const gcdt_batch* batch, int32_t array, void* destination, uint64_t capacity,
                        uint64_t* offsets) {
  return guarded(nullptr, [&] {
    require(batch, "batch is null");
    copy_batch(*batch, array, destination, capacity, offsets);
  });
}

int32_t gcdt_batch_get_statistics(const gcdt_batch* batch, gcdt_batch_statistics* statistics) {
  return guarded(nullptr, [&] {
    require(batch, "batch is null");
    write_struct(batch->statistics, statistics, "gcdt_batch_statistics");
  });
}

void gcdt_batch_release(gcdt_batch* batch) { delete batch; }
