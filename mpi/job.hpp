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
/// (watch_end()). Whoever is lost, all targets are then as they were before, or all are new: what stood there is kept
/// in the folder, too, until the last target has its name, and empty files there tell how far the first rank has come.
/// If nobody is left, each target is still the one or the other, and the last one is not new before all others are.
class OutputJob {
 public:
  /// All ranks name the same targets, in one folder that all see. Throws io::Failure.
  OutputJob(tiles::Team& team, std::vector<std::string> targets);
  OutputJob(const OutputJob&) = delete;
  /// Removes what was not committed.
  ~OutputJob();

  /// Where a rank writes the file that will have the name of target i.
  std::string temporary(std::size_t i) const { return (folder_ / ("new-" + std::to_string(i))).string(); }
  /// When all ranks have written: the first one gives the files their names, the last target its one last. If one
  /// cannot have its name, all get back what stood there.
  void commit();
  /// What is left to do for a process that ends: takes back what the first rank has named, unless that came to its end,
  /// and removes the folder.
  void abandon() noexcept;

 private:
  void rename_all();
  void take_back() noexcept;
  std::filesystem::path kept(std::size_t i) const { return folder_ / ("old-" + std::to_string(i)); }
  std::filesystem::path none(std::size_t i) const { return folder_ / ("none-" + std::to_string(i)); }
  // A file that has one of these names: by renaming it one rank alone goes on to what follows.
  std::filesystem::path is_open() const { return folder_ / "open"; }
  std::filesystem::path is_committing() const { return folder_ / "committing"; }
  std::filesystem::path is_ended() const { return folder_ / "ended"; }
  std::filesystem::path is_taken_back() const { return folder_ / "taken-back"; }  ///< the last new file

  tiles::Team& team_;
  std::vector<std::filesystem::path> targets_;
  std::filesystem::path folder_;
  bool has_taken_back_ = false;  ///< this rank did
};

/// To be called before there are other threads: from then on a thread waits for SIGINT, SIGTERM and SIGHUP, abandons
/// the output that is under way, and ends the process with Exit::interrupted.
void watch_end();

}  // namespace gcdt::ranks
