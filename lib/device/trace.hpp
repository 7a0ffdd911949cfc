// SPDX-License-Identifier: Apache-2.0
// Where the time goes: spans of the host's phases and of the device's launches, told to whoever asked.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gcdt/types.hpp>

#include "device/device_memory.hpp"

namespace gcdt::runtime {

/// Collects the profiling events of one queue's launches, which are made only if there is a sink, and tells the spans
/// of phases and launches. On the host's steady clock: the device's clock is set against it by the moments before
/// and after each launch was queued, between which the device saw it queued.
class Tracer {
 public:
  Tracer() = default;
  Tracer(Trace sink, std::string device) : sink_(std::move(sink)), device_(std::move(device)) {}
  bool on() const { return static_cast<bool>(sink_); }
  /// Spans of a further worker (device_pool.hpp) of a device have a number and a name of their own: they overlap the
  /// first one's.
  void set_worker(std::uint32_t number, std::uint32_t worker) {
    device_number_ = number;
    if (worker > 0) device_ += ", worker " + std::to_string(worker + 1);
  }

  /// Spans of launches are told while a phase lasts, as parts of it; phases nest.
  void begin_phase(const char* name);
  /// The queue is finished: all launches of the phase are told, then the phase.
  void end_phase();
  /// Tells `text` as a span of no length in a phase of its own.
  void note(const char* phase, const std::string& text) {
    begin_phase(phase), begin_phase(text.c_str());
    end_phase(), end_phase();
  }
  /// Forgets phases and launches, after an error.
  void clear();

  /// Calls `enqueue(event)` for a launch of `kernel`, which must live as long as the Tracer.
  template <class Enqueue>
  cl_int launch(const std::string& kernel, Enqueue&& enqueue) {
    if (!on()) return enqueue(nullptr);
    cl::Event event;
    const std::uint64_t before = now();
    const cl_int code = enqueue(&event());
    if (code == CL_SUCCESS) launches_.push_back({&kernel, std::move(event), before, now()});
    return code;
  }
  /// Calls `run()`, which is a launch of `kernel` by itself. What was launched before is finished.
  template <class Run>
  void launch_here(const char* kernel, Run&& run) {
    if (!on()) return run();
    tell_launches();
    const std::uint64_t before = now();
    run();
    told_until_ = now();
    tell(kernel, true, before, told_until_);
  }
  /// The queue was just waited for: tells launches if many are kept.
  void waited() {
    if (launches_.size() >= kept_launches) tell_launches();
  }

 private:
  struct Launch {
    const std::string* kernel;
    cl::Event event;
    std::uint64_t before, after;  ///< being queued, on the host's clock
  };
  struct Phase {
    std::string name;
    std::uint64_t begin;
  };
  static constexpr std::size_t kept_launches = 4096;
  static std::uint64_t now() {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
            .count());
  }
  void tell_launches();
  void tell(const std::string& name, bool on_device, std::uint64_t begin, std::uint64_t end) const;

  Trace sink_;
  std::string device_;
  std::uint32_t device_number_ = 0;
  std::vector<Phase> phases_;
  std::vector<Launch> launches_;
  std::uint64_t told_until_ = 0;  ///< launches run one after the other
  /// Host's clock minus device's lies between these.
  std::int64_t least_offset_ = INT64_MIN, most_offset_ = INT64_MAX;
};

}  // namespace gcdt::runtime
