// SPDX-License-Identifier: Apache-2.0
// The C++17 interface to pools of devices and batches of problems, header-only over gcdt_pool.h, which has the rules.
#pragma once

#include <tuple>

#include <gcdt/gcdt_pool.h>
#include <gcdt/gcdt.hpp>

namespace gcdt {

/// A ragged batch of the caller's: problem p has the vertices [vertex_offsets[p], vertex_offsets[p + 1]), and so its
/// constraints, whose ends count from 0 in each problem. Both offsets have one element more than there are problems;
/// those of constraints may be missing if there are none.
struct BatchView {
  Points vertices;
  Span<std::uint64_t> vertex_offsets;
  Constraints constraints;
  Span<std::uint64_t> constraint_offsets;
};

/// A batch that is put together problem by problem.
class Batch {
 public:
  void add(Span<std::array<double, 2>> vertices, Constraints constraints = {}) {
    vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
    constraints_.insert(constraints_.end(), constraints.begin(), constraints.end());
    vertex_offsets_.push_back(vertices_.size());
    constraint_offsets_.push_back(constraints_.size());
  }
  void add(const std::vector<std::array<double, 2>>& vertices, const std::vector<Constraint>& constraints = {}) {
    add(Span<std::array<double, 2>>(vertices), Constraints(constraints));
  }
  std::size_t size() const { return vertex_offsets_.size() - 1; }
  BatchView view() const { return {vertices_, vertex_offsets_, constraints_, constraint_offsets_}; }

 private:
  std::vector<std::array<double, 2>> vertices_;
  std::vector<Constraint> constraints_;
  std::vector<std::uint64_t> vertex_offsets_ = {0}, constraint_offsets_ = {0};
};

/// What Crossing::split has done to a problem; see the members of Statistics.
struct SplitReport {
  std::uint64_t crossings = 0, vertices_added = 0, constraints_split = 0;
  double constraint_move = 0;
};

/// What Options::refine has done to a problem; see the members of gcdt_problem.
struct RefinedReport {
  bool complete = true;  ///< it did not end by the limit of vertices
  std::uint64_t rounds = 0, added = 0, left = 0;
};

/// How a problem was cut; see the members of gcdt_problem.
struct TilesReport {
  std::uint32_t tiles = 0;
  std::uint64_t seam_vertices = 0;
};

/// The results of a batch, in host memory until the object is gone; views are into it. Move-only.
class BatchResult {
 public:
  explicit BatchResult(gcdt_batch* handle) : handle_(handle) {}
  /// The C handle, which the object keeps.
  gcdt_batch* handle() const { return handle_.get(); }

  gcdt_batch_statistics statistics() const {
    gcdt_batch_statistics c = {};
    c.struct_size = sizeof c;
    detail::check(gcdt_batch_get_statistics(handle_.get(), &c));
    return c;
  }
  std::size_t size() const { return static_cast<std::size_t>(statistics().problems); }

  /// What is wrong with the problem, in its own numbers; nothing if it was triangulated.
  std::optional<Error> error(std::size_t problem) const {
    const gcdt_problem c = info(problem);
    if (c.status == GCDT_OK) return std::nullopt;
    return Error(detail::status_of(c.status), c.message, {c.indices, c.indices + c.index_count}, c.pair_count,
                 c.status > -20000 ? c.status : 0);
  }
  Grid grid(std::size_t problem) const { return detail::grid(info(problem).grid); }

  /// All 0 for a problem without crossings, or with an error.
  SplitReport split(std::size_t problem) const {
    const gcdt_problem c = info(problem);
    return {c.crossings, c.vertices_added, c.constraints_split, c.constraint_move};
  }

  /// All 0, and complete, for a problem that was not to be refined; not complete with an error.
  RefinedReport refined(std::size_t problem) const {
    const gcdt_problem c = info(problem);
    return {c.refine_complete != 0, c.refine_rounds, c.refine_added, c.refine_left};
  }

  TilesReport tiles(std::size_t problem) const {
    const gcdt_problem c = info(problem);
    return {c.tiles, c.seam_vertices};
  }

  /// Vertices that rounding made one, and the first of them with the one that stands for it; see Statistics.
  std::pair<std::uint64_t, std::array<std::uint32_t, 2>> rounded_together(std::size_t problem) const {
    const gcdt_problem c = info(problem);
    return {c.vertices_rounded_together, {c.rounded_pair[0], c.rounded_pair[1]}};
  }

  /// The problem's arrays by their names in gcdt/arrays.def: triangles(p), neighbours(p) and so on. Empty if it has an
  /// error, and where the options do not ask for them.
#define GCDT_ARRAY(number, name, type, width, ...)                     \
  Span<detail::Element<type, width>> name(std::size_t problem) const { \
    return array<detail::Element<type, width>>(problem, number);       \
  }
#include <gcdt/arrays.def>

 private:
  gcdt_problem info(std::size_t problem) const {
    gcdt_problem c = {};
    c.struct_size = sizeof c;
    detail::check(gcdt_batch_problem(handle_.get(), problem, &c));
    return c;
  }
  template <class T>
  Span<T> array(std::size_t problem, std::int32_t number) const {
    const void* data = nullptr;
    std::uint64_t count = 0;
    detail::check(gcdt_batch_array(handle_.get(), problem, number, &data, &count));
    return {static_cast<const T*>(data), static_cast<std::size_t>(count)};
  }
  struct Release {
    void operator()(gcdt_batch* batch) const { gcdt_batch_release(batch); }
  };
  std::unique_ptr<gcdt_batch, Release> handle_;
};

namespace detail {

/// What the batch has to say of a problem without an error.
inline Statistics statistics(const BatchResult& batch, std::size_t problem) {
  Statistics s;
  s.grid = batch.grid(problem);
  std::tie(s.vertices_rounded_together, s.rounded_pair) = batch.rounded_together(problem);
  const SplitReport split = batch.split(problem);
  s.crossings = split.crossings, s.vertices_added = split.vertices_added;
  s.constraints_split = split.constraints_split, s.constraint_move = split.constraint_move;
  const RefinedReport refined = batch.refined(problem);
  s.refine.complete = refined.complete, s.refine.rounds = refined.rounds, s.refine.added = refined.added;
  return s;
}

/// A copy of the problem's arrays, and the same.
inline Triangulation triangulation(const BatchResult& batch, std::size_t problem) {
  Triangulation all;
#define GCDT_ARRAY(number, name, ...) all.name.assign(batch.name(problem).begin(), batch.name(problem).end());
#include <gcdt/arrays.def>
  all.statistics = statistics(batch, problem);
  all.statistics.triangles = all.triangles.size();
  all.added = grid_coordinates(all.statistics.grid, all.added_on_grid);
  return all;
}

}  // namespace detail

/// A device of a pool: what it is, why it was taken out, and its part in the last batch.
struct PoolDevice {
  DeviceInfo info;
  std::optional<Error> lost;
  std::uint64_t problems = 0, vertices = 0, runs = 0;
  double ms_busy = 0;
};

namespace detail {

/// `log` and `trace` may be null.
inline gcdt_pool_options pool_options(LogFunction* log, Trace* trace) {
  gcdt_pool_options c = GCDT_POOL_OPTIONS_INIT;
  if (log) c.log = call_log, c.log_user = log;
  if (trace) c.trace = call_trace, c.trace_user = trace;
  return c;
}

}  // namespace detail

/// Triangulates batches on any set of devices. One object by one thread at a time. Move-only.
class Pool {
 public:
  /// `devices`, `memory_bytes`, `spill_directory`, `pinned_results`: see gcdt_pool_options. Log and trace are called by
  /// the pool's threads, one at a time. Throws no_device, or what all devices failed with.
  explicit Pool(const std::string& devices = {}, Log log = {}, Trace trace = {}, std::uint64_t memory_bytes = 0,
                const std::string& spill_directory = {}, bool pinned_results = false)
      : log_(detail::boxed(std::move(log))), trace_(detail::boxed(std::move(trace))) {
    gcdt_pool_options options = detail::pool_options(log_.get(), trace_.get());
    options.devices = devices.c_str();
    options.memory_bytes = memory_bytes;
    options.spill_directory = spill_directory.c_str();
    options.pinned_results = pinned_results;
    gcdt_pool* pool = nullptr;
    detail::check(gcdt_pool_create(&options, &pool));
    handle_.reset(pool);
  }
  /// Takes over a handle; `log` and `trace`, if any, are what it was created with.
  explicit Pool(gcdt_pool* handle, std::unique_ptr<Log> log = {}, std::unique_ptr<Trace> trace = {})
      : log_(std::move(log)), trace_(std::move(trace)), handle_(handle) {}

  /// The C handle, which the object keeps.
  gcdt_pool* handle() const { return handle_.get(); }

  /// The devices that the pool was made with.
  std::vector<PoolDevice> devices() const {
    std::vector<PoolDevice> all;
    for (std::size_t i = 0; i < gcdt_pool_device_count(handle_.get()); ++i) {
      gcdt_pool_device c = {};
      c.struct_size = sizeof c;
      detail::check(gcdt_pool_device_get(handle_.get(), i, &c));
      PoolDevice device;
      device.info = detail::device_info([&](gcdt_device_info* info) { return *info = c.info, GCDT_OK; });
      if (c.status != GCDT_OK)
        device.lost = Error(detail::status_of(c.status), c.message, {}, 0, c.status > -20000 ? c.status : 0);
      device.problems = c.problems, device.vertices = c.vertices, device.runs = c.runs, device.ms_busy = c.ms_busy;
      all.push_back(std::move(device));
    }
    return all;
  }

  /// See gcdt_pool_triangulate. Problems that are invalid have errors in the result. Throws Error, and what the
  /// progress function throws. Blocks.
  BatchResult triangulate(const BatchView& batch, const Options& options = {}) {
    gcdt_batch_input input = GCDT_BATCH_INPUT_INIT;
    input.coordinate_type = detail::coordinate_type(batch.vertices.type());
    input.problem_count = batch.vertex_offsets.empty() ? 0 : batch.vertex_offsets.size() - 1;
    const bool right = batch.constraint_offsets.size() == batch.vertex_offsets.size() ||
                       (batch.constraint_offsets.empty() && batch.constraints.empty());
    if (!right) throw Error(Status::invalid_argument, "constraint_offsets and vertex_offsets are not of one length");
    if (input.problem_count > 0 && batch.vertex_offsets[input.problem_count] > batch.vertices.size())
      throw Error(Status::invalid_argument, "vertex_offsets go beyond the vertices");
    if (input.problem_count > 0 && !batch.constraint_offsets.empty() &&
        batch.constraint_offsets[input.problem_count] > batch.constraints.size())
      throw Error(Status::invalid_argument, "constraint_offsets go beyond the constraints");
    input.vertices = batch.vertices.data(), input.vertex_offsets = batch.vertex_offsets.data();
    input.constraints = reinterpret_cast<const std::uint32_t*>(batch.constraints.data());
    input.constraint_offsets = batch.constraint_offsets.data();
    return BatchResult(
        detail::made<gcdt_batch>(options, nullptr, gcdt_batch_release, [&](const gcdt_options& given, auto** result) {
          return gcdt_pool_triangulate(handle(), &input, &given, result);
        }));
  }
  BatchResult triangulate(const Batch& batch, const Options& options = {}) {
    return triangulate(batch.view(), options);
  }

 private:
  struct Release {
    void operator()(gcdt_pool* pool) const { gcdt_pool_release(pool); }
  };
  std::unique_ptr<Log> log_;      // the handle has its address
  std::unique_ptr<Trace> trace_;  // so it does of this
  std::unique_ptr<gcdt_pool, Release> handle_;
};

}  // namespace gcdt
