// SPDX-License-Identifier: Apache-2.0
// Device memory from the caller's buffers, and nothing else: blocks are sub-buffers of them.
#pragma once

#include <map>
#include <vector>

#include "device/device_memory.hpp"

namespace gcdt::runtime {

class Workspace final : public DeviceMemory {
 public:
  /// The buffers are retained.
  explicit Workspace(const std::vector<cl::Buffer>& buffers);
  bool is_free(cl_mem memory, std::size_t begin, std::size_t end) const override;
  bool holds(cl_mem memory) const override;

 private:
  struct Slab {
    cl::Buffer memory;
    std::map<std::size_t, std::size_t> gaps;  ///< length by offset; neighbouring gaps are one
  };
  /// Of the first buffer that has room, the smallest gap.
  Place find(Runtime& runtime, const char* name, std::size_t bytes) override;
  void give_back(Place& place) override;
  Place reserve(Runtime& runtime, const char* name, std::size_t bytes);

  std::vector<Slab> slabs_;
};

}  // namespace gcdt::runtime
