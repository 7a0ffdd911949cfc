// SPDX-License-Identifier: Apache-2.0
// For OpenCL layers that tell kernels apart by name and by the options that their programs were built with.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "layer.hpp"

namespace {

/// All of the process, under one mutex, which is also for what a layer notes of launches.
struct NamedKernels {
  std::mutex mutex;
  std::map<cl_program, std::string> options;
  std::map<cl_kernel, std::string> names;  ///< name, a space, options
};
NamedKernels& named_kernels() {
  static auto* const all = new NamedKernels;  // for good: launches may come from destructors of statics
  return *all;
}
using Lock = std::lock_guard<std::mutex>;

cl_int CL_API_CALL build_program(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                                 void(CL_CALLBACK* built)(cl_program, void*), void* data) {
  {
    const Lock lock(named_kernels().mutex);
    named_kernels().options[program] = options ? options : "";
  }
  return next->clBuildProgram(program, count, devices, options, built, data);
}

cl_kernel CL_API_CALL create_kernel(cl_program program, const char* name, cl_int* code) {
  const cl_kernel kernel = next->clCreateKernel(program, name, code);
  const Lock lock(named_kernels().mutex);
  if (kernel) named_kernels().names[kernel] = std::string(name) + " " + named_kernels().options[program];
  return kernel;
}

/// Call it from replace().
void name_kernels(cl_icd_dispatch& functions) {
  functions.clBuildProgram = build_program;
  functions.clCreateKernel = create_kernel;
}

}  // namespace
