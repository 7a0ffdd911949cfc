// SPDX-License-Identifier: Apache-2.0
// What the device can do at most: the measures that times are held against.
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <gcdt/gcdt.hpp>

namespace gcdt::bench {

struct Rates {
  double copy_gb_s = 0;                                ///< a kernel that copies, bytes read + written; 1e9 bytes
  double buffer_copy_gb_s = 0;                         ///< clEnqueueCopyBuffer, likewise
  double write_gb_s = 0, read_gb_s = 0;                ///< between the device and pageable host memory
  double pinned_write_gb_s = 0, pinned_read_gb_s = 0;  ///< and memory that the driver pinned
  double launch_us = 0;                                ///< one launch of an empty kernel in a long row of them
  double launch_read_us = 0;                           ///< one launch and a blocking read of 4 bytes
};

/// Measured on a queue of its own on the OpenCL device that is `device`; `bytes` a buffer. All zero if it
/// cannot be found again.
Rates measure_rates(const DeviceInfo& device, std::size_t bytes);

/// The OpenCL device that is `device`, or null.
cl_device_id opencl_device(const DeviceInfo& device);

/// What a program that uses OpenCL pays at least: makes a context and a queue, and releases them.
void context_and_queue(const DeviceInfo& device);

}  // namespace gcdt::bench
