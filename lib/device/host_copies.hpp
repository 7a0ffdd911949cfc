// SPDX-License-Identifier: Apache-2.0
// Copies on the host of arrays on the device that stay as they are: of few elements a copy costs less than to wait for
// the device once more.
#pragma once

#include <cstring>
#include <vector>

#include "device/host_array.hpp"
#include "device/runtime.hpp"

namespace gcdt {

class HostCopies {
 public:
  /// There shall be a copy of the array, which must live as long, and stay as it is. Before append_reads().
  template <class T>
  void add(const runtime::Buffer<T>& array) {
    if (array.size() == 0) return;
    copies_.push_back({array.handle(), bytes_, array.size() * sizeof(T)});
    bytes_ += array.size() * sizeof(T);
  }
  /// What makes the copies, behind `reads`; they are there when all these are done.
  void append_reads(std::vector<runtime::HostRead>& reads) {
    if (bytes_ == 0) return;
    unsigned char* const to = memory_.make<unsigned char>(bytes_);
    for (const Copy& copy : copies_) reads.push_back({copy.of, to + copy.place, copy.bytes});
  }
  /// Writes the first bytes of the array to `to`, if there is a copy of so many; else false.
  bool give(cl_mem array, void* to, std::size_t bytes) const {
    for (const Copy& copy : copies_)
      if (copy.of == array && bytes <= copy.bytes) {
        std::memcpy(to, memory_.bytes.get() + copy.place, bytes);
        return true;
      }
    return false;
  }

 private:
  struct Copy {
    cl_mem of;
    std::size_t place, bytes;
  };
  std::vector<Copy> copies_;
  std::size_t bytes_ = 0;
  HostArray memory_;
};

}  // namespace gcdt
