// SPDX-License-Identifier: Apache-2.0
// What OpenCL objects say of themselves. The bindings' own getInfo<NAME>() leaves a number as memory had it where the
// call fails.
#pragma once

#include <gcdt/types.hpp>

#include <string>

#include "device/device_memory.hpp"

namespace gcdt::runtime {

/// A number that the device is used by. Throws device_failed if the device does not tell.
template <cl_device_info name>
auto told(const cl::Device& device) {
  typename cl::detail::param_traits<cl::detail::cl_device_info, name>::param_type value{};
  const cl_int code = device.getInfo(name, &value);
  if (code != CL_SUCCESS)
    throw Error(Status::device_failed,
                "OpenCL: clGetDeviceInfo (" + std::to_string(name) + ") failed with " + std::to_string(code), {}, 0,
                code);
  return value;
}

/// Of the platform that the device names; empty if either does not tell.
inline std::string platform_name(const cl::Device& device) {
  cl_platform_id platform = nullptr;
  std::string name;
  if (device.getInfo(CL_DEVICE_PLATFORM, &platform) == CL_SUCCESS && platform)
    cl::Platform(platform).getInfo(CL_PLATFORM_NAME, &name);
  return name;
}

/// 0 if it does not tell.
inline std::size_t size_of(const cl::Buffer& buffer) {
  std::size_t bytes = 0;
  return buffer.getInfo(CL_MEM_SIZE, &bytes) == CL_SUCCESS ? bytes : 0;
}

}  // namespace gcdt::runtime
