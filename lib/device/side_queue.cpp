// SPDX-License-Identifier: Apache-2.0
#include "device/side_queue.hpp"

#include "device/parts.hpp"

namespace gcdt::runtime {

void SideQueue::begin(std::function<void(Runtime&)> use) {
  auto work = [this, use = std::move(use)] {
    runtime_.set_alone(true);
    try {
      use(runtime_);
    } catch (...) {
      runtime_.attempt("clFinish", "after an error", [&] { return runtime_.try_finish(); });
      runtime_.tracer().clear();
      runtime_.set_alone(false);
      throw;
    }
    runtime_.set_alone(false);
  };
  work_ = begin_in_thread(work);
}

void SideQueue::wait() {
  if (work_.valid()) work_.get();
}

void SideQueue::rest() const {
  if (work_.valid()) work_.wait();
}

}  // namespace gcdt::runtime
