// SPDX-License-Identifier: Apache-2.0
// The host memory through which transfers to and from a device go.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "device/copy_crew.hpp"
#include "device/host_array.hpp"
#include "device/mapped_memory.hpp"

namespace gcdt::runtime {

/// See Tuning::prepares_host_memory.
inline bool prepares_host_memory(const Runtime& runtime) {
  return runtime.tuning().prepares_host_memory.value_or(runtime.kind() == DeviceKind::gpu);
}

/// Chunks of host memory that take turns: while some are on their way to or from the device, the host fills or empties
/// others, by several threads if they are many. If they can be, they are memory of the driver's own, which it reads six
/// times as fast as other memory, and without the host (bench/NOTES.md). They are kept from call to call.
class TransferChunks {
 public:
  /// `pinned`: of the driver's own, if it has some.
  TransferChunks(Runtime& runtime, std::size_t count, std::size_t bytes, bool pinned);
  TransferChunks(const TransferChunks&) = delete;
  TransferChunks& operator=(const TransferChunks&) = delete;

  bool pinned() const { return mapped_.has_value(); }
  std::size_t count() const { return under_way_.size(); }
  /// Of one chunk.
  std::size_t chunk_bytes() const { return bytes_; }
  unsigned char* memory(std::size_t chunk) const { return memory_ + chunk * bytes_; }
  /// Others use the memory (shared_upload.hpp) until they set what is returned to false. Meanwhile the device's own
  /// transfers must not go through it.
  std::shared_ptr<std::atomic<bool>> lend() {
    *lent_ = true;
    return lent_;
  }
  bool lent() const { return *lent_; }
  /// Waits until the device does not use the chunk. What it did may have been part of an earlier transfer. After an
  /// error the device may still use it; it is done with it before anything that is queued later.
  void take(std::size_t chunk);
  /// After an error: nothing is queued any more, and whether what was there succeeded is of no interest.
  void forget();
  /// Queues a write of the chunk's first bytes; it may still be under way when this returns.
  void write(std::size_t chunk, cl_mem to, std::size_t offset, std::size_t bytes);
  /// Queues a read to the chunk; it is there after take().
  void read(std::size_t chunk, cl_mem from, std::size_t offset, std::size_t bytes);
  /// Sees to it that the device begins with what is queued.
  void flush() { runtime_.flush(); }
  /// Copies to and from the chunks, a slot for each. Its helpers sleep between transfers.
  CopyCrew& crew() { return crew_; }

 private:
  Runtime& runtime_;
  std::size_t bytes_;
  std::optional<MappedMemory> mapped_;
  HostArray plain_;
  unsigned char* memory_;
  std::shared_ptr<std::atomic<bool>> lent_ = std::make_shared<std::atomic<bool>>(false);
  std::vector<cl::Event> under_way_;  ///< what the device was last asked to do with each; null if it is done
  CopyCrew crew_;                     ///< ended before the memory is given back
};

}  // namespace gcdt::runtime
