// SPDX-License-Identifier: Apache-2.0
// Measured speeds of lanes, and when lanes would be done.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gcdt {

/// Weight a millisecond, measured by runs. Weights and times of runs are added up, and each new run halves what the
/// ones before it count. So one small run, whose time is mostly launches, does not hide the large ones before it.
class Speed {
 public:
  Speed() = default;
  /// A speed that is assumed until one is measured.
  explicit Speed(double speed) : weight_(speed), milliseconds_(speed > 0 ? 1 : 0) {}
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

/// In which calls a lane sits out because it was too slow to be of use. It sits out 1 call, then takes part and is
/// measured again; if it is still too slow it sits out 2, then 4, up to 64, since speeds seldom change within a
/// process.
class SittingOut {
 public:
  bool now() const { return calls_ > 0; }
  /// A call is over. `too_slow`: what it has shown of the lane, if the lane took part.
  void next_call(bool too_slow) {
    if (calls_ > 0) {
      --calls_;
    } else if (too_slow) {
      calls_ = next_;
      next_ = std::min<std::uint32_t>(2 * next_, 64);
    } else {
      next_ = 1;
    }
  }

 private:
  std::uint32_t calls_ = 0, next_ = 1;
};

/// A lane that is busy for a time and then free.
struct BusyLane {
  double milliseconds = 0;  ///< until it is free
  double speed = 0;
};

/// In how many milliseconds the lanes would be done with `weight` if it were shared out so that all lanes that get some
/// of it end together. Lanes that are busy for longer get none. At least one lane has a speed.
double common_end(std::vector<BusyLane> lanes, double weight);

}  // namespace gcdt
