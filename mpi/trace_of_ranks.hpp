// SPDX-License-Identifier: Apache-2.0
// --trace of gcdt_mpi: the spans of all ranks in one file.
#pragma once

#include <string>

#include "mpi_team.hpp"
#include "trace.hpp"

namespace gcdt::ranks {

/// Each rank's spans count from one moment: when all ranks made the object. So the rows of two machines agree as well
/// as two ranks leave a barrier together.
class TraceOfRanks {
 public:
  explicit TraceOfRanks(MpiTeam& team);
  /// What the rank's pool is to call.
  Trace sink() { return own_.sink(); }
  /// Calls `use`, which is a step of the rank, and keeps when it ran.
  template <class Use>
  void step(const char* name, Use&& use) {
    const std::uint64_t begin = now();
    use();
    add(name, begin);
  }
  /// At the first rank the file, with a process for each rank's device; at others nothing. All ranks call it.
  std::string gathered() const;

 private:
  static std::uint64_t now();
  void add(const char* name, std::uint64_t begin);

  MpiTeam& team_;
  std::uint64_t origin_;
  command::TraceRecord own_;
};

}  // namespace gcdt::ranks
