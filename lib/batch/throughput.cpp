// SPDX-License-Identifier: Apache-2.0
#include "batch/throughput.hpp"

namespace gcdt {

// Sorts the workers by when they are free. If the first k share the weight, they end at the time that the equation
// sum throughput_i (end - busy_i) = weight gives. A further worker makes the end earlier if it is free before that end.
// So the least k is right whose next worker is free no sooner than the end.
double common_end(std::vector<BusyWorker> workers, double weight) {
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
