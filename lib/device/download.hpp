// SPDX-License-Identifier: Apache-2.0
// Reads from a device during which other threads can use the context.
#pragma once

#include "device/mapped_memory.hpp"

namespace gcdt::runtime {

/// NVIDIA's driver has one lock for each context, and a thread holds it as long as it waits in a blocking read. So
/// reads are queued instead, and Runtime::wait asks whether they are done. They go into memory of the driver's own,
/// since reads into other memory block all the same. Two chunks of it take turns.
class Download {
 public:
  /// Null if the driver has no memory of its own for this.
  static std::unique_ptr<Download> make(Runtime& runtime);
  explicit Download(Runtime& runtime);
  /// Blocks; errors as Runtime::read_bytes.
  void read(cl_mem from, std::size_t offset, void* to, std::size_t bytes);

 private:
  Runtime& runtime_;
  MappedMemory memory_;
};

}  // namespace gcdt::runtime
