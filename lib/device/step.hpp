// SPDX-License-Identifier: Apache-2.0
// A step of a call: its wall time on the host's clock, without the building of programs, and its span in the trace.
#pragma once

#include <chrono>

#include "device/runtime.hpp"

namespace gcdt {

/// Milliseconds since a moment on the host's steady clock.
inline double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Wall time since its construction, without building programs.
struct Stopwatch {
  explicit Stopwatch(const runtime::Runtime& timed) : runtime(timed) {}
  double milliseconds() const { return milliseconds_since(start) - (runtime.build_ms() - built); }

  const runtime::Runtime& runtime;
  const double built = runtime.build_ms();
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

/// Adds the time until its end.
class Timed {
 public:
  explicit Timed(double& ms) : ms_(ms) {}
  Timed(const Timed&) = delete;
  ~Timed() { ms_ += milliseconds_since(start_); }

 private:
  double& ms_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// From its construction to end(). What was queued before should be finished: it would count. Steps nest. After an
/// exception whoever catches it clears the trace.
class Step {
 public:
  Step(runtime::Runtime& runtime, const char* name) : runtime_(runtime), stopwatch_(begin(runtime, name)) {}
  /// Waits for the queue, if steps are timed, and returns the milliseconds.
  double end() {
    runtime_.end_step();
    const double ms = stopwatch_.milliseconds();
    runtime_.tracer().end_phase();
    return ms;
  }

 private:
  static const runtime::Runtime& begin(runtime::Runtime& runtime, const char* name) {
    runtime.tracer().begin_phase(name);
    return runtime;
  }
  runtime::Runtime& runtime_;
  Stopwatch stopwatch_;
};

}  // namespace gcdt
