// SPDX-License-Identifier: Apache-2.0
// Writes to a device through chunks of host memory.
#pragma once

#include "device/transfer_chunks.hpp"

namespace gcdt::runtime {

/// Two that take turns, for uploads that a pool's worker puts together.
inline TransferChunks upload_chunks(Runtime& runtime) {
  const bool pinned = prepares_host_memory(runtime);
  return {runtime, 2, pinned ? Tuning::gpu_upload_chunk : Tuning::cpu_upload_chunk, pinned};
}

/// One write to a buffer of what the host puts together chunk by chunk. It begins at the buffer's first byte.
class Upload {
 public:
  Upload(TransferChunks& chunks, cl_mem to) : chunks_(chunks), to_(to) {}

  /// Returns room for 1 to `wanted` more elements, which the caller fills before the next call. All elements of an
  /// upload have one size.
  template <class T>
  std::pair<T*, std::size_t> room(std::size_t wanted) {
    if (filled_ + sizeof(T) > chunks_.chunk_bytes()) send();
    if (filled_ == 0) chunks_.take(current_);
    const std::size_t count = std::min(wanted, (chunks_.chunk_bytes() - filled_) / sizeof(T));
    T* first = reinterpret_cast<T*>(chunks_.memory(current_) + filled_);
    filled_ += count * sizeof(T);
    return {first, count};
  }
  void append(const unsigned char* from, std::size_t bytes);
  /// Queues the write of what has been filled. The chunk may still be on its way when this returns.
  void send();

 private:
  TransferChunks& chunks_;
  cl_mem to_;
  std::size_t current_ = 0, filled_ = 0, sent_ = 0;
};

/// Writes `bytes` bytes that lie in one place, copied to the chunks by `threads` threads, the caller's included. When
/// it returns, or throws, they are no longer read.
void write_through(TransferChunks& chunks, unsigned threads, cl_mem to, std::size_t offset, const unsigned char* from,
                   std::size_t bytes);

}  // namespace gcdt::runtime
