// SPDX-License-Identifier: Apache-2.0
// Batches from and to the application's device memory. The devices of a pool may have no context in common, so both
// ways lead through host memory.
#include "api/pool.hpp"

// Its header last: opencl.hpp chooses the version of OpenCL.
#include <gcdt/gcdt_cl.h>

using namespace gcdt;
using namespace gcdt::api;

namespace {

void succeed(const char* call, cl_int code) {
  if (code != CL_SUCCESS)
    throw Error(Status::device_failed,
                std::string(call) + " in the application's queue failed with OpenCL code " + std::to_string(code), {},
                0, code);
}

/// The application's queue. The first command waits for the wait list; every call returns when its command is complete.
class TheirQueue {
 public:
  TheirQueue(cl_command_queue queue, cl_uint wait_count, const cl_event* wait_list) {
    require(queue, "queue is null");
    require(wait_list || wait_count == 0, "wait_list is null");
    queue_ = cl::CommandQueue(queue, true);
    succeed("clGetCommandQueueInfo", queue_.getInfo(CL_QUEUE_CONTEXT, &context_));
    waits_.assign(wait_list, wait_list + wait_count);
  }

  /// Elements [0, count) of the buffer.
  template <class T>
  std::vector<T> read(const char* name, cl_mem memory, std::uint64_t count, std::size_t element_bytes = sizeof(T)) {
    check(name, memory, 0, count, element_bytes, CL_MEM_HOST_NO_ACCESS | CL_MEM_HOST_WRITE_ONLY);
    std::vector<T> values(static_cast<std::size_t>(count * element_bytes / sizeof(T)));
    if (values.empty()) return values;
    succeed("clEnqueueReadBuffer", clEnqueueReadBuffer(queue_(), memory, CL_TRUE, 0, values.size() * sizeof(T),
                                                       values.data(), wait_count(), wait_list(), nullptr));
    waits_.clear();
    return values;
  }

  void write(cl_mem memory, std::uint64_t offset, std::uint64_t count, std::size_t element_bytes, const void* from) {
    if (count == 0) return;
    succeed("clEnqueueWriteBuffer",
            clEnqueueWriteBuffer(queue_(), memory, CL_TRUE, static_cast<std::size_t>(offset) * element_bytes,
                                 static_cast<std::size_t>(count) * element_bytes, from, wait_count(), wait_list(),
                                 nullptr));
    waits_.clear();
  }

  /// Throws unless there are `count` elements from `offset` on and the buffer has none of the flags `forbidden`.
  void check(const char* name, cl_mem memory, std::uint64_t offset, std::uint64_t count, std::size_t element_bytes,
             cl_mem_flags forbidden) const {
    if (!memory && count == 0) return;
    require(memory, (std::string(name) + " is null").c_str());
    if (info<cl_mem_object_type>(memory, CL_MEM_TYPE) != CL_MEM_OBJECT_BUFFER)
      throw Error(Status::invalid_argument, std::string(name) + " is an image or pipe, not a buffer");
    if (info<cl_context>(memory, CL_MEM_CONTEXT) != context_())
      throw Error(Status::wrong_context, std::string(name) + " is a buffer of another context than the queue's");
    if (info<cl_mem_flags>(memory, CL_MEM_FLAGS) & forbidden)
      throw Error(Status::buffer_access, std::string(name) + " is closed to the host");
    const std::uint64_t there = info<std::size_t>(memory, CL_MEM_SIZE) / element_bytes;
    if (offset > there || count > there - offset)
      throw Error(Status::buffer_too_small,
                  std::string(name) + ": " + std::to_string(count) + " elements from " + std::to_string(offset) +
                      " on do not fit a buffer of " + std::to_string(there),
                  {count > ~offset ? ~std::uint64_t{0} : offset + count, there});
  }

 private:
  template <class T>
  static T info(cl_mem memory, cl_mem_info what) {
    T value = {};
    succeed("clGetMemObjectInfo", clGetMemObjectInfo(memory, what, sizeof value, &value, nullptr));
    return value;
  }
  cl_uint wait_count() const { return static_cast<cl_uint>(waits_.size()); }
  const cl_event* wait_list() const { return waits_.empty() ? nullptr : waits_.data(); }

  cl::CommandQueue queue_;
  cl::Context context_;
  std::vector<cl_event> waits_;
};

/// A batch in host memory, as it was in the application's buffers.
struct HostBatch {
  std::vector<cl_ulong> vertices;
  std::vector<std::uint64_t> vertex_offsets, constraint_offsets;
  std::vector<std::uint32_t> constraints;

  HostBatch(const gcdt_cl_batch_input& given, TheirQueue& queue) {
    if (given.problem_count == 0) return;
    if (given.problem_count > most_problems)
      throw Error(Status::invalid_argument,
                  std::to_string(given.problem_count) + " problems; at most 2^30 fit a batch");
    const std::size_t vertex_bytes = 8 * words_per_vertex(read_type(given.coordinate_type));
    require(given.vertex_offsets, "gcdt_cl_batch_input.vertex_offsets is null");
    require(given.constraint_offsets || !given.constraints, "gcdt_cl_batch_input.constraint_offsets is null");
    vertex_offsets =
        queue.read<std::uint64_t>("gcdt_cl_batch_input.vertex_offsets", given.vertex_offsets, given.problem_count + 1);
    vertices =
        queue.read<cl_ulong>("gcdt_cl_batch_input.vertices", given.vertices, vertex_offsets.back(), vertex_bytes);
    if (!given.constraint_offsets) return;
    constraint_offsets = queue.read<std::uint64_t>("gcdt_cl_batch_input.constraint_offsets", given.constraint_offsets,
                                                   given.problem_count + 1);
    constraints = queue.read<std::uint32_t>("gcdt_cl_batch_input.constraints", given.constraints,
                                            constraint_offsets.back(), sizeof(Constraint));
  }

  gcdt_batch_input view(const gcdt_cl_batch_input& given) const {
    gcdt_batch_input input = GCDT_BATCH_INPUT_INIT;
    input.coordinate_type = given.coordinate_type;
    input.problem_count = given.problem_count;
    input.vertices = vertices.data(), input.vertex_offsets = vertex_offsets.data();
    input.constraints = constraints.data();
    input.constraint_offsets = constraint_offsets.empty() ? nullptr : constraint_offsets.data();
    if (constraint_offsets.empty()) input.constraints = nullptr;
    return input;
  }
};

}  // namespace

int32_t gcdt_cl_pool_triangulate(gcdt_pool* pool, cl_command_queue queue, const gcdt_cl_batch_input* input,
                                 const gcdt_options* options, cl_uint wait_count, const cl_event* wait_list,
                                 gcdt_batch** batch) {
  std::optional<HostBatch> read;
  gcdt_batch_input given = GCDT_BATCH_INPUT_INIT;
  const std::int32_t status = guarded(nullptr, [&] {
    const gcdt_cl_batch_input theirs = read_struct(input, "gcdt_cl_batch_input");
    TheirQueue reads(queue, wait_count, wait_list);
    read.emplace(theirs, reads);
    given = read->view(theirs);
  });
  return status == GCDT_OK ? gcdt_pool_triangulate(pool, &given, options, batch) : status;
}

int32_t gcdt_cl_batch_copy(const gcdt_batch* batch, int32_t array, cl_command_queue queue, cl_mem destination,
                           uint64_t offset, uint64_t capacity, cl_mem offsets, cl_uint wait_count,
                           const cl_event* wait_list) {
  return guarded(nullptr, [&] {
    require(batch, "batch is null");
    TheirQueue writes(queue, wait_count, wait_list);
    const std::size_t bytes = gcdt_element_bytes(array);
    const std::size_t problems = batch->made.places.size();
    std::vector<std::uint64_t> begins(problems + 1);
    const auto copy = [&](void* to, std::uint64_t room) { copy_batch(*batch, array, to, room, begins.data()); };
    copy(nullptr, 0);
    constexpr cl_mem_flags closed = CL_MEM_HOST_NO_ACCESS | CL_MEM_HOST_READ_ONLY;
    if (destination) {
      writes.check("destination", destination, offset, capacity, bytes, closed);
      if (capacity < begins.back()) throw too_small(begins.back(), capacity);
    }
    if (offsets) writes.check("offsets", offsets, 0, begins.size(), sizeof begins[0], closed);
    if (destination) {
      std::vector<unsigned char> all(begins.back() * bytes);
      copy(all.data(), begins.back());
      writes.write(destination, offset, begins.back(), bytes, all.data());
    }
    if (offsets) writes.write(offsets, 0, begins.size(), sizeof begins[0], begins.data());
  });
}
