// SPDX-License-Identifier: Apache-2.0
// The statistics of a batch, as JSON and as a table.
#pragma once

#include <gcdt/gcdt_pool.hpp>
#include <string>
#include <vector>

namespace gcdt::command {

/// What the library does not count.
struct Told {
  std::size_t inputs = 0, failed = 0;
  SplitReport split;  ///< of all inputs; the largest move
  std::uint64_t rounded_together = 0;
  std::uint64_t refine_added = 0;     ///< of vertices added those of refinement
  std::size_t refine_incomplete = 0;  ///< inputs whose refinement the limit of vertices ended
  double read = 0, write = 0;
  std::vector<std::string> plans;  ///< of each device: how the pool uses it, as the library's log says
};

void add(const SplitReport& one, SplitReport& all);

std::string statistics_json(const Told& told, const gcdt_batch_statistics& s, const Pool& pool);
std::string statistics_table(const Told& told, const gcdt_batch_statistics& s, const Pool& pool);

}  // namespace gcdt::command
