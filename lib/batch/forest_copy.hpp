// SPDX-License-Identifier: Apache-2.0
// What a run of a forest leaves on the device, copied to new arrays in host memory.
#pragma once

#include <atomic>
#include <thread>

#include "batch/forest.hpp"

namespace gcdt {

/// Room in host memory for a run's result, made by a thread while the device works. A page that is new is zeroed by
/// the system when it is first written, which takes longer than the copy that fills it (bench/NOTES.md, "Batches"); so
/// the thread writes to as many pages as the last run's result had for its size. Nothing depends on it but time.
class ForestRoom {
 public:
  /// Does nothing where the device's threads are the host's, or the run is small. All must outlive the room.
  ForestRoom(const runtime::Runtime& runtime, const ProblemRanges& ranges, const Staging& staging,
             ForestResult& result);
  ForestRoom(const ForestRoom&) = delete;
  ForestRoom& operator=(const ForestRoom&) = delete;
  ~ForestRoom() { wait(); }
  /// Until the thread no longer touches the result, which is soon.
  void wait();

 private:
  void make(const Staging& staging, ForestResult& result, std::uint64_t n, std::uint64_t m, std::uint64_t problems);

  std::atomic<bool> enough_{false};
  std::thread thread_;
};

/// Copies what a run has left on the device, by problem, to `result`, into room that is there or new. Blocks.
void copy_forest(runtime::Runtime& runtime, const DeviceTriangulation& made,
                 const runtime::Buffer<cl_uint>& first_triangle, const runtime::Buffer<cl_uint>& first_piece,
                 const ProblemRanges& ranges, Staging& staging, ForestResult& result);

}  // namespace gcdt
