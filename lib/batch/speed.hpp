// SPDX-License-Identifier: Apache-2.0
// What is known of how fast lanes are, and when they would be done.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gcdt {

/// Weight a millisecond, as measured by runs: each counts by its weight and time, and half as much after every other
/// one. So one small run, whose launches are most of its time, does not hide what large ones before it took.
class Speed {
 public:
  Speed() = default;
  /// What it is believed to be until it is measured.
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

/// In which calls a lane that was too slow to be of use sits out: 1 after it was measured, then 2, 4 ... up to 64 in a
/// row, since speeds may change in the course of a process, but not often.
class SittingOut {
 public:
  bool now() const { return calls_ > 0; }
  /// A call is over, after which, if it took part, the lane is too slow or not.
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

/// A lane that can do more when it is done with what it has.
struct BusyLane {
  double milliseconds = 0;  ///< until then
  double speed = 0;
};

/// In how many milliseconds lanes would be done with `weight` more if it were shared out so that all that get some end
/// together; lanes that are busy for longer than that get none. At least one lane has a speed.
double common_end(std::vector<BusyLane> lanes, double weight);

}  // namespace gcdt
