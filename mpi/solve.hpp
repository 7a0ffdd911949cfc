// SPDX-License-Identifier: Apache-2.0
// gcdt_mpi: what it is asked for, and what each rank does.
#pragma once

#include <string>
#include <vector>

#include "mpi_team.hpp"

namespace gcdt::ranks {

struct Arguments {
  std::string input;
  std::vector<std::string> outputs;
  std::string crossing = "reject", domain = "hull", grid, device, statistics, trace, spill;
  bool quiet = false, regions = false, distinct = false, verify = false;
  std::uint32_t tiles = 0;   ///< of all ranks; 0: one a rank, or as many as its device's memory asks for
  std::uint64_t memory = 0;  ///< bytes of each device at most; 0: all
  std::uint32_t repeat = 1;
};

/// All ranks call it with the same arguments. Throws io::Failure and Error: what all ranks throw, or one.
void solve(MpiTeam& team, std::size_t rank_on_host, const Arguments& arguments);

}  // namespace gcdt::ranks
