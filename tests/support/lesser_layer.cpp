// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer that pretends that devices have less, as GCDT_LESSER says in words between blanks: "extensions", no
// 64-bit atomics, fp64 nor sub-groups; "buffer", no buffer above 128 MB; "local", 32 KB of local memory; "group=N", no
// work-group of more than N. What goes beyond them fails, as it would there.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>

#include "layer.hpp"

namespace {

constexpr cl_ulong most_bytes = 128ull << 20, most_local = 32ull << 10;

bool pretends(const char* word) {
  const char* words = std::getenv("GCDT_LESSER");
  return words && (" " + std::string(words) + " ").find(" " + std::string(word) + " ") != std::string::npos;
}

/// 0: as it is.
size_t largest_group() {
  const char* words = std::getenv("GCDT_LESSER");
  const char* at = words ? std::strstr(words, "group=") : nullptr;
  return at ? static_cast<size_t>(std::atol(at + 6)) : 0;
}

cl_int CL_API_CALL device_info(cl_device_id device, cl_device_info name, size_t size, void* value, size_t* needed) {
  const cl_int code = next->clGetDeviceInfo(device, name, size, value, needed);
  if (code != CL_SUCCESS || !value) return code;
  const auto limit = [&](auto least) {
    decltype(least) given;
    std::memcpy(&given, value, sizeof given);
    given = std::min(given, least);
    std::memcpy(value, &given, sizeof given);
  };
  if (name == CL_DEVICE_EXTENSIONS && pretends("extensions")) {
    char* const text = static_cast<char*>(value);
    for (const char* word :
         {"cl_khr_int64_base_atomics", "cl_khr_int64_extended_atomics", "cl_khr_fp64", "cl_khr_subgroups"})
      for (char* at = text; (at = std::strstr(at, word));) std::memset(at, ' ', std::strlen(word));
  }
  if (name == CL_DEVICE_DOUBLE_FP_CONFIG && pretends("extensions")) limit(cl_device_fp_config{0});
  if (name == CL_DEVICE_MAX_MEM_ALLOC_SIZE && pretends("buffer")) limit(most_bytes);
  if (name == CL_DEVICE_LOCAL_MEM_SIZE && pretends("local")) limit(most_local);
  if (name == CL_DEVICE_MAX_WORK_GROUP_SIZE && largest_group() > 0) limit(largest_group());
  return code;
}

cl_int CL_API_CALL group_info(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info name, size_t size,
                              void* value, size_t* needed) {
  const cl_int code = next->clGetKernelWorkGroupInfo(kernel, device, name, size, value, needed);
  if (code != CL_SUCCESS || !value || name != CL_KERNEL_WORK_GROUP_SIZE || largest_group() == 0) return code;
  size_t given;
  std::memcpy(&given, value, sizeof given);
  given = std::min(given, largest_group());
  std::memcpy(value, &given, sizeof given);
  return code;
}

cl_mem CL_API_CALL create_buffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* code) {
  if (!pretends("buffer") || size <= most_bytes) return next->clCreateBuffer(context, flags, size, host, code);
  if (code) *code = CL_INVALID_BUFFER_SIZE;
  return nullptr;
}

cl_int CL_API_CALL enqueue(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                           const size_t* global, const size_t* local, cl_uint waits, const cl_event* events,
                           cl_event* event) {
  if (largest_group() > 0 && (!local || *local > largest_group())) return CL_INVALID_WORK_GROUP_SIZE;
  cl_device_id device = nullptr;
  cl_ulong used = 0;
  if (pretends("local")) {
    if (next->clGetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof device, &device, nullptr) != CL_SUCCESS ||
        next->clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_LOCAL_MEM_SIZE, sizeof used, &used, nullptr) !=
            CL_SUCCESS)
      std::abort();
    if (used > most_local) return CL_OUT_OF_RESOURCES;
  }
  return next->clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, waits, events, event);
}

void replace(cl_icd_dispatch& functions) {
  functions.clGetDeviceInfo = device_info;
  functions.clGetKernelWorkGroupInfo = group_info;
  functions.clCreateBuffer = create_buffer;
  functions.clEnqueueNDRangeKernel = enqueue;
}

}  // namespace
