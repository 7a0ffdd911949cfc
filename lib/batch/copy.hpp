// SPDX-License-Identifier: Apache-2.0
// Copies what a run of a forest leaves on the device to arrays in host memory.
#pragma once

#include <atomic>
#include <thread>

#include "batch/pipeline.hpp"

namespace gcdt {

/// Room in host memory for a run's result, which a thread makes while the device works. The system zeroes a new page
/// when it is first written, which takes longer than the copy that fills it (bench/NOTES.md, "Batches"). So the thread
/// writes to as many pages as the last run's result needed for its size. Only time depends on it.
class ForestRoom {
 public:
  /// Starts no thread where the device's threads are the host's, or the run is small. All arguments must outlive the
  /// room.
  ForestRoom(const runtime::Runtime& runtime, const ProblemRanges& ranges, const Staging& staging,
             ForestResult& result);
  ForestRoom(const ForestRoom&) = delete;
  ForestRoom& operator=(const ForestRoom&) = delete;
  ~ForestRoom() { wait(); }
  /// Waits until the thread no longer touches the result, which is soon.
  void wait();

 private:
  void make(const ProblemRanges& ranges, const Staging& staging, ForestResult& result);

  std::atomic<bool> enough_{false};
  std::thread thread_;
};

/// Copies what a run has left on the device to `result`, by problem. Uses the room that is there, and makes more.
/// Blocks.
void copy_forest(runtime::Runtime& runtime, const DeviceTriangulation& made,
                 const runtime::Buffer<cl_uint>& first_triangle, const runtime::Buffer<cl_uint>& first_piece,
                 const ProblemRanges& ranges, Staging& staging, ForestResult& result);

}  // namespace gcdt
