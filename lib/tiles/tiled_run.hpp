// SPDX-License-Identifier: Apache-2.0
// From a problem on its grid, and cuts, to the result, or to the part of it that a rank has (docs/scale.md).
#pragma once

#include "tiles/messages.hpp"
#include "tiles/result_room.hpp"
#include "tiles/routes.hpp"

namespace gcdt::tiles {

/// The seam is too large for every device. More tiles do not help: they have more seam.
struct SeamTooLarge : Error {
  using Error::Error;
};

/// Of a result what a rank has: the triangles of its tiles, and the pieces that begin there.
struct ResultPart {
  ForestResult result;             ///< without representatives, but of a rank by itself; `statistics` are of all
  std::uint32_t first = 0;         ///< the place of its first triangle among all
  std::vector<SeamTriangle> seam;  ///< its triangles that may have vertices of other tiles
  std::vector<Constraint> merged;  ///< the vertices that others stand for, and these; input numbers
};

class TiledRun {
 public:
  /// All ranks have the same cuts. Everything must outlive the object. The first rank's options tell progress. `sent`:
  /// the input's constraints, on their devices already; they are gone when the tiles have been solved.
  TiledRun(DevicePool& pool, Team& team, const GridInput& input, Staged& staged, const Cuts& cuts,
           const Options& options, TiledReport& report, std::unique_ptr<StagedConstraints> sent = {});

  /// Throws what gcdt::triangulate() does. What is said of the input, all ranks throw.
  ResultPart solve();

  // After that.
  /// The largest move of a coordinate.
  double largest_move();
  /// Vertices that rounding has made one with a lesser one.
  RoundedTogether together();

 private:
  ResultPart split(const std::vector<Constraint>& crossings);
  ResultPart solve_again(const GridInput& input, const Options& options);
  Routed route(const std::vector<Constraint>& crossings);
  void check_split_seam() const;
  std::vector<Role> roles_of(const std::vector<std::uint32_t>& numbers, Role role) const;

  std::vector<Constraint> solve_parts(const std::vector<Role>& roles);
  void solve_uncrossed(const std::vector<Role>& roles);
  Partition share_out(const std::vector<Role>& roles);
  void solve_tiles(const std::vector<Role>& roles, Partition& all);
  std::vector<Constraint> solve_seam();
  void spill_seam();

  ResultPart write(const std::vector<Role>& roles, const std::vector<std::uint32_t>& dropped);
  bool write_tiles(const OwnPlaces& places, std::vector<std::vector<std::uint32_t>>& before,
                   std::vector<TilePieces>& pieces, ForestResult& joined);
  void finish(const OwnPlaces& places, std::vector<std::vector<std::uint32_t>> before, std::vector<TilePieces> pieces,
              Order* order, ResultPart& part);
  std::vector<TilePieces> pieces_of_seam();
  void leave_pieces();
  void write_representatives(ForestResult& result) const;
  void count(const OwnPlaces& places, ForestResult& result);

  PoolResult run(const char* phase, DevicePool::Who who, double from, double to, const BatchInput& sizes,
                 const DevicePool::MakeOne& make);
  bool tell(const char* phase, double done) const { return !options_.progress || options_.progress(phase, done); }
  std::vector<Constraint> pairs_of(const std::vector<std::uint64_t>& indices) const;
  Error crossings_of(const std::vector<Constraint>& pairs);

  DevicePool& pool_;
  Team& team_;
  TileTask task_;
  const Options& options_;
  TiledReport& report_;
  Options own_;
  const TileRange range_;  ///< the tiles of this rank
  ResultRoom room_;
  std::unique_ptr<StagedConstraints> sent_;
  std::vector<SolvedTile> tiles_;
  // At the first rank.
  std::vector<OpenConstraint> open_;
  ForestResult made_seam_;
  Seam seam_;
  SolvedSeam between_;
  std::optional<SpilledArrays> seam_file_;  ///< the mesh of `between_`, if it is not in `made_seam_`
};

}  // namespace gcdt::tiles
