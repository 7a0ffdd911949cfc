// SPDX-License-Identifier: Apache-2.0
// What OpenCL objects say of themselves. The bindings' own getInfo<NAME>() leaves a number as memory had it where the
// call fails; here it is 0, and a text is empty.
#pragma once

#include "device/device_memory.hpp"

namespace gcdt::runtime {

template <cl_device_info name>
auto told(const cl::Device& device) {
  typename cl::detail::param_traits<cl::detail::cl_device_info, name>::param_type value{};
  device.getInfo(name, &value);
  return value;
}

/// Of the platform that the device names, if it names one.
inline std::string platform_name(const cl::Device& device) {
  std::string name;
  if (const cl_platform_id platform = told<CL_DEVICE_PLATFORM>(device))
    cl::Platform(platform).getInfo(CL_PLATFORM_NAME, &name);
  return name;
}

inline std::size_t size_of(const cl::Buffer& buffer) {
  std::size_t bytes = 0;
  buffer.getInfo(CL_MEM_SIZE, &bytes);
  return bytes;
}

}  // namespace gcdt::runtime
