// SPDX-License-Identifier: Apache-2.0
#include "rates.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace gcdt::bench {

namespace {

constexpr int repetitions = 7;  // the median of them counts
constexpr int launches = 200;   // in a row

const char* const program_source =
    "__kernel void copy(uint count, __global const uint4* from, __global uint4* to) {\n"
    "  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) to[i] = from[i];\n"
    "}\n"
    "__kernel void nothing(__global uint* to) { if (get_global_id(0) == 0) to[0] = 1; }\n";

void require(cl_int code) {
  if (code != CL_SUCCESS) throw std::runtime_error("OpenCL error " + std::to_string(code));
}

std::string text(cl_device_id device, cl_device_info what) {
  char value[1024] = {};
  clGetDeviceInfo(device, what, sizeof value - 1, value, nullptr);
  return value;
}

/// Milliseconds of `step`, which must wait for the device: the median after one run that does not count.
template <class Step>
double median_ms(Step&& step) {
  std::vector<double> ms;
  for (int i = 0; i <= repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    step();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (i > 0) ms.push_back(took.count());
  }
  std::sort(ms.begin(), ms.end());
  return ms[ms.size() / 2];
}

}  // namespace

cl_device_id opencl_device(const DeviceInfo& wanted) {
  cl_uint count = 0;
  clGetPlatformIDs(0, nullptr, &count);
  std::vector<cl_platform_id> platforms(count);
  clGetPlatformIDs(count, platforms.data(), nullptr);
  for (cl_platform_id platform : platforms) {
    cl_uint devices = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &devices) != CL_SUCCESS) continue;
    std::vector<cl_device_id> all(devices);
    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, devices, all.data(), nullptr);
    for (cl_device_id device : all)
      if (text(device, CL_DEVICE_NAME) == wanted.name && text(device, CL_DRIVER_VERSION) == wanted.driver)
        return device;
  }
  return nullptr;
}

void context_and_queue(const DeviceInfo& info) {
  cl_device_id device = opencl_device(info);
  cl_int code = CL_SUCCESS;
  cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &code);
  require(code);
  cl_command_queue queue = clCreateCommandQueue(context, device, 0, &code);
  require(code);
  clReleaseCommandQueue(queue);
  clReleaseContext(context);
}

Rates measure_rates(const DeviceInfo& info, std::size_t bytes) {
  Rates rates;
  cl_device_id device = opencl_device(info);
  if (!device) return rates;
  cl_int code = CL_SUCCESS;
  cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &code);
  require(code);
  cl_command_queue queue = clCreateCommandQueue(context, device, 0, &code);
  require(code);
  cl_program program = clCreateProgramWithSource(context, 1, const_cast<const char**>(&program_source), nullptr, &code);
  require(code);
  require(clBuildProgram(program, 1, &device, "", nullptr, nullptr));
  cl_kernel copy = clCreateKernel(program, "copy", &code);
  require(code);
  cl_kernel nothing = clCreateKernel(program, "nothing", &code);
  require(code);
  cl_mem from = clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, nullptr, &code);
  require(code);
  cl_mem to = clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, nullptr, &code);
  require(code);
  std::vector<char> host(bytes, 1);
  cl_mem pinned = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes, nullptr, &code);
  require(code);
  void* mapped =
      clEnqueueMapBuffer(queue, pinned, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes, 0, nullptr, nullptr, &code);
  require(code);
  std::fill_n(static_cast<char*>(mapped), bytes, 1);

  const auto gb_s = [&](double times, double ms) { return times * static_cast<double>(bytes) / (ms * 1e6); };
  const auto write = [&](const void* data) {
    return gb_s(1, median_ms([&] {
                  require(clEnqueueWriteBuffer(queue, from, CL_TRUE, 0, bytes, data, 0, nullptr, nullptr));
                }));
  };
  const auto read = [&](void* data) {
    return gb_s(
        1, median_ms([&] { require(clEnqueueReadBuffer(queue, to, CL_TRUE, 0, bytes, data, 0, nullptr, nullptr)); }));
  };
  rates.write_gb_s = write(host.data());
  rates.pinned_write_gb_s = write(mapped);
  constexpr int copies = 10;  // in a row, so that the launch does not count
  rates.buffer_copy_gb_s = gb_s(2 * copies, median_ms([&] {
                                  for (int i = 0; i < copies; ++i)
                                    require(clEnqueueCopyBuffer(queue, from, to, 0, 0, bytes, 0, nullptr, nullptr));
                                  require(clFinish(queue));
                                }));
  const cl_uint count = static_cast<cl_uint>(bytes / 16);
  require(clSetKernelArg(copy, 0, sizeof count, &count));
  require(clSetKernelArg(copy, 1, sizeof from, &from));
  require(clSetKernelArg(copy, 2, sizeof to, &to));
  const std::size_t local = std::min<std::size_t>(256, info.largest_work_group);
  for (const std::size_t items : {std::size_t{count}, std::size_t{count} / 4, std::size_t{info.compute_units} * 2048}) {
    const std::size_t global = std::max<std::size_t>(items / local, 1) * local;
    const double ms = median_ms([&] {
      for (int i = 0; i < copies; ++i)
        require(clEnqueueNDRangeKernel(queue, copy, 1, nullptr, &global, &local, 0, nullptr, nullptr));
      require(clFinish(queue));
    });
    rates.copy_gb_s = std::max(rates.copy_gb_s, gb_s(2 * copies, ms));
  }
  rates.read_gb_s = read(host.data());
  rates.pinned_read_gb_s = read(mapped);

  require(clSetKernelArg(nothing, 0, sizeof to, &to));
  cl_uint word = 0;
  const auto launch = [&] {
    require(clEnqueueNDRangeKernel(queue, nothing, 1, nullptr, &local, &local, 0, nullptr, nullptr));
  };
  rates.launch_us = 1000.0 / launches * median_ms([&] {
                      for (int i = 0; i < launches; ++i) launch();
                      require(clFinish(queue));
                    });
  rates.launch_read_us =
      1000.0 / launches * median_ms([&] {
        for (int i = 0; i < launches; ++i) {
          launch();
          require(clEnqueueReadBuffer(queue, to, CL_TRUE, 0, sizeof word, &word, 0, nullptr, nullptr));
        }
      });

  clEnqueueUnmapMemObject(queue, pinned, mapped, 0, nullptr, nullptr);
  clFinish(queue);
  for (cl_mem memory : {from, to, pinned}) clReleaseMemObject(memory);
  clReleaseKernel(copy);
  clReleaseKernel(nothing);
  clReleaseProgram(program);
  clReleaseCommandQueue(queue);
  clReleaseContext(context);
  return rates;
}

}  // namespace gcdt::bench
