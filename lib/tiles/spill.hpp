// SPDX-License-Identifier: Apache-2.0
// A file for what has no room on a device.
#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/host_array.hpp"
#include "device/runtime.hpp"

namespace gcdt::tiles {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// Arrays that the host takes once, in the order in which they were put. Errors: Status::spill_failed.
class Spill {
 public:
  /// `directory`: of a file that has no name from the moment it is there, so that nothing is left of it however the
  /// process ends (where the file system has none such, it loses its name while it is empty).
  explicit Spill(const std::string& directory);

  template <class T>
  void put(runtime::Runtime& runtime, const runtime::Buffer<T>& buffer) {
    put_bytes(runtime, buffer.handle(), buffer.size() * sizeof(T));
  }
  /// Calls use(values, first) for the parts of the next array in their order, the first of which begins with element
  /// number `first`. The array is gone afterwards.
  template <class T, class Use>
  void take(Use&& use) {
    take_parts(sizeof(T), [&](const unsigned char* part, std::size_t first, std::size_t count) {
      use(Span<T>(reinterpret_cast<const T*>(part), count), first);
    });
  }

 private:
  void put_bytes(runtime::Runtime& runtime, cl_mem from, std::size_t bytes);
  void take_parts(std::size_t element,
                  const std::function<void(const unsigned char* part, std::size_t first, std::size_t count)>& use);
  [[noreturn]] void fail(const char* what) const;

  std::string directory_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::vector<std::size_t> sizes_;  ///< in bytes
  std::size_t taken_ = 0;
};

/// Arrays of the host's in a file, to be read in any order: the system has of it in memory what there is room for. On
/// Windows they stay in memory. Errors: Status::spill_failed.
class SpilledArrays {
 public:
  /// `directory`: as of a Spill. Copies the arrays.
  SpilledArrays(const std::string& directory, const std::vector<Span<unsigned char>>& arrays);
  SpilledArrays(const SpilledArrays&) = delete;
  SpilledArrays& operator=(const SpilledArrays&) = delete;
  ~SpilledArrays();
  /// An array's elements, as often as they are wanted.
  template <class T>
  Span<T> array(std::size_t number) const {
    return {reinterpret_cast<const T*>(first_ + begins_[number]), sizes_[number] / sizeof(T)};
  }

 private:
  std::vector<std::size_t> begins_, sizes_;  ///< in bytes
  std::size_t bytes_ = 0;
  const unsigned char* first_ = nullptr;
#ifdef _WIN32
  HostArray memory_;
#else
  std::unique_ptr<std::FILE, CloseFile> file_;  ///< to the end: what a close loses is not wanted any more then
#endif
};

}  // namespace gcdt::tiles
