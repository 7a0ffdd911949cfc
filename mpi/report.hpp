// SPDX-License-Identifier: Apache-2.0
// What gcdt_mpi says of a run: the statistics, and what each step took each rank.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "mpi_team.hpp"
#include "tiles/ranks.hpp"

namespace gcdt::ranks {

/// The steps of a rank, in their order. `exchange` is a part of `share`; `solve` is all but reading and writing.
inline constexpr std::array<const char*, 9> step_names = {"read",  "share", "exchange", "tiles", "seam",
                                                          "final", "join",  "solve",    "write"};

/// Of one rank; numbers, so that it is a message.
struct RankReport {
  std::array<double, step_names.size()> milliseconds{};
  std::uint64_t vertices = 0, triangles = 0, seam_vertices = 0, seam_constraints = 0, tiles = 0;
  std::uint64_t sent = 0, received = 0;  ///< bytes of the last solving
  std::uint64_t peak_host_bytes = 0;     ///< of the process, so far
  std::array<char, 64> device{}, host{};
};

class Report {
 public:
  explicit Report(MpiTeam& team);
  double& step(const std::string& name);
  /// What triangulate_rank() has measured.
  void add(const tiles::RankResult& made, const DevicePool& pool, double milliseconds);
  /// Of all ranks, at the first one.
  std::vector<RankReport> gathered();

 private:
  MpiTeam& team_;
  RankReport own_;
  std::uint64_t sent_before_ = 0, received_before_ = 0;
};

/// Adds the devices and the times of the slowest rank.
void describe(const std::vector<RankReport>& ranks, Statistics& statistics);

std::string report_json(const Statistics& statistics, const std::vector<RankReport>& ranks);
std::string report_table(const Statistics& statistics, const std::vector<RankReport>& ranks);

}  // namespace gcdt::ranks
