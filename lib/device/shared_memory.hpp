// SPDX-License-Identifier: Apache-2.0
// Buffers that the host reads and writes where they are (OpenCL 2.0, fine-grained shared virtual memory): a CPU's.
#pragma once

#include "device/device_memory.hpp"

namespace gcdt::runtime {

/// Whether the device has such memory: what the host writes before it queues a command the command sees, and the host
/// sees what a command wrote that it has waited for.
bool shares_memory(const cl::Device& device);

/// A buffer in it, and where the host finds it. It goes with the buffer's last reference. Returns an OpenCL code.
cl_int make_shared_buffer(const cl::Context& context, std::size_t bytes, cl::Buffer& buffer, void*& here);

}  // namespace gcdt::runtime
