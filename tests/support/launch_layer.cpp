// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer (the loader takes it from OPENCL_LAYERS) that notes which kernels a process launches, and with which
// options their programs were built: a line each, in a file of the process in the folder GCDT_LAUNCHED (launched_test).
#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "layer.hpp"

namespace {

struct Notes {
  std::mutex mutex;
  std::map<cl_program, std::string> options;
  std::map<cl_kernel, std::string> lines;
  std::set<std::string> written;
};
Notes& notes() {
  static auto* const all = new Notes;  // for good: launches may come from destructors of statics
  return *all;
}

// At once, and by one call: a process may end anywhere.
void write_line(const std::string& line) {
  const char* folder = std::getenv("GCDT_LAUNCHED");
  if (!folder) return;
  const std::string path = std::string(folder) + "/" + std::to_string(getpid());
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  const bool good = file >= 0 && write(file, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  if (file >= 0) close(file);
  if (!good) std::abort();
}

cl_int CL_API_CALL build_program(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                                 void(CL_CALLBACK* built)(cl_program, void*), void* data) {
  {
    const std::lock_guard<std::mutex> lock(notes().mutex);
    notes().options[program] = options ? options : "";
  }
  return next->clBuildProgram(program, count, devices, options, built, data);
}

cl_kernel CL_API_CALL create_kernel(cl_program program, const char* name, cl_int* code) {
  const cl_kernel kernel = next->clCreateKernel(program, name, code);
  if (kernel) {
    const std::lock_guard<std::mutex> lock(notes().mutex);
    notes().lines[kernel] = std::string(name) + " " + notes().options[program] + "\n";
  }
  return kernel;
}

cl_int CL_API_CALL enqueue(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                           const size_t* global, const size_t* local, cl_uint waits, const cl_event* events,
                           cl_event* event) {
  const cl_int code =
      next->clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, waits, events, event);
  if (code == CL_SUCCESS) {
    const std::lock_guard<std::mutex> lock(notes().mutex);
    const std::string& line = notes().lines[kernel];
    if (notes().written.insert(line).second) write_line(line);
  }
  return code;
}

void replace(cl_icd_dispatch& functions) {
  functions.clBuildProgram = build_program;
  functions.clCreateKernel = create_kernel;
  functions.clEnqueueNDRangeKernel = enqueue;
}

}  // namespace
