// SPDX-License-Identifier: Apache-2.0
#include "device/shared_memory.hpp"

#include <memory>

namespace gcdt::runtime {

// Where the host has kernels; and weak symbols, which objects of Windows and of macOS have otherwise.
#if defined(GCDT_HOST_KERNELS) && !defined(__APPLE__)

// Of OpenCL 2.0, which the headers are not asked for. Weak: the loader may be of 1.2.
extern "C" {
__attribute__((weak)) void* clSVMAlloc(cl_context context, cl_bitfield flags, size_t bytes, cl_uint alignment);
__attribute__((weak)) void clSVMFree(cl_context context, void* memory);
}

namespace {

constexpr cl_device_info svm_capabilities = 0x1053;  // CL_DEVICE_SVM_CAPABILITIES
constexpr cl_bitfield fine_grain_buffer = 1 << 1;    // CL_DEVICE_SVM_FINE_GRAIN_BUFFER
constexpr cl_bitfield fine_grain = 1 << 10;          // CL_MEM_SVM_FINE_GRAIN_BUFFER

// Not a reference to the context: the buffer has one, and after a failed call may live until its last command is done,
// longer than all that its owner held.
struct Shared {
  cl_context context;
  void* memory;
};

void CL_CALLBACK give_back(cl_mem, void* given) {
  const std::unique_ptr<Shared> shared(static_cast<Shared*>(given));
  clSVMFree(shared->context, shared->memory);
}

}  // namespace

bool shares_memory(const cl::Device& device) {
  cl_bitfield capabilities = 0;
  return clSVMAlloc && clSVMFree &&
         clGetDeviceInfo(device(), svm_capabilities, sizeof capabilities, &capabilities, nullptr) == CL_SUCCESS &&
         (capabilities & fine_grain_buffer) != 0;
}

cl_int make_shared_buffer(const cl::Context& context, std::size_t bytes, cl::Buffer& buffer, void*& here) {
  void* const memory = clSVMAlloc(context(), CL_MEM_READ_WRITE | fine_grain, bytes, 0);
  if (!memory) return CL_MEM_OBJECT_ALLOCATION_FAILURE;
  cl_int code;
  cl::Buffer made(context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, memory, &code);
  if (code != CL_SUCCESS) {
    clSVMFree(context(), memory);
    return code;
  }
  auto shared = std::make_unique<Shared>(Shared{context(), memory});
  code = clSetMemObjectDestructorCallback(made(), give_back, shared.get());
  if (code != CL_SUCCESS) {
    made = cl::Buffer();
    clSVMFree(context(), memory);
    return code;
  }
  shared.release();
  buffer = std::move(made), here = memory;
  return CL_SUCCESS;
}

#else

bool shares_memory(const cl::Device&) { return false; }
cl_int make_shared_buffer(const cl::Context&, std::size_t, cl::Buffer&, void*&) { return CL_INVALID_OPERATION; }

#endif

}  // namespace gcdt::runtime
