// SPDX-License-Identifier: Apache-2.0
// Reads that keep nobody out of the context.
#pragma once

#include "device/mapped_memory.hpp"

namespace gcdt::runtime {

/// NVIDIA's driver has one lock for a context, which a thread holds that waits in a blocking read. So reads are queued,
/// into memory of the driver's own (into other memory they would block all the same), chunk by chunk by turns, and
/// Runtime::wait asks whether they are there.
class Download {
 public:
  /// Null if the driver has no such memory.
  static std::unique_ptr<Download> make(Runtime& runtime);
  explicit Download(Runtime& runtime);
  /// Blocks; errors as Runtime::read_bytes.
  void read(cl_mem from, std::size_t offset, void* to, std::size_t bytes);

 private:
  Runtime& runtime_;
  MappedMemory memory_;
};

}  // namespace gcdt::runtime
