// SPDX-License-Identifier: Apache-2.0
// gcdt minimise: from a graph for which a check fails to a small one for which it fails, too.
#pragma once

#include "command.hpp"

namespace gcdt::command {

struct MinimiseArguments {
  std::string input, output;
  std::string check;  ///< a command for a shell, {} in it the candidate; empty: `gcdt triangulate --verify`
  std::string crossing = "reject", domain = "hull", grid, device;
  double seconds = 60;  ///< a check that takes longer has failed
  std::uint64_t most_checks = 10000;
  bool quiet = false;
};

void minimise(const MinimiseArguments& arguments);

}  // namespace gcdt::command
