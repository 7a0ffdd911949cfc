// SPDX-License-Identifier: Apache-2.0
// Each device of the library is found again as an OpenCL device, and no other in its place.
#include "rates.hpp"

#include <cstdio>
#include <string>

#include "mesa.hpp"

using namespace gcdt;
using namespace gcdt::bench;

namespace {

int failures = 0;

void expect(bool holds, const std::string& name, const char* what) {
  if (holds) return;
  std::printf("%s: %s\n", name.c_str(), what);
  ++failures;
}

std::string text(cl_device_id device, cl_device_info what) {
  char value[1024] = {};
  clGetDeviceInfo(device, what, sizeof value - 1, value, nullptr);
  return value;
}

template <class T>
T number(cl_device_id device, cl_device_info what) {
  T value = 0;
  clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
  return value;
}

void found_again(const DeviceInfo& info) {
  cl_device_id device = opencl_device(info);
  expect(device != nullptr, info.name, "not found");
  if (!device) return;
  expect(text(device, CL_DEVICE_NAME) == info.name, info.name, "another device");
  expect(text(device, CL_DRIVER_VERSION) == info.driver, info.name, "another driver");
  expect(number<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS) == info.compute_units, info.name, "other compute units");
  expect(number<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE) == info.memory_bytes, info.name, "other memory");
  DeviceInfo other = info;
  other.name += " no more";
  expect(opencl_device(other) == nullptr, info.name, "found by another name");
  other = info;
  other.driver += ".1";
  expect(opencl_device(other) == nullptr, info.name, "found with another driver");
}

}  // namespace

int main() try {
  test::ask_for_mesa();
  const std::vector<DeviceInfo> all = devices();
  expect(all.size() >= 2, "devices", "the test needs two (pocl-opencl-icd, mesa-opencl-icd)");
  for (const DeviceInfo& info : all) found_again(info);
  const Rates rates = measure_rates(all.at(0), 1 << 20);
  for (const double rate : {rates.copy_gb_s, rates.buffer_copy_gb_s, rates.write_gb_s, rates.read_gb_s,
                            rates.pinned_write_gb_s, rates.pinned_read_gb_s, rates.launch_us, rates.launch_read_us})
    expect(rate > 0, all[0].name, "a rate that was not measured");
  return failures;
} catch (const std::exception& error) {
  std::printf("%s\n", error.what());
  return 1;
}
