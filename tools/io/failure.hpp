// SPDX-License-Identifier: Apache-2.0
// What the command and its formats throw: one line for the user and the status to leave with.
#pragma once

#include <stdexcept>
#include <string>

namespace gcdt::io {

/// The command's status codes (docs/command.md).
enum class Exit { done = 0, usage = 2, input = 3, device = 4, check = 5, output = 6, interrupted = 130 };

class Failure : public std::runtime_error {
 public:
  Failure(Exit exit, const std::string& what) : std::runtime_error(what), exit_(exit) {}
  Exit exit() const { return exit_; }

 private:
  Exit exit_;
};

}  // namespace gcdt::io
