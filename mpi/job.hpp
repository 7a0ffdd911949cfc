// SPDX-License-Identifier: Apache-2.0
// How all ranks come to the same end: what one cannot do, none does; files get their names together, or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "io/failure.hpp"
#include "tiles/team.hpp"

namespace gcdt::ranks {

/// Calls `use`. If it throws io::Failure at some ranks, all ranks throw that of the first of them.
void all_or_none(tiles::Team& team, const std::function<void()>& use);

/// Output files of all ranks. They are written in a hidden folder beside the first one, which every rank knows, and
/// which the ranks that are left remove when one is lost: who is told to end (SIGTERM, from mpirun) does it
/// (watch_end()).
class OutputJob {
 public:
  /// All ranks name the same targets, in one folder that all see. Throws io::Failure.
  OutputJob(tiles::Team& team, std::vector<std::string> targets);
  OutputJob(const OutputJob&) = delete;
  /// Removes what was not committed.
  ~OutputJob();

  /// Where a rank writes the file that will have the name of target i.
  std::string temporary(std::size_t i) const { return (folder_ / ("new-" + std::to_string(i))).string(); }
  /// When all ranks have written: the first one gives the files their names, the last target its one last, and before
  /// that takes what stood there away. If one cannot have its name, all get back what stood there.
  void commit();
  /// What is left to do for a process that ends: removes the folder, unless the first rank was lost in the middle of
  /// commit(), which has the files from before in there.
  void abandon() noexcept;

 private:
  void rename_all();
  std::filesystem::path kept(std::size_t i) const { return folder_ / ("old-" + std::to_string(i)); }
  std::filesystem::path mark() const { return folder_ / "commit"; }

  tiles::Team& team_;
  std::vector<std::filesystem::path> targets_;
  std::filesystem::path folder_;
};

/// To be called before there are other threads: from then on a thread waits for SIGINT, SIGTERM and SIGHUP, abandons
/// the output that is under way, and ends the process with Exit::interrupted.
void watch_end();

}  // namespace gcdt::ranks
