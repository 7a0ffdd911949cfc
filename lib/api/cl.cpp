// SPDX-License-Identifier: Apache-2.0
// The C interface for applications with an OpenCL context of their own.
#include "api/state.hpp"
#include "device/workspace.hpp"

// Its header last: opencl.hpp chooses the version of OpenCL.
#include <gcdt/gcdt_cl.h>

using namespace gcdt;
using namespace gcdt::api;

namespace {

/// A range of bytes in a buffer of the caller's. `root` is the buffer itself, or the parent of a sub-buffer.
struct Range {
  cl_mem root = nullptr;
  std::size_t begin = 0, end = 0;
  bool meets(const Range& other) const { return root == other.root && begin < other.end && other.begin < end; }
};

template <class T>
T memory_info(State& state, cl_mem memory, cl_mem_info what) {
  T value = {};
  state.runtime.call("clGetMemObjectInfo", "an argument",
                     [&] { return clGetMemObjectInfo(memory, what, sizeof value, &value, nullptr); });
  return value;
}

template <class T>
T queue_info(State* state, cl_command_queue queue, cl_command_queue_info what) {
  T value = {};
  const cl_int code = clGetCommandQueueInfo(queue, what, sizeof value, &value, nullptr);
  if (code != CL_SUCCESS) {
    if (state) state->runtime.fail("clGetCommandQueueInfo", "an argument", code);
    throw Error(Status::device_failed, "clGetCommandQueueInfo failed with OpenCL code " + std::to_string(code), {}, 0,
                code);
  }
  return value;
}

/// The range of `count` elements from `offset` on. They must exist, and the buffer must not have the flag `forbidden`.
Range checked_range(State& state, const char* name, cl_mem memory, std::uint64_t offset, std::uint64_t count,
                    std::size_t element_bytes, cl_mem_flags forbidden) {
  if (!memory && count == 0) return {};
  if (!memory) throw Error(Status::invalid_argument, std::string(name) + " is null");
  if (memory_info<cl_mem_object_type>(state, memory, CL_MEM_TYPE) != CL_MEM_OBJECT_BUFFER)
    throw Error(Status::invalid_argument, std::string(name) + " is an image or pipe, not a buffer");
  if (memory_info<cl_context>(state, memory, CL_MEM_CONTEXT) != state.runtime.context()())
    throw Error(Status::wrong_context, std::string(name) + " is a buffer of another context than the solver's");
  if (memory_info<cl_mem_flags>(state, memory, CL_MEM_FLAGS) & forbidden)
    throw Error(Status::buffer_access,
                std::string(name) + (forbidden == CL_MEM_READ_ONLY ? " is read-only" : " is write-only"));
  const std::uint64_t there = memory_info<std::size_t>(state, memory, CL_MEM_SIZE) / element_bytes;
  if (offset > there || count > there - offset)
    throw Error(Status::buffer_too_small,
                std::string(name) + ": " + std::to_string(count) + " elements from " + std::to_string(offset) +
                    " on do not fit a buffer of " + std::to_string(there),
                {count > ~offset ? ~std::uint64_t{0} : offset + count, there});
  const cl_mem parent = memory_info<cl_mem>(state, memory, CL_MEM_ASSOCIATED_MEMOBJECT);
  const std::size_t origin = parent ? memory_info<std::size_t>(state, memory, CL_MEM_OFFSET) : 0;
  const std::size_t begin = origin + static_cast<std::size_t>(offset) * element_bytes;
  return {parent ? parent : memory, begin, begin + static_cast<std::size_t>(count) * element_bytes};
}

/// The caller's elements as the kernels want them, from the start of a buffer.
template <class T>
runtime::Buffer<T> from_start(runtime::Runtime& runtime, const char* name, cl_mem memory, std::uint64_t offset,
                              std::uint64_t count) {
  if (count == 0) return runtime.allocate<T>(name, 0);
  runtime::Buffer<T> theirs(cl::Buffer(memory, true), static_cast<std::size_t>(count));
  if (offset == 0 && !runtime.works_here()) return theirs;
  auto copied = runtime.allocate<T>(name, static_cast<std::size_t>(count));
  runtime.copy(theirs, copied, static_cast<std::size_t>(count), static_cast<std::size_t>(offset));
  if (runtime.works_here()) runtime.finish();  // what is queued would keep the calling thread from it
  return copied;
}

void check_input(State& state, const gcdt_cl_input& input, std::size_t vertex_bytes) {
  const Range vertices = checked_range(state, "gcdt_cl_input.vertices", input.vertices, input.vertex_offset,
                                       input.vertex_count, vertex_bytes, CL_MEM_WRITE_ONLY);
  const Range constraints = checked_range(state, "gcdt_cl_input.constraints", input.constraints,
                                          input.constraint_offset, input.constraint_count, 8, CL_MEM_WRITE_ONLY);
  if (vertices.meets(constraints))
    throw Error(Status::buffers_overlap, "the vertices and the constraints of gcdt_cl_input overlap");
  for (const Range& range : {vertices, constraints})
    if (state.runtime.memory().is_free(range.root, range.begin, range.end))
      throw Error(Status::buffers_overlap, "the input lies in the solver's workspace");
}

/// Waits until everything that the application ordered before is done.
void wait_for_order(State& state, cl_uint wait_count, const cl_event* wait_list) {
  runtime::Runtime& runtime = state.runtime;
  const cl_command_queue queue = state.their_queue();
  // An event that has failed is found by its own status, because not every driver ends commands that wait for it.
  for (cl_uint i = 0; wait_list && i < wait_count; ++i) {
    cl_int status = CL_QUEUED;
    runtime.call("clGetEventInfo", "the wait list", [&] {
      return clGetEventInfo(wait_list[i], CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr);
    });
    if (status < 0) runtime.fail("an event of the wait list", std::to_string(i).c_str(), status);
  }
  cl::Event marker;
  runtime.call("clEnqueueMarkerWithWaitList", "the application's queue",
               [&] { return clEnqueueMarkerWithWaitList(queue, wait_count, wait_list, &marker()); });
  runtime.call("clFlush", "the application's queue", [&] { return clFlush(queue); });
  runtime.call("clWaitForEvents", "the application's queue", [&] { return marker.wait(); });
}

void use_memory(State& state, std::shared_ptr<runtime::DeviceMemory> memory) {
  if (state.results != 0)
    throw Error(Status::in_use, std::to_string(state.results) + " results of the solver still hold memory");
  state.settle();
  state.runtime.finish();
  state.runtime.use_memory(std::move(memory));
}

}  // namespace

int32_t gcdt_cl_solver_create(cl_command_queue queue, const gcdt_solver_options* options, gcdt_solver** solver) {
  return guarded(nullptr, [&] {
    require(queue, "queue is null");
    require(solver, "solver is null");
    const gcdt_solver_options given = read_solver_options(options);
    require(!given.device, "gcdt_solver_options.device must be null: the queue has a device");
    const cl::Context context(queue_info<cl_context>(nullptr, queue, CL_QUEUE_CONTEXT), true);
    const cl::Device device(queue_info<cl_device_id>(nullptr, queue, CL_QUEUE_DEVICE), true);
    if (!runtime::usable(device)) throw Error(Status::no_device, "the queue's device has no compiler or no OpenCL 1.2");
    auto made = std::make_unique<gcdt_solver>();
    made->state = std::make_shared<State>(context, device, read_log(given.log, given.log_user),
                                          read_trace(given.trace, given.trace_user));
    made->state->their_queue = cl::CommandQueue(queue, true);
    *solver = made.release();
  });
}

int32_t gcdt_cl_triangulate(gcdt_solver* solver, const gcdt_cl_input* input, const gcdt_options* options,
                            cl_uint wait_count, const cl_event* wait_list, gcdt_result** result) {
  return guarded_call(solver, [&] {
    State& state = *solver->state;
    give_result(solver->state, result, [&] {
      require(state.their_queue() != nullptr, "the solver was not made on an application's queue");
      const gcdt_cl_input given = read_struct(input, "gcdt_cl_input");
      const Points::Type type = read_type(given.coordinate_type);
      const std::size_t words = words_per_vertex(type);
      Options wanted = read_options(options);
      if (type == Points::Type::int32 && !wanted.grid) wanted.grid = FixedGrid{};
      check_input(state, given, 8 * words);
      const InputSource source = {
          given.vertex_count, given.constraint_count, [&] {
            DeviceInput loaded;
            loaded.points = {static_cast<cl_uint>(given.vertex_count), coordinates_type(type),
                             from_start<cl_ulong>(state.runtime, "coordinates", given.vertices,
                                                  words * given.vertex_offset, words * given.vertex_count)};
            loaded.constraints = from_start<cl_uint2>(state.runtime, "constraints", given.constraints,
                                                      given.constraint_offset, given.constraint_count);
            return loaded;
          }};
      wait_for_order(state, wait_count, wait_list);
      return state.triangulate(source, wanted);
    });
  });
}

int32_t gcdt_cl_result_buffer(const gcdt_result* result, int32_t array, cl_mem* buffer) {
  return guarded_call(result, [&] {
    require(buffer, "buffer is null");
    *buffer = result->array(array).memory.handle;
  });
}

int32_t gcdt_cl_enqueue_copy(gcdt_result* result, int32_t array, cl_command_queue queue, cl_mem destination,
                             uint64_t offset, uint64_t capacity, cl_uint wait_count, const cl_event* wait_list,
                             cl_event* event) {
  return guarded_call(result, [&] {
    State& state = *result->state;
    const DeviceArray from = result->array(array);
    require(queue, "queue is null");
    if (queue_info<cl_context>(&state, queue, CL_QUEUE_CONTEXT) != state.runtime.context()())
      throw Error(Status::wrong_context, "the queue is of another context than the solver's");
    const Range to =
        checked_range(state, "destination", destination, offset, capacity, from.element_bytes, CL_MEM_READ_ONLY);
    if (capacity < from.count) throw too_small(from.count, capacity);
    if (to.root && state.runtime.memory().holds(to.root))
      throw Error(Status::buffers_overlap, "the destination lies in the solver's memory");
    cl::Event copied;
    if (from.count == 0)
      state.runtime.call("clEnqueueMarkerWithWaitList", "the application's queue",
                         [&] { return clEnqueueMarkerWithWaitList(queue, wait_count, wait_list, &copied()); });
    else
      state.runtime.call("clEnqueueCopyBuffer", "the application's queue", [&] {
        return clEnqueueCopyBuffer(queue, from.memory.handle, destination, 0,
                                   static_cast<std::size_t>(offset) * from.element_bytes,
                                   static_cast<std::size_t>(from.bytes()), wait_count, wait_list, &copied());
      });
    auto& pending = state.pending_copies;
    const auto over = [](const cl::Event& e) {
      cl_int status = CL_QUEUED;
      e.getInfo(CL_EVENT_COMMAND_EXECUTION_STATUS, &status);
      return status <= CL_COMPLETE;
    };
    pending.erase(std::remove_if(pending.begin(), pending.end(), over), pending.end());
    pending.push_back(copied);
    if (event) {
      clRetainEvent(copied());
      *event = copied();
    }
  });
}

int32_t gcdt_cl_locate(gcdt_result* result, int32_t coordinate_type, cl_mem points, uint64_t point_offset,
                       uint64_t count, cl_mem triangles, cl_mem weights, cl_uint wait_count,
                       const cl_event* wait_list) {
  return guarded_call(result, [&] {
    State& state = *result->state;
    require(state.their_queue() != nullptr, "the solver was not made on an application's queue");
    const Points::Type type = read_type(coordinate_type);
    const std::size_t words = words_per_vertex(type);
    checked_range(state, "points", points, point_offset, count, 8 * words, CL_MEM_WRITE_ONLY);
    const Range to = checked_range(state, "triangles", triangles, 0, count, 4, CL_MEM_READ_ONLY);
    const Range also = weights ? checked_range(state, "weights", weights, 0, 3 * count, 4, CL_MEM_READ_ONLY) : Range{};
    for (const Range& range : {to, also})
      if (range.root && state.runtime.memory().holds(range.root))
        throw Error(Status::buffers_overlap, "the destination lies in the solver's memory");
    wait_for_order(state, wait_count, wait_list);
    state.runtime.memory().begin_call();
    constexpr std::uint64_t chunk = Tuning::queries_at_once;
    for (std::uint64_t first = 0; first < count; first += chunk) {
      const auto part = static_cast<cl_uint>(std::min(chunk, count - first));
      const InputPoints queries = {
          part, coordinates_type(type),
          from_start<cl_ulong>(state.runtime, "queries", points, words * (point_offset + first), words * part)};
      const Located found = result->derived.locate(state.runtime, state.primitives, result->data, queries, first);
      state.runtime.copy_out(found.triangles, triangles, part, static_cast<std::size_t>(first));
      if (!weights) continue;
      const auto shares = state.runtime.allocate<cl_float>("weights of queries", std::size_t{3} * part);
      state.runtime.launch("locate", "locate_weights", runtime::over(part), part, found.triangles, found.areas, shares);
      state.runtime.copy_out(shares, weights, std::size_t{3} * part, static_cast<std::size_t>(3 * first));
    }
    state.runtime.finish();
  });
}

int32_t gcdt_cl_set_workspace(gcdt_solver* solver, cl_uint count, const cl_mem* buffers) {
  return guarded_call(solver, [&] {
    State& state = *solver->state;
    require(buffers || count == 0, "buffers is null");
    std::vector<cl::Buffer> slabs;
    for (cl_uint i = 0; i < count; ++i) {
      const std::string name = "workspace buffer " + std::to_string(i);
      require(buffers[i], (name + " is null").c_str());
      checked_range(state, name.c_str(), buffers[i], 0, 0, 1, CL_MEM_READ_ONLY);
      checked_range(state, name.c_str(), buffers[i], 0, 0, 1, CL_MEM_WRITE_ONLY);
      const auto flags = memory_info<cl_mem_flags>(state, buffers[i], CL_MEM_FLAGS);
      if (flags & (CL_MEM_HOST_NO_ACCESS | CL_MEM_HOST_READ_ONLY | CL_MEM_HOST_WRITE_ONLY))
        throw Error(Status::buffer_access, name + " must be readable and writable by the host");
      require(!memory_info<cl_mem>(state, buffers[i], CL_MEM_ASSOCIATED_MEMOBJECT),
              (name + " is a sub-buffer, of which there are no sub-buffers").c_str());
      if (std::find(buffers, buffers + i, buffers[i]) != buffers + i)
        throw Error(Status::buffers_overlap, name + " is given twice", {i});
      slabs.emplace_back(buffers[i], true);
    }
    if (count == 0)
      use_memory(state, std::make_shared<runtime::BufferPool>(state.buffer_source));
    else
      use_memory(state, std::make_shared<runtime::Workspace>(slabs));
  });
}

int32_t gcdt_cl_set_allocator(gcdt_solver* solver, const gcdt_cl_allocator* allocator) {
  return guarded_call(solver, [&] {
    runtime::BufferSource source;
    if (allocator) {
      const gcdt_cl_allocator given = read_struct(allocator, "gcdt_cl_allocator");
      require(given.allocate && given.release, "gcdt_cl_allocator.allocate or release is null");
      source.allocate = [given](cl_context context, cl_mem_flags flags, std::size_t bytes, cl_int* code) {
        return given.allocate(given.user, context, flags, bytes, code);
      };
      source.release = [given](cl_mem memory) { given.release(given.user, memory); };
    }
    use_memory(*solver->state, std::make_shared<runtime::BufferPool>(source));
    solver->state->buffer_source = std::move(source);
  });
}
