// SPDX-License-Identifier: Apache-2.0
// Kernels that the host's compiler has compiled, too (kernels/host.cmake). Where a device's memory is the host's, a
// launch that is one thread's work is done by the calling thread: sooner than other threads wake up, and before the
// device's own compiler has been asked for anything.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace gcdt::runtime {

struct HostKernel {
  const char* name;
  const std::uint16_t* sizes;  ///< of the arguments, in bytes
  std::size_t arguments;
  void (*run)(const void* const* given);  ///< as the one work-item of a launch
};

/// Of a program as CPUs build it (ProgramInfo::bundle). Null if the host does not have it.
const HostKernel* find_host_kernel(const char* program, const char* kernel);

/// A HostKernel's `run` and `sizes` for a function.
template <auto kernel>
struct HostKernelOf;
template <class... Parameters, void (*kernel)(Parameters...)>
struct HostKernelOf<kernel> {
  static constexpr std::uint16_t sizes[] = {sizeof(Parameters)...};
  static constexpr HostKernel named(const char* name) { return {name, sizes, sizeof...(Parameters), &run}; }

 private:
  template <class T>
  static T value(const void* given) {
    T copied;
    std::memcpy(&copied, given, sizeof copied);
    return copied;
  }
  template <std::size_t... index>
  static void run_with(const void* const* given, std::index_sequence<index...>) {
    kernel(value<Parameters>(given[index])...);
  }
  static void run(const void* const* given) { run_with(given, std::index_sequence_for<Parameters...>{}); }
};

/// The arguments of one launch, which must outlive it: of buffers where they lie in the host's memory, of scalars they
/// themselves, of local memory room of its own.
class HostArguments {
 public:
  void add_array(void* here) {
    all_here_ = all_here_ && here;
    pointers_[count_] = here;
    add(&pointers_[count_], sizeof here);
  }
  void add_local(std::size_t bytes) {
    local_.emplace_back(bytes);
    add_array(local_.back().data());
  }
  void add(const void* value, std::size_t bytes) {
    sizes_[count_] = static_cast<std::uint16_t>(bytes);
    given_[count_++] = value;
  }
  bool all_here() const { return all_here_; }
  /// Whether they are of the kernel's types, as far as sizes tell.
  bool fit(const HostKernel& kernel) const {
    return count_ == kernel.arguments && std::memcmp(sizes_.data(), kernel.sizes, count_ * sizeof sizes_[0]) == 0;
  }
  std::size_t count() const { return count_; }
  const void* const* given() const { return given_.data(); }

  static constexpr std::size_t most = 64;

 private:
  std::array<const void*, most> given_;
  std::array<void*, most> pointers_;
  std::array<std::uint16_t, most> sizes_;
  std::vector<std::vector<std::uint64_t>> local_;  // aligned as any type of OpenCL C but the widest vectors
  std::size_t count_ = 0;
  bool all_here_ = true;
};

}  // namespace gcdt::runtime
