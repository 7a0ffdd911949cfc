// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/runtime.hpp"

namespace gcdt::runtime {

/// Host memory of the driver's own, which devices read and write without the host's help. It lives as long as the
/// object, and the runtime must outlive it.
class MappedMemory {
 public:
  MappedMemory(Runtime& runtime, std::size_t bytes) : runtime_(runtime), memory_(runtime.map_new(bytes, buffer_)) {}
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;
  ~MappedMemory() {
    if (memory_) runtime_.unmap(buffer_, memory_);
  }
  /// Null if the driver has none.
  unsigned char* get() const { return static_cast<unsigned char*>(memory_); }

 private:
  Runtime& runtime_;
  cl::Buffer buffer_;
  void* memory_;
};

}  // namespace gcdt::runtime
