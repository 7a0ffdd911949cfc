// SPDX-License-Identifier: Apache-2.0
// Device memory in a few large slabs, handed out as sub-buffers. Slabs are kept when what was in them is
// released, so that a repeated run allocates nothing.
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace gcdt::runtime {

class Runtime;

/// Device bytes in use now and at the peak, as asked for, and those of all slabs.
struct MemoryMeter {
  std::uint64_t now = 0, peak = 0, held = 0, held_peak = 0;
  void add(std::uint64_t bytes) { peak = std::max(peak, now += bytes); }
  void remove(std::uint64_t bytes) { now -= bytes; }
  void hold(std::uint64_t bytes) { held_peak = std::max(held_peak, held += bytes); }
  void let_go(std::uint64_t bytes) { held -= bytes; }
  void restart_peaks() { peak = now, held_peak = held; }
};

/// Where slabs come from; empty functions stand for clCreateBuffer and clReleaseMemObject.
struct SlabSource {
  std::function<cl_mem(cl_context context, cl_mem_flags flags, std::size_t bytes, cl_int* code)> allocate;
  std::function<void(cl_mem)> release;
};

/// Blocks hold a shared pointer to it, so that they may outlive the Runtime.
class DeviceMemory : public std::enable_shared_from_this<DeviceMemory> {
 private:
  struct Slab;

 public:
  /// Part of a slab, handed back with the object.
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
      if (owner_) owner_->give_back(*this);
    }
    cl_mem handle() const { return memory_(); }

   private:
    friend class DeviceMemory;
    void swap(Block& other) {
      std::swap(owner_, other.owner_);
      std::swap(slab_, other.slab_);
      std::swap(offset_, other.offset_);
      std::swap(length_, other.length_);
      std::swap(asked_, other.asked_);
      std::swap(memory_, other.memory_);
    }
    std::shared_ptr<DeviceMemory> owner_;
    Slab* slab_ = nullptr;
    std::size_t offset_ = 0, length_ = 0, asked_ = 0;
    cl::Buffer memory_;
  };

  /// Memory of its own, from `source`.
  explicit DeviceMemory(SlabSource source) : source_(std::move(source)) {}
  /// The caller's buffers, which are retained, and nothing else.
  explicit DeviceMemory(const std::vector<cl::Buffer>& workspace);
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  /// `bytes` of a slab: of the first one that has room, and there of the smallest gap; else a new slab. As long
  /// as none is given back, a repeated sequence of calls takes the same places, by induction over the calls and
  /// the slabs: a later slab is only looked at when all before it have no room, which is when it was made.
  /// Throws out_of_memory, or workspace_too_small with the bytes needed.
  Block take(Runtime& runtime, const char* name, std::size_t bytes);

  /// Makes room for `bytes` beside what is in use, in as few slabs as the device allows, if it can.
  void reserve(Runtime& runtime, std::uint64_t bytes);

  /// Gives back every slab with nothing in it.
  void trim();

  bool is_workspace() const { return workspace_; }
  /// Whether a byte of [begin, end) of `slab`, if it is one, may be handed out.
  bool is_free(cl_mem slab, std::size_t begin, std::size_t end) const;
  /// Whether `memory` is one of the slabs.
  bool holds(cl_mem memory) const;
  MemoryMeter& meter() { return meter_; }

 private:
  struct Slab {
    cl::Buffer memory;
    std::size_t bytes = 0, used = 0;
    std::map<std::size_t, std::size_t> gaps;  ///< length by offset; neighbouring gaps are one
  };
  bool place(Block& block, std::size_t length);
  Slab& add_slab(Runtime& runtime, const char* name, std::size_t bytes);
  cl_int try_slab(Runtime& runtime, const char* name, std::size_t bytes, cl::Buffer& memory);
  void add_gap(Slab& slab, std::size_t offset, std::size_t length);
  void give_back(Block& block);
  void drop(Slab& slab);
  [[noreturn]] void fail_for_size(const Runtime& runtime, const char* name, std::size_t bytes) const;

  SlabSource source_;
  bool workspace_ = false;
  MemoryMeter meter_;
  std::vector<std::unique_ptr<Slab>> slabs_;
};

}  // namespace gcdt::runtime
