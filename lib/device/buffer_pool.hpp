// SPDX-License-Identifier: Apache-2.0
// Device memory as whole buffers, kept for the next call when they are handed back. Not parts of large ones:
// NVIDIA's driver copies contents through the host, at 10 GB/s, whenever sub-buffers that overlap take turns
// (bench/NOTES.md).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "device/device_memory.hpp"

namespace gcdt::runtime {

/// Where buffers come from; empty functions stand for clCreateBuffer and clReleaseMemObject.
struct BufferSource {
  std::function<cl_mem(cl_context context, cl_mem_flags flags, std::size_t bytes, cl_int* code)> allocate;
  std::function<void(cl_mem)> release;
};

/// Takes for a block the buffer that served the same name, at the same count of that name, in the last call; else
/// the smallest free one that is not too large; else a new one. So a repeated call makes nothing new, by induction
/// over what it takes: each buffer that served the last call is free when its turn comes, as it was then. Buffers
/// that served none of the last calls are given back, so that sizes which change do not pile up.
class BufferPool final : public DeviceMemory {
 public:
  explicit BufferPool(BufferSource source) : source_(std::move(source)) {}
  ~BufferPool() override;
  void begin_call() override;
  void trim() override;
  bool is_free(cl_mem memory, std::size_t begin, std::size_t end) const override;
  bool holds(cl_mem memory) const override;

 private:
  struct Entry {
    cl::Buffer memory;  ///< null: the entry may be used again
    void* here = nullptr;
    std::size_t bytes = 0;
    bool used = false;
    bool once = false;            ///< dropped when handed back (Tuning::fresh_buffers)
    std::uint64_t last_call = 0;  ///< in which it was taken
  };
  /// The entries that served a name, in order, in the last call and so far in this one.
  struct Served {
    std::vector<std::size_t> entries;
    std::size_t next = 0;
  };
  Place find(Runtime& runtime, const char* name, std::size_t bytes) override;
  void give_back(Place& place) override;
  bool fits(const Entry& entry, std::size_t bytes) const;
  std::size_t choose(Runtime& runtime, const char* name, std::size_t preferred, std::size_t bytes);
  std::size_t add(Runtime& runtime, const char* name, std::size_t bytes);
  cl_int try_to_make(Runtime& runtime, const char* name, Entry& entry);
  void drop(Entry& entry);

  BufferSource source_;
  std::uint64_t call_ = 0;
  std::vector<Entry> entries_;
  std::map<std::string, Served> served_;
};

}  // namespace gcdt::runtime
