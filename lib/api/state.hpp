// SPDX-License-Identifier: Apache-2.0
// Between the C interface (include/gcdt) and the pipeline: handles, structures with sizes, and the one place
// where exceptions become statuses.
#pragma once

#include <gcdt/gcdt.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <new>
#include <optional>

#include "device/step.hpp"
#include "query/arrays.hpp"
#include "query/derived.hpp"
#include "solve/triangulate.hpp"

namespace gcdt::api {

/// The last failure of a solver; see gcdt_error.
struct Detail {
  std::int32_t status = GCDT_OK;
  std::string message;
  std::vector<std::uint64_t> indices;
  std::uint64_t pair_count = 0;
};

/// What a solver and its results share. It lives as long as the last of them.
struct State {
  /// `hook`: of tests.
  State(const cl::Context& context, const cl::Device& device, runtime::Log log, Trace trace,
        runtime::CallHook hook = {})
      : runtime(context, device, std::move(hook), std::move(log), std::move(trace)), primitives(runtime) {
    // An application with a context may pin its memory itself: that is best left to the driver.
    if (!context()) runtime.use_transfer_chunks();
    runtime.know_pinned(pinned);
  }

  /// Waits for copies out of results that may be gone by now.
  void settle();
  /// After a call that failed, wherever it did: nothing of it is left in the queue, so that the caller may do with its
  /// memory and its buffers what it likes, nor in the trace.
  void end_failed_call() noexcept;
  /// Runs the pipeline.
  DeviceTriangulation triangulate(InputSource source, const Options& options);
  /// The same with what a result has (solve/refine_result.hpp).
  DeviceTriangulation refine(const DeviceTriangulation& made, const Options& options);

  runtime::Runtime runtime;
  Primitives primitives;
  runtime::BufferSource buffer_source;
  std::shared_ptr<runtime::PinnedRanges> pinned = std::make_shared<runtime::PinnedRanges>();  ///< of the input
  cl::CommandQueue their_queue;  ///< null: the solver has a context of its own
  std::vector<cl::Event> pending_copies;
  std::uint64_t results = 0;
  std::atomic_flag in_call = ATOMIC_FLAG_INIT;
  Detail detail;
};

/// The status of an error: OpenCL's code if one was the reason.
std::int32_t code_of(const Error& error);

/// Keeps the failure for gcdt_last_error, of the thread and of `state` if there is one, and returns `status`.
std::int32_t failed(State* state, std::int32_t status, const char* message,
                    const std::vector<std::uint64_t>& indices = {}, std::uint64_t pair_count = 0) noexcept;

/// Runs `f`; its exceptions become a status with details.
template <class F>
std::int32_t guarded(State* state, F&& f) noexcept {
  try {
    f();
    return GCDT_OK;
  } catch (const Error& error) {
    return failed(state, code_of(error), error.what(), error.indices(), error.pair_count());
  } catch (const std::bad_alloc&) {
    return failed(state, GCDT_ERROR_HOST_MEMORY, "the host is out of memory");
  } catch (const std::exception& error) {
    return failed(state, GCDT_ERROR_INTERNAL, error.what());
  } catch (...) {
    return failed(state, GCDT_ERROR_INTERNAL, "an unknown exception");
  }
}

/// The same for one call on a solver or result, which may be null: an error then. No two at a time.
template <class Handle, class F>
std::int32_t guarded_call(const Handle* handle, F&& f) noexcept {
  if (!handle) return failed(nullptr, GCDT_ERROR_INVALID_ARGUMENT, "the solver or result is null");
  State* const state = handle->state.get();
  if (state->in_call.test_and_set())
    return failed(nullptr, GCDT_ERROR_IN_USE, "the solver is in a call, of another thread or of a callback's caller");
  const std::int32_t status = guarded(state, f);
  if (status != GCDT_OK) state->end_failed_call();
  state->in_call.clear();
  return status;
}

inline void require(bool holds, const char* what) {
  if (!holds) throw Error(Status::invalid_argument, what);
}

/// `elements` of the library's, or what `name` says, have no room in the caller's array.
Error too_small(std::uint64_t elements, std::uint64_t capacity, const char* name = "elements");

/// A structure of the caller's, of whatever version that is known: members that it lacks are zero. `least` is the
/// size of the first version.
template <class T>
T read_struct(const T* given, const char* name, std::size_t least = sizeof(T)) {
  if (!given) throw Error(Status::invalid_argument, std::string(name) + " is null");
  T known = {};
  if (given->struct_size < least || given->struct_size > sizeof(T))
    throw Error(Status::invalid_argument,
                std::string(name) + " has struct_size " + std::to_string(given->struct_size) + "; this library knows " +
                    std::to_string(sizeof(T)),
                {}, 0, GCDT_ERROR_STRUCT_SIZE);
  std::memcpy(&known, given, given->struct_size);
  return known;
}

/// Gives the caller the members that its version has.
template <class T>
void write_struct(T value, T* to, const char* name, std::size_t least = sizeof(T)) {
  const std::size_t size = read_struct(to, name, least).struct_size;
  value.struct_size = size;
  std::memcpy(to, &value, size);
}

/// Its values are judged later, by check_refinement().
Refinement read_refinement(const gcdt_refinement* refine);
/// Only pools take more than one tile.
Options read_options(const gcdt_options* options, std::uint32_t most_tiles = 1);
Crossing read_crossing(std::int32_t crossing, const char* name);
Points::Type read_type(std::int32_t coordinate_type);
Points read_points(const gcdt_input& input);
Constraints read_constraints(const gcdt_input& input);
gcdt_device_info device_info(const DeviceInfo& info);
Grid read_grid(const gcdt_grid* grid);
MeshView read_mesh(const gcdt_mesh* mesh);
/// `options` may be null.
gcdt_solver_options read_solver_options(const gcdt_solver_options* options);
runtime::Log read_log(gcdt_log_function call, void* user);
Trace read_trace(gcdt_trace_function call, void* user);

/// Throws invalid_argument for an unknown number.
const ResultArray& known_array(std::int32_t number);

/// Where one of the arrays of a result is.
struct DeviceArray {
  runtime::Memory memory;
  std::uint64_t count = 0;
  std::size_t element_bytes = 0;
  std::uint64_t bytes() const { return count * element_bytes; }
};

}  // namespace gcdt::api

struct gcdt_solver {
  std::shared_ptr<gcdt::api::State> state;
};

struct gcdt_result {
  gcdt_result(std::shared_ptr<gcdt::api::State> solver, gcdt::DeviceTriangulation made)
      : state(std::move(solver)), data(std::move(made)) {
    ++state->results;
  }
  ~gcdt_result() { --state->results; }
  /// Throws invalid_argument for an unknown number. Makes what is made on demand; within a call on the solver.
  gcdt::api::DeviceArray array(std::int32_t number) const;
  /// Its elements; 0 for an unknown number. Makes nothing.
  std::uint64_t count(std::int32_t number) const;

  std::shared_ptr<gcdt::api::State> state;
  gcdt::DeviceTriangulation data;
  mutable gcdt::Derived derived;
};

namespace gcdt::api {

/// Gives the caller a result of what make() returns, and tells it how long that took on the caller's clock.
template <class Make>
void give_result(const std::shared_ptr<State>& state, gcdt_result** result, Make&& make) {
  require(result, "result is null");
  const auto start = std::chrono::steady_clock::now();
  auto made = std::make_unique<gcdt_result>(state, make());
  made->data.statistics.ms.call = milliseconds_since(start);
  *result = made.release();
}

}  // namespace gcdt::api
