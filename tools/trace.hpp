// SPDX-License-Identifier: Apache-2.0
// --trace: where the time went, in Chrome's trace-event format.
#pragma once

#include <gcdt/gcdt.hpp>

#include <mutex>
#include <string>
#include <vector>

namespace gcdt::command {

/// Keeps spans as they come, from any thread.
class TraceRecord {
 public:
  /// What a solver or pool is to call; the record must outlive it.
  Trace sink() {
    return [this](const TraceSpan& span) {
      const std::lock_guard<std::mutex> lock(mutex_);
      spans_.push_back(span);
    };
  }
  /// In the order in which they came; not while a solver or pool is in a call.
  const std::vector<TraceSpan>& spans() const { return spans_; }
  /// One process per device, one row in it per phase: the phase's span, its inner phases and its launches in it.
  /// Times are microseconds since the first span. Opens in Perfetto or chrome://tracing.
  std::string json() const;

 private:
  std::mutex mutex_;
  std::vector<TraceSpan> spans_;
};

}  // namespace gcdt::command
