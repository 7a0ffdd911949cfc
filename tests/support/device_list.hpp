// SPDX-License-Identifier: Apache-2.0
// The OpenCL devices that tests run on.
#pragma once

#include <stdexcept>
#include <vector>

#include "device/runtime.hpp"
#include "mesa.hpp"

namespace gcdt::test {

/// All devices, Mesa's software one included where it is installed. Cases are registered for each before main(). Throws
/// if there is one device alone: "on every device" would say nothing then.
inline std::vector<cl::Device> every_device() {
  ask_for_mesa();
  std::vector<cl::Device> all = runtime::all_devices();
  if (all.size() < 2)
    throw std::runtime_error("the tests need two OpenCL drivers (Debian and Ubuntu: pocl-opencl-icd, mesa-opencl-icd)");
  return all;
}

/// The device whose work-items are that, by itself: PoCL's are threads, llvmpipe's lanes. Throws if it is missing.
inline cl::Device device_of(DeviceKind really) {
  static const std::vector<cl::Device> all = every_device();
  for (const cl::Device& device : all)
    if (runtime::kind_of(runtime::describe(device), {}) == really) return device;
  throw Error(Status::no_device, "a device is missing: install pocl-opencl-icd and mesa-opencl-icd");
}

}  // namespace gcdt::test
