// SPDX-License-Identifier: Apache-2.0
#include "batch/speed.hpp"

namespace gcdt {

// Like water that finds its level: sort the lanes by when they are free. If the first k share the weight, they end at
// the time given by sum speed_i (end - busy_i) = weight. Each further lane that is free before that makes the end
// earlier. So the right k is the first one whose next lane is free no sooner than the end.
double common_end(std::vector<BusyLane> lanes, double weight) {
  std::sort(lanes.begin(), lanes.end(),
            [](const BusyLane& a, const BusyLane& b) { return a.milliseconds < b.milliseconds; });
  double speeds = 0, end = 0;
  for (const BusyLane& lane : lanes) {
    if (speeds > 0 && lane.milliseconds >= end) break;
    speeds += lane.speed;
    weight += lane.speed * lane.milliseconds;
    if (speeds > 0) end = weight / speeds;
  }
  return end;
}

}  // namespace gcdt
