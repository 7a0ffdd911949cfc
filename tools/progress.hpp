// SPDX-License-Identifier: Apache-2.0
// Long work: its progress on a terminal, and its end by an interrupt.
#pragma once

#include <chrono>

namespace gcdt::command {

/// From now on an interrupt (Ctrl-C) sets a flag instead of ending the process; a second one ends it.
void watch_interrupts();
bool interrupted();
/// Throws io::Failure (Exit::interrupted) after an interrupt.
void stop_if_interrupted();

/// Phase and percentage on one line of standard error, only if that is a terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(const char* phase, double done);
  void clear();

 private:
  bool wanted_, shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// Milliseconds since it was made.
class Stopwatch {
 public:
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace gcdt::command
