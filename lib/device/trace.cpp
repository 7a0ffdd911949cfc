// SPDX-License-Identifier: Apache-2.0
#include "device/trace.hpp"

namespace gcdt::runtime {

void Tracer::begin_phase(const char* name) {
  if (!on()) return;
  phases_.push_back({name, now()});
  // Launches that are not told yet may have run before an inner phase began.
  if (phases_.size() == 1) told_until_ = std::max(told_until_, phases_.back().begin);
}

void Tracer::end_phase() {
  if (!on() || phases_.empty()) return;
  tell_launches();
  const Phase phase = phases_.back();
  tell(phase.name, false, phase.begin, now());
  phases_.pop_back();
}

void Tracer::clear() {
  phases_.clear();
  launches_.clear();
}

void Tracer::tell_launches() {
  struct Times {
    cl_ulong queued = 0, start = 0, end = 0;
  };
  std::vector<std::pair<const Launch*, Times>> timed;
  for (const Launch& launch : launches_) {
    Times t;
    // A driver without profiling refuses, or tells 0, 1, 2, 3 (Mesa 22.3): its launches have no spans.
    if (launch.event.getProfilingInfo(CL_PROFILING_COMMAND_QUEUED, &t.queued) != CL_SUCCESS ||
        launch.event.getProfilingInfo(CL_PROFILING_COMMAND_START, &t.start) != CL_SUCCESS ||
        launch.event.getProfilingInfo(CL_PROFILING_COMMAND_END, &t.end) != CL_SUCCESS || t.queued == 0)
      continue;
    least_offset_ = std::max(least_offset_, static_cast<std::int64_t>(launch.before - t.queued));
    most_offset_ = std::min(most_offset_, static_cast<std::int64_t>(launch.after - t.queued));
    timed.emplace_back(&launch, t);
  }
  // Clocks that drift apart may leave no offset that fits all launches; the error is then as small as the drift.
  const std::int64_t offset = least_offset_ / 2 + most_offset_ / 2;
  const std::uint64_t latest = now();
  for (const auto& [launch, t] : timed) {
    // What is known is kept whatever the clocks say: launches follow each other, after the phase began and before now.
    const std::uint64_t begin = std::min(std::max(t.start + static_cast<std::uint64_t>(offset), told_until_), latest);
    const std::uint64_t end = std::min(std::max(t.end + static_cast<std::uint64_t>(offset), begin), latest);
    tell(*launch->kernel, true, begin, end);
    told_until_ = end;
  }
  launches_.clear();
}

void Tracer::tell(const std::string& name, bool on_device, std::uint64_t begin, std::uint64_t end) const {
  sink_({device_, device_number_, phases_.empty() ? "" : phases_.front().name, name, on_device, begin, end});
}

}  // namespace gcdt::runtime
