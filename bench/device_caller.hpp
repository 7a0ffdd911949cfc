// SPDX-License-Identifier: Apache-2.0
// A caller whose arrays are in device memory: what locating takes without any transfer.
#pragma once

#include <memory>

#include <gcdt/gcdt.hpp>

namespace gcdt::bench {

class DeviceCaller {
 public:
  /// On a context and queue of its own on the OpenCL device that is `device`.
  explicit DeviceCaller(const DeviceInfo& device);
  ~DeviceCaller();

  /// Locates `queries` with their weights, from device memory to device memory, `runs` times after one that does not
  /// count. Returns the milliseconds of each call.
  std::vector<double> time_locate(Points points, Constraints constraints, const Options& options, Points queries,
                                  int runs);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gcdt::bench
