// SPDX-License-Identifier: Apache-2.0
// The C++17 interface for applications with an OpenCL context of their own: header-only over gcdt_cl.h and the
// bindings <CL/opencl.hpp>, whose objects are taken as they are. Ownership, order and blocking: as gcdt_cl.h says.
#pragma once

#ifndef CL_HPP_TARGET_OPENCL_VERSION
#define CL_HPP_TARGET_OPENCL_VERSION 120
#endif
#ifndef CL_HPP_MINIMUM_OPENCL_VERSION
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#endif
#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION CL_HPP_TARGET_OPENCL_VERSION
#endif
#include <CL/opencl.hpp>

#include <gcdt/gcdt_cl.h>
#include <gcdt/gcdt.hpp>
#include <gcdt/gcdt_pool.hpp>

namespace gcdt {

/// `count` vertices from vertex number `offset` on, in device memory.
struct DevicePoints {
  Points::Type type = Points::Type::int32;  ///< int32: on the grid 0, 0, "1" as they are, none negative
  ::cl::Buffer buffer;
  std::uint64_t count = 0, offset = 0;
};

/// `count` constraints from number `offset` on, in device memory: pairs of cl_uint.
struct DeviceConstraints {
  ::cl::Buffer buffer;
  std::uint64_t count = 0, offset = 0;
};

/// A batch in device memory: offsets are cl_ulong, one more than there are problems; constraints and their offsets may
/// be null buffers if there are none. See gcdt_cl_batch_input.
struct DeviceBatch {
  Points::Type type = Points::Type::float64;
  std::uint64_t problems = 0;
  ::cl::Buffer vertices, vertex_offsets, constraints, constraint_offsets;
};

/// A solver on the context and device of `queue`. Blocks. Throws device_failed.
inline Solver make_solver(const ::cl::CommandQueue& queue, Log log = {}) {
  std::unique_ptr<Log> kept = detail::boxed(std::move(log));
  const gcdt_solver_options options = detail::solver_options(kept.get());
  gcdt_solver* solver = nullptr;
  detail::check(gcdt_cl_solver_create(queue(), &options, &solver));
  return Solver(solver, std::move(kept));
}

/// A pool of the devices of the queues, on their contexts. Blocks. Throws what all devices failed with.
inline Pool make_pool(const std::vector<::cl::CommandQueue>& queues, Log log = {}, Trace trace = {}) {
  std::unique_ptr<Log> kept_log = detail::boxed(std::move(log));
  std::unique_ptr<Trace> kept_trace = detail::boxed(std::move(trace));
  const gcdt_pool_options options = detail::pool_options(kept_log.get(), kept_trace.get());
  std::vector<cl_command_queue> handles;
  for (const ::cl::CommandQueue& queue : queues) handles.push_back(queue());
  gcdt_pool* pool = nullptr;
  detail::check(gcdt_cl_pool_create(static_cast<cl_uint>(handles.size()), handles.data(), &options, &pool));
  return Pool(pool, std::move(kept_log), std::move(kept_trace));
}

namespace detail {
inline const cl_event* handles(const std::vector<::cl::Event>& events) {
  static_assert(sizeof(::cl::Event) == sizeof(cl_event), "the bindings hold nothing but the handle");
  return events.empty() ? nullptr : reinterpret_cast<const cl_event*>(events.data());
}
}  // namespace detail

/// As Solver::solve, from device memory to device memory, after `events`. `solver` is one of make_solver.
inline Result solve(Solver& solver, const DevicePoints& points, const DeviceConstraints& constraints = {},
                    const Options& options = {}, const std::vector<::cl::Event>& events = {}) {
  gcdt_cl_input input = GCDT_CL_INPUT_INIT;
  input.coordinate_type = detail::coordinate_type(points.type);
  input.vertices = points.buffer();
  input.vertex_offset = points.offset, input.vertex_count = points.count;
  input.constraints = constraints.buffer();
  input.constraint_offset = constraints.offset, input.constraint_count = constraints.count;
  return Result(detail::made<gcdt_result>(
      options, solver.handle(), gcdt_result_release, [&](const gcdt_options& given, auto** result) {
        return gcdt_cl_triangulate(solver.handle(), &input, &given, static_cast<cl_uint>(events.size()),
                                   detail::handles(events), result);
      }));
}

/// As Pool::triangulate, from device memory by commands in `queue` after `events`; see gcdt_cl_pool_triangulate.
/// Blocks.
inline BatchResult triangulate(Pool& pool, const ::cl::CommandQueue& queue, const DeviceBatch& batch,
                               const Options& options = {}, const std::vector<::cl::Event>& events = {}) {
  gcdt_cl_batch_input input = GCDT_CL_BATCH_INPUT_INIT;
  input.coordinate_type = detail::coordinate_type(batch.type);
  input.problem_count = batch.problems;
  input.vertices = batch.vertices(), input.vertex_offsets = batch.vertex_offsets();
  input.constraints = batch.constraints(), input.constraint_offsets = batch.constraint_offsets();
  return BatchResult(
      detail::made<gcdt_batch>(options, nullptr, gcdt_batch_release, [&](const gcdt_options& given, auto** result) {
        return gcdt_cl_pool_triangulate(pool.handle(), queue(), &input, &given, static_cast<cl_uint>(events.size()),
                                        detail::handles(events), result);
      }));
}

/// An array of all problems into `destination`, where `capacity` elements from `offset` on may be written, and where
/// each problem's begins into `offsets`, if that is a buffer. See gcdt_cl_batch_copy. Blocks.
inline void copy(const BatchResult& result, std::int32_t array, const ::cl::CommandQueue& queue,
                 const ::cl::Buffer& destination, std::uint64_t capacity, std::uint64_t offset = 0,
                 const ::cl::Buffer& offsets = {}, const std::vector<::cl::Event>& events = {}) {
  detail::check(gcdt_cl_batch_copy(result.handle(), array, queue(), destination(), offset, capacity, offsets(),
                                   static_cast<cl_uint>(events.size()), detail::handles(events)));
}

/// The device memory of an array (GCDT_TRIANGLES ...), without a copy; see gcdt_cl_result_buffer.
inline ::cl::Buffer buffer_of(const Result& result, std::int32_t array) {
  cl_mem memory = nullptr;
  detail::check(gcdt_cl_result_buffer(result.handle(), array, &memory));
  return ::cl::Buffer(memory, true);
}

/// Enqueues the copy of an array into `destination`, where `capacity` elements from `offset` on may be written.
inline ::cl::Event enqueue_copy(const Result& result, std::int32_t array, const ::cl::CommandQueue& queue,
                                const ::cl::Buffer& destination, std::uint64_t capacity, std::uint64_t offset = 0,
                                const std::vector<::cl::Event>& events = {}) {
  cl_event event = nullptr;
  detail::check(gcdt_cl_enqueue_copy(result.handle(), array, queue(), destination(), offset, capacity,
                                     static_cast<cl_uint>(events.size()), detail::handles(events), &event));
  return ::cl::Event(event);
}

/// Where points in device memory are, into device memory: cl_int a point, and three cl_float if `weights` is a buffer.
/// See gcdt_cl_locate. Blocks.
inline void locate(const Result& result, const DevicePoints& points, const ::cl::Buffer& triangles,
                   const ::cl::Buffer& weights = {}, const std::vector<::cl::Event>& events = {}) {
  detail::check(gcdt_cl_locate(result.handle(), detail::coordinate_type(points.type), points.buffer(), points.offset,
                               points.count, triangles(), weights(), static_cast<cl_uint>(events.size()),
                               detail::handles(events)));
}

/// See gcdt_cl_set_workspace.
inline void set_workspace(Solver& solver, const std::vector<::cl::Buffer>& buffers) {
  std::vector<cl_mem> all;
  for (const auto& buffer : buffers) all.push_back(buffer());
  detail::check(gcdt_cl_set_workspace(solver.handle(), static_cast<cl_uint>(all.size()), all.data()));
}

}  // namespace gcdt
