// SPDX-License-Identifier: Apache-2.0
// Copies what a run of a forest leaves on the device to arrays in host memory.
#pragma once

#include "batch/pipeline.hpp"
#include "device/host_room.hpp"

namespace gcdt {

/// Room in host memory for a run's result, which a thread makes ready while the device works: as many pages as the last
/// run's result needed for its size. Only time depends on it.
class ForestRoom {
 public:
  /// Starts no thread where the device's threads are the host's, or the run is small. The result must outlive the room.
  ForestRoom(const runtime::Runtime& runtime, const ProblemRanges& ranges, const Staging& staging,
             ForestResult& result);
  /// Waits until the thread no longer touches the result, which is soon.
  void wait() {
    if (room_) room_->stop();
  }

 private:
  std::optional<runtime::HostRoom> room_;
};

/// Copies what a run has left on the device to `result`, by problem. Uses the room that is there, and makes more.
/// Blocks.
void copy_forest(runtime::Runtime& runtime, const DeviceTriangulation& made,
                 const runtime::Buffer<cl_uint>& first_triangle, const runtime::Buffer<cl_uint>& first_piece,
                 const ProblemRanges& ranges, Staging& staging, ForestResult& result);

}  // namespace gcdt
