// SPDX-License-Identifier: Apache-2.0
// A further queue of a device, on which something is done beside the work of the first.
#pragma once

#include <functional>
#include <future>

#include "device/runtime.hpp"

namespace gcdt::runtime {

/// Does one thing at a time, in a thread that lasts as long as that. All functions are for the thread that has the
/// device's first queue, or that has waited for it.
class SideQueue {
 public:
  /// `runtime`: in the context of the first one, and nobody else's meanwhile.
  explicit SideQueue(Runtime& runtime) : runtime_(runtime) {}
  SideQueue(const SideQueue&) = delete;
  ~SideQueue() { rest(); }

  /// Begins use(runtime), whose large transfers may use all of the device's link. The last one must have been waited
  /// for. What the first queue has made must be finished.
  void begin(std::function<void(Runtime&)> use);
  /// Waits for it, and throws what it has thrown, which is then forgotten.
  void wait();
  /// Waits for it: from then on nothing goes on here.
  void rest() const;

 private:
  Runtime& runtime_;
  std::future<void> work_;
};

}  // namespace gcdt::runtime
