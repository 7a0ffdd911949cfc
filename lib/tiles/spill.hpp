// SPDX-License-Identifier: Apache-2.0
// Memory of the host's, or of a file, for what has no room on a device.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "device/host_array.hpp"
#include "device/runtime.hpp"

namespace gcdt::tiles {

/// Arrays that are taken back once, in the order in which they were put. Errors: Status::spill_failed.
class Spill {
 public:
  /// `directory`: of a file that has no name from the moment it is there, so that nothing is left of it however the
  /// process ends (where the file system has none such, it loses its name while it is empty); empty: in memory.
  explicit Spill(const std::string& directory);

  template <class T>
  void put(runtime::Runtime& runtime, const runtime::Buffer<T>& buffer) {
    sizes_.push_back(buffer.size());
    put_bytes(runtime, buffer.handle(), buffer.size() * sizeof(T));
  }
  template <class T>
  runtime::Buffer<T> take(runtime::Runtime& runtime, const char* name) {
    auto buffer = runtime.allocate<T>(name, sizes_.at(taken_));
    take_bytes(runtime, buffer.handle(), buffer.size() * sizeof(T));
    return buffer;
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void put_bytes(runtime::Runtime& runtime, cl_mem from, std::size_t bytes);
  void take_bytes(runtime::Runtime& runtime, cl_mem to, std::size_t bytes);
  [[noreturn]] void fail(const char* what) const;

  std::string directory_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<HostArray> arrays_;  ///< in memory
  std::vector<std::size_t> sizes_;
  std::size_t taken_ = 0;
};

}  // namespace gcdt::tiles
