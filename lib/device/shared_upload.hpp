// SPDX-License-Identifier: Apache-2.0
// Host memory that goes to several devices at once.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "device/transfer_chunks.hpp"

namespace gcdt::runtime {

/// The same writes of several devices: what each would copy to pinned memory of its own by itself is copied once, by
/// threads that all have in common, and each device reads it there. All chunks of all devices take turns; one is free
/// again when every device has read it. A copy is bound by the threads that make it and by the host's memory, not by
/// what the devices' links take (bench/NOTES.md, "Tiles").
class SharedUpload {
 public:
  /// So many threads are to make a Taker each, with a device of its own. Nothing is sent before all have. `cores`: of
  /// the host, by which threads are chosen that help to copy.
  explicit SharedUpload(std::size_t takers, std::size_t cores = std::thread::hardware_concurrency())
      : expected_(takers), cores_(cores) {}
  SharedUpload(const SharedUpload&) = delete;
  SharedUpload& operator=(const SharedUpload&) = delete;
  ~SharedUpload();
  /// Waits until all takers have left: from then on nothing is copied, and a device's chunks are its own again. For one
  /// that has left.
  void wait_until_left();

  /// A device's thread. Until all have left, the device's other transfers do not go through its chunks, which are lent
  /// (transfer_chunks.hpp). It may leave when it likes; the others go on.
  class Taker {
   public:
    Taker(SharedUpload& shared, Runtime& runtime);
    Taker(const Taker&) = delete;
    Taker& operator=(const Taker&) = delete;
    /// Leaves, when nothing that the device was asked for is under way.
    ~Taker();
    /// Queues a write to the buffer's beginning. All takers make the same ones in the same order, until they leave. The
    /// host memory must stay as it is until the device has done it. What is pinned (Runtime::is_pinned) goes straight
    /// from there; all takers' runtimes know the same of that.
    void write(cl_mem to, const void* from, std::size_t bytes);

   private:
    void begin(std::size_t part, const unsigned char* from, std::size_t bytes);

    SharedUpload& shared_;
    Runtime& runtime_;
    std::vector<cl::Event> reads_;  ///< by slot: what the device was last asked to do with it
    std::size_t next_ = 0;          ///< of all writes' parts the first one that is not begun
    std::size_t released_ = 0;      ///< what comes before is of no use to the device any more
    bool straight_ = false;         ///< a write may be under way that goes through no slot
  };

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  struct Slot {
    unsigned char* memory;
    std::size_t part = none;  ///< part i goes through slot i modulo their number
    bool filled = false;
    std::size_t users = 0;  ///< takers that have not released it
  };
  struct Copy {
    std::size_t slot;
    const unsigned char* from;
    std::size_t bytes;
  };
  bool is_shared() const { return !slots_.empty(); }
  void give_back();
  std::size_t join(Runtime& runtime);
  void leave(std::size_t released);
  void release(std::size_t part);
  void assign(std::size_t part, const unsigned char* from, std::size_t bytes);
  unsigned char* filled(std::size_t part);
  void begin_helpers();
  void help();
  void make_next(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;  ///< of all but helpers_; slots' memory is who copies', then who reads'
  std::condition_variable begun_, changed_;
  std::size_t expected_, cores_, joined_ = 0, active_ = 0, copying_ = 0, threads_ = 0, chunk_bytes_ = 0;
  bool all_have_chunks_ = true, ready_ = false, over_ = false;
  std::vector<Slot> slots_;  ///< none: each device is sent everything by itself
  std::deque<Copy> waiting_;
  std::vector<std::shared_ptr<std::atomic<bool>>> lent_;  ///< of each device's chunks, until all takers have left
  std::vector<std::thread> helpers_;
};

}  // namespace gcdt::runtime
