// SPDX-License-Identifier: Apache-2.0
// One row of the results: what was measured of an input, and the line of JSON that says it.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "inputs.hpp"
#include "peer.hpp"

namespace gcdt::bench {

constexpr std::size_t largest_verified = 20000000;  // beyond: the device's check and a sample

/// What was measured of one input.
struct Row {
  Input input;
  Workload work;
  Options options;
  Triangulation mesh;  ///< of the last timed call
  std::vector<Statistics::Milliseconds> ms;
  std::vector<double> call_ms;    ///< the whole call on the caller's clock, without building
  std::vector<double> order_ms;   ///< the canonical order on the device, without the copy to the host
  std::vector<double> pinned_ms;  ///< the same with arrays in pinned memory
  /// Of one traced call more: milliseconds and launches of each kernel.
  std::map<std::string, std::pair<double, int>> kernels;
  /// What may be asked of a mesh besides, in ms: labels of all regions (on top of the call), random points located
  /// with their weights, so many, from and to the host and from and to device memory, and the proof by gcdt::verify
  /// (beside other rows', 0 if not made).
  std::size_t located = 0;
  double regions_ms = 0, locate_ms = 0, device_locate_ms = 0, verify_ms = 0;
  bool same_bytes = true;  ///< every timed call gave the same triangles
  std::vector<std::pair<std::string, PeerTimes>> peers;
};

/// The median over the row's calls.
double median(const Row& row, double Statistics::Milliseconds::*step);

/// The row as a JSON object. `fault`: of the verification, or ""; `anchors`: the file of figures taken elsewhere;
/// `commit`: the version measured.
std::string describe(const Row& row, const DeviceInfo& device, const std::string& fault, const std::string& anchors,
                     const std::string& commit);

/// Today in UTC, as year-month-day.
std::string date();

}  // namespace gcdt::bench
