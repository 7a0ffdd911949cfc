// SPDX-License-Identifier: Apache-2.0
// Exponential back-off of workers that are too slow.
#pragma once

#include <algorithm>
#include <cstdint>

namespace gcdt {

/// Says in which calls a worker sits out because it was too slow to be of use. It sits out 1 call, then takes part and
/// is measured again. If it is still too slow it sits out 2, then 4, up to 64, since throughputs seldom change within a
/// process.
class Backoff {
 public:
  /// Whether the worker sits out the next call.
  bool sits_out() const { return calls_ > 0; }
  /// A call is over. `too_slow`: what it has shown of the worker, if the worker took part.
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

}  // namespace gcdt
