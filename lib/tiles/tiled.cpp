// SPDX-License-Identifier: Apache-2.0
#include "tiles/tiled.hpp"

#include <numeric>

#include "batch/single.hpp"
#include "device/step.hpp"
#include "phases/crossings.hpp"
#include "tiles/domain.hpp"
#include "tiles/result_room.hpp"
#include "tiles/routes.hpp"

namespace gcdt::tiles {

namespace {

/// The seam is too large for every device. More tiles do not help: they have more seam.
struct SeamTooLarge : Error {
  using Error::Error;
};

/// Vertices of a tile at least, where tiles are made for want of memory: smaller ones are mostly seam.
constexpr std::size_t least_of_tile = 4096;

/// Shares of the whole that progress is told by.
constexpr double tiles_share = 0.7, seam_share = 0.9;

class Tiled {
 public:
  Tiled(DevicePool& pool, const GridInput& input, Staged& staged, const Cuts& cuts, const Options& options,
        TiledReport& report)
      : pool_(pool), task_{input, staged, cuts, options.check}, options_(options), report_(report) {
    own_.grid = FixedGrid{0, 0, "1"};  // the seam is in cells of the common grid
    own_.check = options.check;
    report_.tiles = static_cast<std::uint32_t>(cuts.tiles());
  }

  ForestResult solve() {
    ResultRoom room(pool_, task_.input.n());
    std::vector<std::uint32_t> dropped;
    std::vector<Role> roles;
    const std::vector<Constraint> crossings = solve_parts(roles);
    if (!crossings.empty()) {
      if (options_.crossing == Crossing::reject) throw crossings_of(crossings);
      if (options_.crossing == Crossing::split) return split(crossings);
      dropped = drop_crossing(crossings);
      roles.assign(task_.input.constraints.size(), Role::any);
      for (const std::uint32_t c : dropped) roles[c] = Role::out;
      solve_uncrossed(roles);
    }
    ForestResult joined = write(room, roles, dropped);
    joined.statistics.crossings = crossings.size();
    const Timed timed(report_.ms_join);
    const bool wants_regions = options_.regions || options_.domain != Domain::hull;
    if (wants_regions && joined.statistics.triangles > 0) select_domain(task_.input, options_, joined);
    return joined;
  }

  /// Of all vertices that were given.
  std::uint64_t move_key() const { return tiles_.empty() ? 0 : tiles_[0].move_key; }
  /// Vertices that rounding has made one with a lesser one.
  RoundedTogether together() const {
    const Points& points = task_.input.given;
    RoundedTogether found;
    for (const SolvedTile& tile : tiles_)
      for (const auto& [v, r] : tile.merged) {
        if (v >= points.size()) continue;
        if (points.coordinate(v, 0) == points.coordinate(r, 0) && points.coordinate(v, 1) == points.coordinate(r, 1))
          continue;
        if (found.count++ == 0 || v < found.first[1]) found.first = {r, v};
      }
    return found;
  }

 private:
  /// The seam's run finds the added vertices and the routes; with these, which do not cross, all is solved once more
  /// (docs/scale.md, T6).
  ForestResult split(const std::vector<Constraint>& crossings) {
    Routed routed = route(crossings);
    Options options = options_;
    options.crossing = Crossing::reject;
    const GridInput& given = task_.input;
    const GridInput input{given.given, given.chosen, std::move(routed.added), Constraints(routed.constraints),
                          given.box};
    tiles_.clear();
    ForestResult joined = solve_again(input, options);
    auto* sources = elements_of<std::uint32_t>(joined, GCDT_SOURCES);
    for (std::size_t i = 0; i < joined.begins[GCDT_SOURCES].back(); ++i) sources[i] = routed.owners[sources[i]];
    std::copy(input.added.begin(), input.added.end(), room<GridPoint>(joined, GCDT_ADDED, input.added.size()));
    std::copy(routed.crossing.begin(), routed.crossing.end(),
              room<Constraint>(joined, GCDT_ADDED_CROSSINGS, input.added.size()));
    Statistics& s = joined.statistics;
    s.n = given.n(), s.m = given.constraints.size();
    s.crossings = crossings.size(), s.vertices_added = input.added.size();
    s.constraints_split = routed.count, s.constraint_move = routed.largest_move;
    return joined;
  }
  ForestResult solve_again(const GridInput& input, const Options& options) {
    Tiled again(pool_, input, task_.staged, task_.cuts, options, report_);
    ForestResult joined = again.solve();
    tiles_ = std::move(again.tiles_);
    return joined;
  }

  /// The constraints that cross are wide, so that the seam has all that may be near their routes; and so are those that
  /// cross a route, which only the seam's run can tell. Ends: each round has more wide ones.
  Routed route(const std::vector<Constraint>& crossings) {
    own_.crossing = Crossing::split;
    std::vector<Role> roles(task_.input.constraints.size(), Role::any);
    for (const Constraint& pair : crossings) roles[pair[0]] = roles[pair[1]] = Role::wide;
    std::vector<bool> is_routed;
    for (bool more = true; more;) {
      solve_parts(roles);
      more = false;
      is_routed.assign(roles.size(), false);
      for (const std::uint32_t marked : made_seam().routed)
        for (const std::uint32_t c : seam_.sources_of(marked, tiles_)) {
          more = more || roles[c] != Role::wide;
          roles[c] = Role::wide;
          is_routed[c] = true;
        }
    }
    Routed routed = take_routes(task_.input, {seam_, tiles_, made_seam()}, is_routed);
    routed.largest_move = made_seam().statistics.constraint_move * task_.input.chosen.grid.cell();
    return routed;
  }

  const ForestResult& made_seam() const { return *made_seam_.at(0).first; }

  /// Tiles and seam. Returns the pairs of constraints that cross, of which each has one that is open, or was dropped in
  /// its tile and so handed up to the seam (docs/scale.md, T3).
  std::vector<Constraint> solve_parts(const std::vector<Role>& roles) {
    Partition all;
    {
      const Timed timed(report_.ms_share);
      all = partition(task_.input, task_.cuts, roles);
    }
    {
      const Timed timed(report_.ms_tiles);
      solve_tiles(all);
    }
    const Timed timed(report_.ms_seam);
    seam_ = make_seam(task_, all.open, tiles_);
    report_.seam_vertices = seam_.points.size();
    report_.seam_constraints = seam_.constraints.size();
    return solve_seam();
  }
  void solve_uncrossed(const std::vector<Role>& roles) {
    if (!solve_parts(roles).empty()) throw Error(Status::check_failed, "tiles: constraints still cross after dropping");
  }

  /// Every tile, by whichever device takes it; and once more those that a device had when it was lost. Ends: it is lost
  /// for good.
  void solve_tiles(const Partition& all) {
    tiles_.clear();
    tiles_.resize(task_.cuts.tiles());
    std::vector<std::uint32_t> wanted(tiles_.size());
    std::iota(wanted.begin(), wanted.end(), 0u);
    while (!wanted.empty()) {
      std::vector<std::uint64_t> n{0}, m{0};
      for (const std::uint32_t t : wanted) {
        n.push_back(n.back() + task_.input.n() / tiles_.size() + all.tiles[t].foreign.size());
        m.push_back(m.back() + all.tiles[t].constraints.size());
      }
      const BatchInput sizes{wanted.size(), Points::Type::int32, nullptr, n.data(), nullptr, m.data()};
      std::mutex mutex;
      std::vector<bool> is_solved(tiles_.size(), false);
      run("tiles", 0, tiles_share, sizes, DevicePool::Who::all, [&](DevicePool::Lent& lent, std::uint32_t problem) {
        const std::uint32_t t = wanted[problem];
        make_room(lent, sizes.n(problem), sizes.m(problem));
        SolvedTile solved = solve_tile(lent, task_, all.tiles[t], t);
        const std::lock_guard<std::mutex> lock(mutex);
        if (!is_solved[t]) tiles_[t] = std::move(solved), is_solved[t] = true;  // else another device was faster
        return ForestResult();
      });
      wanted.clear();
      for (std::uint32_t t = 0; t < tiles_.size(); ++t)
        if (tiles_[t].final.on_device() && pool_.report(tiles_[t].device).lost) wanted.push_back(t);
    }
  }

  /// Spills tiles of the device if the next one might not fit beside them; and if that is not enough, gives back what
  /// can be had again, which takes longer for the whole input than for a tile. A device's tiles are touched by its
  /// thread alone.
  void make_room(DevicePool::Lent& lent, std::uint64_t n, std::uint64_t m) {
    const auto fits = [&] { return lent.runtime.meter().now + forest_bytes(1, n, m) <= lent.capacity; };
    for (SolvedTile& tile : tiles_)
      if (!fits() && tile.final.on_device() && tile.device == lent.device) tile.final.spill(lent.runtime);
    if (!fits()) task_.staged.leave(lent.device);
  }

  std::vector<Constraint> solve_seam() {
    const std::uint64_t n[2] = {0, seam_.points.size()}, m[2] = {0, seam_.constraints.size()};
    const BatchInput problem{1, Points::Type::int32, seam_.points.data(), n, seam_.constraints.data(), m};
    try {
      made_seam_ = {};
      const auto solve = [&](DevicePool::Lent& lent, std::uint32_t) {
        return triangulate_single(lent.runtime, lent.primitives, problem, 0, own_);
      };
      made_seam_ = run("seam", tiles_share, seam_share, problem, DevicePool::Who::gpus, solve);
    } catch (const Error& error) {
      if (error.status() == Status::constraints_cross) return pairs_of(error.indices());
      if (error.status() != Status::out_of_memory) throw;
      throw SeamTooLarge(error.status(), "the seam between " + std::to_string(tiles_.size()) + " tiles, of " +
                                             std::to_string(seam_.points.size()) + " vertices and " +
                                             std::to_string(seam_.constraints.size()) +
                                             " constraints: " + error.what());
    }
    if (own_.crossing == Crossing::reject) between_ = take_seam(seam_, ProblemMesh(made_seam()));
    return {};
  }

  /// The devices write final triangles, and the host the rest. If a device is lost, all is solved again without it.
  ForestResult write(ResultRoom& room, const std::vector<Role>& roles, const std::vector<std::uint32_t>& dropped) {
    for (;;) {
      if (!tell("join", seam_share)) throw Error(Status::cancelled, "cancelled during join");
      const Solved solved{task_, tiles_, seam_, between_};
      Order order(solved);
      ForestResult joined = room.take(order.triangles());
      if (write_tiles(order, joined)) {
        const Timed timed(report_.ms_join);
        join(solved, order, dropped, joined);
        return joined;
      }
      solve_uncrossed(roles);
    }
  }

  bool write_tiles(Order& order, ForestResult& joined) {
    const Timed timed(report_.ms_write);
    std::atomic<std::size_t> next_spilled{0};
    const bool all = pool_.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) {
      const auto write_one = [&](std::size_t t) {
        FinalTriangles& final = tiles_[t].final;
        task_.staged.leave(lent.device);
        order.set_before(t, write_tile(lent, final, order.places_of(t), elements_of<Triangle>(joined, GCDT_TRIANGLES),
                                       elements_of<Neighbours>(joined, GCDT_NEIGHBOURS),
                                       elements_of<std::uint8_t>(joined, GCDT_CONSTRAINED)));
        final.release();
      };
      for (std::size_t t = 0; t < tiles_.size(); ++t)
        if (tiles_[t].final.on_device() && tiles_[t].device == lent.device) write_one(t);
      // Ends: each of them is taken once.
      for (std::size_t t = next_spilled++; t < tiles_.size(); t = next_spilled++)
        if (tiles_[t].final.is_spilled()) write_one(t);
    });
    // A device may have been lost since it solved a tile.
    return all && std::none_of(tiles_.begin(), tiles_.end(), [](const SolvedTile& tile) {
             return tile.final.on_device() || tile.final.is_spilled();
           });
  }

  /// Throws the error of the first problem that has one.
  PoolResult run(const char* phase, double from, double to, const BatchInput& sizes, DevicePool::Who who,
                 const DevicePool::MakeOne& make) {
    Options options;
    options.progress = [&](const char*, double done) { return tell(phase, from + (to - from) * done); };
    PoolResult made = pool_.make_each(sizes, options, who, make);
    if (!made.errors.empty()) throw made.errors.begin()->second;
    return made;
  }

  bool tell(const char* phase, double done) const { return !options_.progress || options_.progress(phase, done); }

  /// Of pairs of the seam's constraints those of the input, the smaller number first, ascending. Two straight
  /// constraints meet in one point, so each pair occurs once.
  std::vector<Constraint> pairs_of(const std::vector<std::uint64_t>& indices) const {
    std::vector<Constraint> pairs;
    for (std::size_t i = 0; i + 1 < indices.size(); i += 2)
      for (const std::uint32_t c : seam_.sources_of(indices[i], tiles_))
        for (const std::uint32_t d : seam_.sources_of(indices[i + 1], tiles_))
          pairs.push_back({std::min(c, d), std::max(c, d)});
    if (pairs.empty()) throw Error(Status::check_failed, "tiles: a constraint crosses the border of final triangles");
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

  Error crossings_of(const std::vector<Constraint>& pairs) const {
    const auto ends = [&](std::uint32_t c) { return task_.input.constraints[c]; };
    return crossings_error(pairs, ends, task_.input.chosen.grid.kind == Grid::Kind::rounded);
  }

  DevicePool& pool_;
  const TileTask task_;
  const Options& options_;
  TiledReport& report_;
  Options own_;
  std::vector<SolvedTile> tiles_;
  PoolResult made_seam_;
  Seam seam_;
  SolvedSeam between_;
};

}  // namespace

ForestResult triangulate_cut(DevicePool& pool, const BatchInput& batch, const Options& options, std::size_t tiles,
                             const std::function<Cuts(const GridInput&)>& cut) {
  const Points points = part_of(batch.type, batch.vertices, static_cast<std::size_t>(batch.vertex_offsets[0]),
                                static_cast<std::size_t>(batch.n(0)));
  const Constraints constraints = {batch.constraints + batch.constraint_offsets[0],
                                   static_cast<std::size_t>(batch.m(0))};
  check_vertex_count(points.size());
  TiledReport report;
  GridInput input;
  Staged staged(pool, points, tiles);
  std::optional<Cuts> cuts;
  {
    const Timed timed(report.ms_share);
    Survey surveyed;
    const ChosenGrid chosen = staged.choose(options.grid, surveyed);
    input = place(points, constraints, chosen, surveyed);
    cuts = cut(input);
    check_ends(input);
  }
  Tiled tiled(pool, input, staged, *cuts, options, report);
  ForestResult joined = tiled.solve();
  Grid grid = input.chosen.grid;
  grid.largest_move = move_of(input, tiled.move_key());
  joined.problems = {0};
  joined.grids = {grid};
  joined.tiles = report;
  joined.statistics.grid = grid;
  if (may_round_together(grid)) joined.together = {tiled.together()};
  if (options.distinct && !joined.together.empty() && joined.together[0].count > 0)
    throw together_error(joined.together[0]);
  return joined;
}

namespace {

BatchInput one_of(const BatchInput& batch, std::uint32_t problem) {
  BatchInput one = batch;
  one.problems = 1;
  one.vertex_offsets += problem, one.constraint_offsets += problem;
  return one;
}

/// Returns whether more tiles might do, because one was too large.
bool solve_in_tiles(DevicePool& pool, const BatchInput& batch, std::uint32_t problem, const Options& options,
                    std::size_t tiles, PoolResult& all) {
  try {
    ForestResult made = triangulate_cut(pool, one_of(batch, problem), options, tiles,
                                        [&](const GridInput& input) { return even_cuts(input, tiles); });
    made.problems = {problem};
    all.errors.erase(problem);
    all.places[problem] = {static_cast<std::uint32_t>(all.results.size()), 0};
    all.results.push_back(std::move(made));
  } catch (const SeamTooLarge& error) {
    all.errors.insert_or_assign(problem, error);
  } catch (const Error& error) {
    if (!is_of_problem(error.status())) throw;
    all.errors.insert_or_assign(problem, error);
    return error.status() == Status::out_of_memory;
  }
  return false;
}

/// So many tiles that each fits the pool's largest device, with a quarter to spare for tiles that are larger than
/// others and the ends of constraints that pass. Ends: a tile needs less memory than its problem.
std::size_t tiles_that_fit(const DevicePool& pool, std::uint64_t n, std::uint64_t m) {
  std::size_t tiles = 2;
  while (tiles < GCDT_MAX_TILES && forest_bytes(1, n / tiles, m / tiles) > pool.capacity() / 5 * 4) ++tiles;
  return tiles;
}

}  // namespace

PoolResult triangulate(DevicePool& pool, const BatchInput& batch, const Options& options) {
  if (options.tiles <= 1) {
    PoolResult all = pool.triangulate(batch, options);
    if (options.tiles == 1) return all;
    std::vector<std::uint32_t> too_large;
    for (const auto& [problem, error] : all.errors)
      if (error.status() == Status::out_of_memory) too_large.push_back(problem);
    for (const std::uint32_t problem : too_large) {
      const std::uint64_t n = batch.n(problem);
      // A tile may turn out to need more than its size says; then more are tried, as long as they are worth it.
      for (std::size_t tiles = tiles_that_fit(pool, n, batch.m(problem)); tiles * least_of_tile <= n; tiles *= 2)
        if (!solve_in_tiles(pool, batch, problem, options, tiles, all)) break;
    }
    return all;
  }
  if (!options.hole_seeds.empty() || !options.region_seeds.empty())
    throw Error(Status::invalid_argument, "hole and region seeds are not taken with tiles");
  if (options.grid) fixed_grid(*options.grid);
  const auto start = std::chrono::steady_clock::now();
  PoolResult all;
  all.places.resize(batch.problems);
  for (std::uint32_t problem = 0; problem < batch.problems; ++problem)
    solve_in_tiles(pool, batch, problem, options, options.tiles, all);
  all.milliseconds = milliseconds_since(start);
  return all;
}

}  // namespace gcdt::tiles
