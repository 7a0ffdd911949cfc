// SPDX-License-Identifier: Apache-2.0
// Writes bytes to a device that the host puts together chunk by chunk.
#pragma once

#include <optional>

#include "device/host_array.hpp"
#include "device/mapped_memory.hpp"

namespace gcdt::runtime {

/// See Tuning::prepares_host_memory.
inline bool prepares_host_memory(const Runtime& runtime) {
  return runtime.tuning().prepares_host_memory.value_or(runtime.kind() == DeviceKind::gpu);
}

/// Two chunks of host memory that take turns: while one is on its way to the device, the host fills the other. For GPUs
/// they are memory of the driver's own, which the driver reads six times as fast as other memory, and without the host
/// (bench/NOTES.md). For other devices, and if the driver has none, they are ordinary memory. They are kept from call
/// to call.
class UploadChunks {
 public:
  explicit UploadChunks(Runtime& runtime);
  UploadChunks(const UploadChunks&) = delete;
  UploadChunks& operator=(const UploadChunks&) = delete;
  std::size_t chunk_bytes() const { return bytes_; }

 private:
  friend class Upload;
  std::size_t bytes_;
  std::optional<MappedMemory> mapped_;
  HostArray plain_;
  struct Chunk {
    unsigned char* memory = nullptr;
    cl::Event written;  ///< of the write under way; null if the chunk is free
  } chunks_[2];
};

/// One write to a buffer. It begins at the buffer's first byte.
class Upload {
 public:
  Upload(Runtime& runtime, UploadChunks& chunks, cl_mem to) : runtime_(runtime), chunks_(chunks), to_(to) {}

  /// Returns room for 1 to `wanted` more elements, which the caller fills before the next call. All elements of an
  /// upload have one size.
  template <class T>
  std::pair<T*, std::size_t> room(std::size_t wanted) {
    if (filled_ + sizeof(T) > chunks_.bytes_) send();
    if (filled_ == 0) take();
    const std::size_t count = std::min(wanted, (chunks_.bytes_ - filled_) / sizeof(T));
    T* first = reinterpret_cast<T*>(chunks_.chunks_[current_].memory + filled_);
    filled_ += count * sizeof(T);
    return {first, count};
  }
  void append(const unsigned char* from, std::size_t bytes);
  /// Queues the write of what has been filled. The chunk may still be on its way when this returns.
  void send();

 private:
  void take();

  Runtime& runtime_;
  UploadChunks& chunks_;
  cl_mem to_;
  std::size_t current_ = 0, filled_ = 0, sent_ = 0;
};

}  // namespace gcdt::runtime
