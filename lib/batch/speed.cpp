// SPDX-License-Identifier: Apache-2.0
#include "batch/speed.hpp"

namespace gcdt {

// As water finds its level: the lanes that are free soonest fill up to the next one, and so on. With the first k lanes,
// Sum speed_i (end - busy_i) = weight; the end falls with every lane that is free before it, so the first k for which
// the next lane is free no sooner is right.
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
