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

  /// Pins a copy of the input, of doubles, which lasts until the next one or as long as the object.
  void take(Points points, Constraints constraints);
  Points points() const;
  Constraints constraints() const;
  /// Triangulates that input, and copies triangles, neighbours, flags and representatives to pinned memory; `all`: and
  /// pieces with their sources. Returns the milliseconds of the whole call, without building; but of the first one
  /// after take(), which pins the results' memory.
  double call(const Options& options, bool all = false);
  /// `runs` such calls after one that does not count.
  std::vector<double> time(Points points, Constraints constraints, const Options& options, int runs);

 private:
  class Memory;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gcdt::bench
