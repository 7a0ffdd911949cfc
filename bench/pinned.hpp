// SPDX-License-Identifier: Apache-2.0
// A caller whose host arrays are memory that the driver pinned: what the transfers cost at best.
#pragma once

#include <memory>

#include <gcdt/gcdt.hpp>

namespace gcdt::bench {

class PinnedCaller {
 public:
  /// On a context and queue of its own on the OpenCL device that is `device`.
  explicit PinnedCaller(const DeviceInfo& device);
  ~PinnedCaller();

  /// Pins the input, triangulates it `runs` times after one that does not count, and copies triangles, neighbours,
  /// flags and representatives to pinned memory. Returns the milliseconds of each whole call, without building.
  std::vector<double> time(Points points, Constraints constraints, const Options& options, int runs);

 private:
  class Memory;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gcdt::bench
