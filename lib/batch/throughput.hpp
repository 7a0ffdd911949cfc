// SPDX-License-Identifier: Apache-2.0
// How much work workers do in a time, as measured, and when they will be done.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gcdt {

/// The weight that a worker does in a millisecond: the sum of its runs' weights over the sum of their times, where each
/// new run halves what the earlier ones count. So one small run, whose time is mostly launches, does not hide the large
/// ones before it.
class Throughput {
 public:
  Throughput() = default;
  /// A throughput that is assumed until one is measured.
  explicit Throughput(double throughput) : weight_(throughput), milliseconds_(throughput > 0 ? 1 : 0) {}
  void add(double weight, double milliseconds) {
    weight_ = weight_ / 2 + weight;
    milliseconds_ = milliseconds_ / 2 + std::max(milliseconds, 1e-3);
  }
  bool known() const { return milliseconds_ > 0; }
  /// 0 if it is not known.
  double value() const { return known() ? weight_ / milliseconds_ : 0; }

 private:
  double weight_ = 0, milliseconds_ = 0;
};

/// A worker that is busy for a time and then free.
struct BusyWorker {
  double milliseconds = 0;  ///< until it is free
  double throughput = 0;
};

/// Shares `weight` out so that all workers that get some of it end together, and returns in how many milliseconds they
/// end. Workers that are busy for longer get nothing. At least one worker has a throughput.
inline double common_end(std::vector<BusyWorker> workers, double weight) {
  // Sorts the workers by when they are free. If the first k share the weight, they end at the time that the equation
  // sum throughput_i (end - busy_i) = weight gives. A further worker makes the end earlier if it is free before that
  // end. So the least k is right whose next worker is free no sooner than the end.
  std::sort(workers.begin(), workers.end(),
            [](const BusyWorker& a, const BusyWorker& b) { return a.milliseconds < b.milliseconds; });
  double throughputs = 0, end = 0;
  for (const BusyWorker& worker : workers) {
    if (throughputs > 0 && worker.milliseconds >= end) break;
    throughputs += worker.throughput;
    weight += worker.throughput * worker.milliseconds;
    if (throughputs > 0) end = weight / throughputs;
  }
  return end;
}

}  // namespace gcdt
