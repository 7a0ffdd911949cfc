// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer that puts guards before and behind every buffer, and fills buffers with what nobody expects there. A
// buffer is a part, by clCreateSubBuffer, of a larger one that the layer has made: guard, buffer, guard. It looks at
// the guards when the buffer is released, and when a test asks it to (guard_layer.hpp).
//
// Buffers over memory of the caller's (CL_MEM_USE_HOST_PTR) have no guards: their bytes are where they are. The
// library makes none.
#include "guard_layer.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <mutex>
#include <utility>

#include "layer.hpp"

namespace {

// A multiple of every device's alignment of sub-buffers.
constexpr size_t guard_bytes = 4096;

struct Guarded {
  cl_mem whole;
  size_t bytes;
};

struct State {
  std::recursive_mutex mutex;
  std::map<cl_mem, Guarded> buffers;  ///< by the handle that the program has
  std::map<cl_command_queue, cl_context> queues;
  std::vector<std::string> wrong;
};
State& state() {
  static auto* const all = new State;  // for good: calls may come from destructors of statics
  return *all;
}

std::vector<std::string> check_all();

}  // namespace

extern "C" gcdt::test::Guards* gcdt_test_guards() {
  static auto* const all = new gcdt::test::Guards;
  all->check = check_all;
  return all;
}

namespace {

using Lock = std::lock_guard<std::recursive_mutex>;

/// Bytes of a buffer on a queue of the layer's own, after all that other queues of its context have to do.
bool read(cl_mem buffer, size_t offset, std::vector<unsigned char>& to) {
  cl_context context = nullptr;
  cl_device_id device = nullptr;
  if (next->clGetMemObjectInfo(buffer, CL_MEM_CONTEXT, sizeof context, &context, nullptr) != CL_SUCCESS) return false;
  for (const auto& [queue, of] : state().queues)
    if (of == context) next->clFinish(queue);
  size_t bytes = 0;
  next->clGetContextInfo(context, CL_CONTEXT_DEVICES, 0, nullptr, &bytes);
  std::vector<cl_device_id> devices(bytes / sizeof device);
  if (next->clGetContextInfo(context, CL_CONTEXT_DEVICES, bytes, devices.data(), nullptr) != CL_SUCCESS) return false;
  cl_int code = CL_SUCCESS;
  const cl_command_queue queue = next->clCreateCommandQueue(context, devices.at(0), 0, &code);
  if (!queue) return false;
  code = next->clEnqueueReadBuffer(queue, buffer, CL_TRUE, offset, to.size(), to.data(), 0, nullptr, nullptr);
  next->clReleaseCommandQueue(queue);
  return code == CL_SUCCESS;
}

void look(const Guarded& guarded) {
  ++gcdt_test_guards()->looks;
  std::vector<unsigned char> guard(guard_bytes);
  for (const bool behind : {false, true}) {
    const std::string place =
        std::string(behind ? "behind" : "before") + " a buffer of " + std::to_string(guarded.bytes) + " bytes";
    if (!read(guarded.whole, behind ? guard_bytes + guarded.bytes : 0, guard)) {
      state().wrong.push_back("cannot read " + place);
      continue;
    }
    // Each guard has its own pattern, whatever the poison was since.
    for (size_t i = 0; i < guard_bytes; ++i)
      if (guard[i] != static_cast<unsigned char>(0xC3 ^ i)) {
        const size_t distance = behind ? i : guard_bytes - i;
        state().wrong.push_back(std::to_string(distance) + " bytes " + place + " was written");
        break;
      }
  }
}

std::vector<std::string> check_all() {
  const Lock lock(state().mutex);
  for (const auto& [handle, guarded] : state().buffers) look(guarded);
  return std::exchange(state().wrong, {});
}

/// Guard, what the buffer is to hold, guard.
std::vector<unsigned char> filled(size_t bytes, const void* contents) {
  std::vector<unsigned char> all(bytes + 2 * guard_bytes, gcdt_test_guards()->poison);
  for (size_t i = 0; i < guard_bytes; ++i) all[i] = all[guard_bytes + bytes + i] = static_cast<unsigned char>(0xC3 ^ i);
  if (contents) std::memcpy(all.data() + guard_bytes, contents, bytes);
  return all;
}

cl_mem CL_API_CALL create_buffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* code) {
  const bool usual = size > 0 && (flags & CL_MEM_USE_HOST_PTR) == 0 && ((flags & CL_MEM_COPY_HOST_PTR) != 0) == !!host;
  if (!usual) return next->clCreateBuffer(context, flags, size, host, code);
  std::vector<unsigned char> bytes = filled(size, host);
  const cl_mem whole = next->clCreateBuffer(context, flags | CL_MEM_COPY_HOST_PTR, bytes.size(), bytes.data(), code);
  if (!whole) return nullptr;
  const cl_buffer_region region = {guard_bytes, size};
  const cl_mem part = next->clCreateSubBuffer(whole, 0, CL_BUFFER_CREATE_TYPE_REGION, &region, code);
  if (!part) {
    next->clReleaseMemObject(whole);
    return nullptr;
  }
  const Lock lock(state().mutex);
  state().buffers[part] = {whole, size};
  ++gcdt_test_guards()->buffers;
  return part;
}

// Of a whole buffer, since a part has no parts.
cl_mem CL_API_CALL create_sub_buffer(cl_mem of, cl_mem_flags flags, cl_buffer_create_type type, const void* info,
                                     cl_int* code) {
  const Lock lock(state().mutex);
  const auto found = state().buffers.find(of);
  if (found == state().buffers.end() || !info || type != CL_BUFFER_CREATE_TYPE_REGION)
    return next->clCreateSubBuffer(of, flags, type, info, code);
  cl_buffer_region region;
  std::memcpy(&region, info, sizeof region);
  if (region.origin > found->second.bytes || region.size > found->second.bytes - region.origin) {
    if (code) *code = CL_INVALID_VALUE;
    return nullptr;
  }
  region.origin += guard_bytes;
  return next->clCreateSubBuffer(found->second.whole, flags, type, &region, code);
}

cl_int CL_API_CALL release_buffer(cl_mem handle) {
  const Lock lock(state().mutex);
  const auto found = state().buffers.find(handle);
  if (found == state().buffers.end()) return next->clReleaseMemObject(handle);
  cl_uint references = 0;
  next->clGetMemObjectInfo(handle, CL_MEM_REFERENCE_COUNT, sizeof references, &references, nullptr);
  if (references != 1) return next->clReleaseMemObject(handle);
  look(found->second);
  const cl_mem whole = found->second.whole;
  state().buffers.erase(found);
  const cl_int code = next->clReleaseMemObject(handle);
  next->clReleaseMemObject(whole);
  return code;
}

// To programs a guarded buffer is a part of nothing, and its parts are parts of it.
cl_int CL_API_CALL memory_info(cl_mem handle, cl_mem_info name, size_t size, void* value, size_t* needed) {
  const cl_int code = next->clGetMemObjectInfo(handle, name, size, value, needed);
  if (code != CL_SUCCESS || !value) return code;
  const Lock lock(state().mutex);
  const bool guarded = state().buffers.count(handle) > 0;
  if (name == CL_MEM_ASSOCIATED_MEMOBJECT) {
    cl_mem parent = nullptr;
    std::memcpy(&parent, value, sizeof parent);
    for (const auto& [part, of] : state().buffers)
      if (of.whole == parent) parent = part;
    if (guarded) parent = nullptr;
    std::memcpy(value, &parent, sizeof parent);
  }
  if (name == CL_MEM_OFFSET) {
    cl_mem parent = nullptr;
    next->clGetMemObjectInfo(handle, CL_MEM_ASSOCIATED_MEMOBJECT, sizeof parent, &parent, nullptr);
    const bool part = std::any_of(state().buffers.begin(), state().buffers.end(),
                                  [&](const auto& of) { return of.second.whole == parent; });
    size_t offset;
    std::memcpy(&offset, value, sizeof offset);
    offset -= part ? guard_bytes : 0;
    std::memcpy(value, &offset, sizeof offset);
  }
  return code;
}

cl_command_queue CL_API_CALL create_queue(cl_context context, cl_device_id device,
                                          cl_command_queue_properties properties, cl_int* code) {
  const cl_command_queue queue = next->clCreateCommandQueue(context, device, properties, code);
  const Lock lock(state().mutex);
  if (queue) state().queues[queue] = context;
  return queue;
}

cl_int CL_API_CALL release_queue(cl_command_queue queue) {
  const Lock lock(state().mutex);
  cl_uint references = 0;
  next->clGetCommandQueueInfo(queue, CL_QUEUE_REFERENCE_COUNT, sizeof references, &references, nullptr);
  if (references == 1) state().queues.erase(queue);
  return next->clReleaseCommandQueue(queue);
}

void replace(cl_icd_dispatch& functions) {
  functions.clCreateBuffer = create_buffer;
  functions.clCreateSubBuffer = create_sub_buffer;
  functions.clReleaseMemObject = release_buffer;
  functions.clGetMemObjectInfo = memory_info;
  functions.clCreateCommandQueue = create_queue;
  functions.clReleaseCommandQueue = release_queue;
}

}  // namespace
