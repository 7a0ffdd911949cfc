// SPDX-License-Identifier: Apache-2.0
// Device memory by the block: from a pool of whole buffers (buffer_pool.hpp) or from the caller's workspace
// (workspace.hpp).
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>

namespace gcdt::runtime {

class Runtime;

/// Device memory, and where it lies in the host's, if it does (shared_memory.hpp).
struct Memory {
  Memory() = default;
  Memory(cl_mem memory, void* where = nullptr) : handle(memory), here(where) {}
  cl_mem handle = nullptr;
  void* here = nullptr;
};

/// Device bytes in use now and at the peak, as asked for, and those held for it.
struct MemoryMeter {
  std::uint64_t now = 0, peak = 0, held = 0, held_peak = 0;
  void add(std::uint64_t bytes) { peak = std::max(peak, now += bytes); }
  void remove(std::uint64_t bytes) { now -= bytes; }
  void hold(std::uint64_t bytes) { held_peak = std::max(held_peak, held += bytes); }
  void let_go(std::uint64_t bytes) { held -= bytes; }
  void restart_peaks() { peak = now, held_peak = held; }
};

/// Blocks hold a shared pointer to it, so that they may outlive the Runtime.
class DeviceMemory : public std::enable_shared_from_this<DeviceMemory> {
 protected:
  /// Where a block lies: in holder number `holder`, `length` bytes from `offset` on.
  struct Place {
    std::size_t holder = 0, offset = 0, length = 0;
    cl::Buffer memory;
    void* here = nullptr;
  };

 public:
  /// At least as many bytes as were asked for, handed back with the object.
  class Block {
   public:
    Block() = default;
    Block(Block&& other) noexcept { swap(other); }
    Block& operator=(Block&& other) noexcept {
      Block moved(std::move(other));
      swap(moved);
      return *this;
    }
    ~Block() {
      if (!owner_) return;
      owner_->meter_.remove(asked_);
      owner_->give_back(place_);
    }
    cl_mem handle() const { return place_.memory(); }
    void* here() const { return place_.here; }

   private:
    friend class DeviceMemory;
    void swap(Block& other) {
      std::swap(owner_, other.owner_);
      std::swap(place_, other.place_);
      std::swap(asked_, other.asked_);
    }
    std::shared_ptr<DeviceMemory> owner_;
    Place place_;
    std::size_t asked_ = 0;
  };

  DeviceMemory() = default;
  virtual ~DeviceMemory() = default;
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  /// `name` is for error messages. Throws out_of_memory, or workspace_too_small with the bytes needed.
  Block take(Runtime& runtime, const char* name, std::size_t bytes) {
    Block block;
    block.place_ = find(runtime, name, bytes);
    block.owner_ = shared_from_this();
    block.asked_ = bytes;
    meter_.add(bytes);
    return block;
  }

  /// A new call of the library begins: what it takes is compared with what the last one took.
  virtual void begin_call() {}
  /// Gives back what nobody uses.
  virtual void trim() {}
  /// Whether a byte of [begin, end) of `memory` may be handed out.
  virtual bool is_free(cl_mem memory, std::size_t begin, std::size_t end) const = 0;
  /// Whether blocks lie in `memory`.
  virtual bool holds(cl_mem memory) const = 0;
  MemoryMeter& meter() { return meter_; }

 protected:
  virtual Place find(Runtime& runtime, const char* name, std::size_t bytes) = 0;
  virtual void give_back(Place& place) = 0;
  MemoryMeter meter_;
};

}  // namespace gcdt::runtime
