// SPDX-License-Identifier: Apache-2.0
#include "tiles/tiled_run.hpp"

#include <numeric>

#include "batch/single.hpp"
#include "device/parts.hpp"
#include "device/step.hpp"
#include "phases/crossings.hpp"
#include "tiles/indices.hpp"
#include "tiles/spiller.hpp"

namespace gcdt::tiles {

namespace {

/// Shares of the whole that progress is told by.
constexpr double tiles_share = 0.7, seam_share = 0.9;

/// Of a tile of n vertices: so many constraints, or what has room if these have none: their number is an estimate, by
/// which no device may refuse what it could solve.
std::uint64_t constraints_to_try(std::uint64_t n, std::uint64_t expected, std::uint64_t capacity) {
  std::uint64_t low = 0, high = expected;
  if (forest_bytes(1, n, high) <= capacity) return expected;
  // Ends: the range halves. What is at `high` has no room.
  while (high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (forest_bytes(1, n, middle) <= capacity ? low : high) = middle;
  }
  return low;
}

}  // namespace

TiledRun::TiledRun(DevicePool& pool, Team& team, const GridInput& input, Staged& staged, const Cuts& cuts,
                   const Options& options, TiledReport& report, std::unique_ptr<StagedConstraints> sent)
    : pool_(pool),
      team_(team),
      task_{input, staged, cuts, options.check},
      options_(options),
      report_(report),
      range_(own_tiles(team, cuts.tiles())),
      room_(pool, input.given.points.size() + input.added.size(), team.is_alone() ? input.constraints.size() : 0),
      sent_(std::move(sent)) {
  own_.grid = FixedGrid{0, 0, "1"};  // the seam is in cells of the common grid
  own_.check = options.check;
  report_.tiles = static_cast<std::uint32_t>(cuts.tiles());
}

ResultPart TiledRun::solve() {
  std::vector<std::uint32_t> dropped;
  std::vector<Role> roles;
  const std::vector<Constraint> crossings = solve_parts(roles);
  if (!crossings.empty()) {
    if (options_.crossing == Crossing::reject) throw crossings_of(crossings);
    if (options_.crossing == Crossing::split) return split(crossings);
    dropped = drop_crossing(crossings);
    roles = roles_of(dropped, Role::out);
    solve_uncrossed(roles);
  }
  ResultPart part = write(roles, dropped);
  part.result.statistics.crossings = crossings.size();
  return part;
}

/// The seam's run finds the added vertices and the routes; with these, which do not cross, all is solved once more
/// (docs/scale.md, T6).
ResultPart TiledRun::split(const std::vector<Constraint>& crossings) {
  Routed routed = route(crossings);
  Options options = options_;
  options.crossing = Crossing::reject;
  const GridInput& given = task_.input;
  Replaced replaced(given.constraints, routed);
  const GridInput input{given.given, given.chosen, std::move(routed.added), std::move(replaced.constraints), given.box};
  tiles_.clear();
  ResultPart part = solve_again(input, options);
  ForestResult& joined = part.result;
  std::copy(input.added.begin(), input.added.end(), room<GridPoint>(joined, GCDT_ADDED, input.added.size()));
  std::copy(routed.crossing.begin(), routed.crossing.end(),
            room<Constraint>(joined, GCDT_ADDED_CROSSINGS, input.added.size()));
  Statistics& s = joined.statistics;
  s.n = given.n();
  s.crossings = crossings.size(), s.vertices_added = input.added.size();
  s.constraints_split = routed.owners.size(), s.constraint_move = routed.largest_move;
  return part;
}

ResultPart TiledRun::solve_again(const GridInput& input, const Options& options) {
  TiledRun again(pool_, team_, input, task_.staged, task_.cuts, options, report_);
  ResultPart part = again.solve();
  tiles_ = std::move(again.tiles_);
  return part;
}

/// The constraints that cross are wide, so that the seam has all that may be near their routes; and so are those that
/// cross a route, which only the seam's run can tell. Ends: each round has more wide ones.
Routed TiledRun::route(const std::vector<Constraint>& crossings) {
  own_.crossing = Crossing::split;
  std::vector<std::uint32_t> wide, owners;
  for (const Constraint& pair : crossings) wide.insert(wide.end(), pair.begin(), pair.end());
  sort_unique(wide);
  for (std::size_t before = 0; before < wide.size();) {
    before = wide.size();
    solve_parts(roles_of(wide, Role::wide));
    if (team_.is_first()) check_split_seam();
    owners.clear();
    for (std::size_t i = 0; team_.is_first() && i < made_seam_.routed.size(); ++i) {
      const std::vector<std::uint32_t> sources = seam_.sources_of(made_seam_.routed[i], tiles_);
      owners.insert(owners.end(), sources.begin(), sources.end());
    }
    sort_unique(owners);
    broadcast(team_, owners);
    wide.insert(wide.end(), owners.begin(), owners.end());
    sort_unique(wide);
  }
  Routed routed;
  std::vector<double> move(1, 0);
  if (team_.is_first()) {
    routed = take_routes(task_.input.n(), {seam_, tiles_, open_, made_seam_}, owners);
    move[0] = made_seam_.statistics.constraint_move * task_.input.chosen.grid.cell();
  }
  routed.owners = std::move(owners);
  broadcast(team_, routed.added);
  broadcast(team_, routed.crossing);
  broadcast(team_, routed.links);
  broadcast(team_, move);
  routed.largest_move = move[0];
  return routed;
}

/// What splitting the seam has told, before it is used as indices.
void TiledRun::check_split_seam() const {
  const std::size_t constraints = seam_.constraints.size();
  const auto added = array_of<GridPoint>(made_seam_, GCDT_ADDED);
  ProblemMesh(made_seam_).check(seam_.points.size() + added.size(), constraints);
  check_below(made_seam_.routed, constraints, "a constraint with a route is none of the seam");
  const auto crossing = array_of<Constraint>(made_seam_, GCDT_ADDED_CROSSINGS);
  if (crossing.size() != added.size()) refuse("an added vertex has no crossing");
  check_each(crossing.size(), "an added vertex is not where two constraints cross", [&](std::size_t i) {
    const auto is_of_input = [&](std::uint32_t c) { return c >= seam_.first_part() && c < constraints; };
    return is_of_input(crossing[i][0]) && is_of_input(crossing[i][1]);
  });
}

/// The role for the constraints of these numbers, which ascend, that the rank has. Those have not been routed yet.
std::vector<Role> TiledRun::roles_of(const std::vector<std::uint32_t>& numbers, Role role) const {
  const GivenConstraints& given = task_.input.constraints;
  std::vector<Role> roles(given.size(), Role::any);
  for (const std::uint32_t c : numbers)
    if (c >= given.first && c - given.first < given.size()) roles[static_cast<std::size_t>(c - given.first)] = role;
  return roles;
}

/// Tiles and seam. Returns the pairs of constraints that cross, of which each has one that is open, or was dropped in
/// its tile and so handed up to the seam (docs/scale.md, T3).
std::vector<Constraint> TiledRun::solve_parts(const std::vector<Role>& roles) {
  tiles_.clear();  // those of an earlier round would take the devices' room
  std::unique_ptr<StagedConstraints> constraints = roles.empty() ? std::move(sent_) : nullptr;
  if (!constraints && team_.is_alone() && task_.input.constraints.end_points.empty())
    constraints = std::make_unique<StagedConstraints>(pool_, task_.staged, task_.input, roles, task_.cuts.tiles());
  task_.constraints = constraints.get();
  Partition all;
  {
    const Timed timed(report_.ms_share);
    all = share_out(roles);
  }
  {
    const Timed timed(report_.ms_tiles);
    solve_tiles(roles, all);
    constraints.reset(), task_.constraints = nullptr;
  }
  const Timed timed(report_.ms_seam);
  gather_tiles(team_, tiles_);
  std::vector<Constraint> crossings;
  if (team_.is_first()) {
    open_ = std::move(all.open);
    seam_ = make_seam(task_.cuts, open_, tiles_);
    report_.seam_vertices = seam_.points.size();
    report_.seam_constraints = seam_.constraints.size();
  }
  for (SolvedTile& tile : tiles_) tile.leave_seam();
  if (team_.is_first()) crossings = solve_seam();
  broadcast(team_, crossings);
  return crossings;
}

/// By the devices, where the process has the whole input.
Partition TiledRun::share_out(const std::vector<Role>& roles) {
  const GridInput& input = task_.input;
  if (task_.constraints) {
    std::vector<std::uint64_t> expected;  // meanwhile
    std::future<void> expecting = begin_in_thread([&] { expected = expected_constraints(input, task_.cuts); });
    std::vector<OpenConstraint> open = find_open(pool_, task_.staged, *task_.constraints, input, task_.cuts, roles);
    expecting.get();
    return partition_open(input, task_.cuts, roles, std::move(open), expected);
  }
  Partition all = partition(input, task_.cuts, roles);
  exchange_shares(team_, all);
  return all;
}

void TiledRun::solve_uncrossed(const std::vector<Role>& roles) {
  if (!solve_parts(roles).empty()) throw Error(Status::check_failed, "tiles: constraints still cross after dropping");
}

/// Every tile of the rank, by whichever device takes it; and once more those that a device had when it was lost. Ends:
/// it is lost for good. A process by itself forgets a tile's share when it is solved, and makes it again.
void TiledRun::solve_tiles(const std::vector<Role>& roles, Partition& all) {
  tiles_.resize(task_.cuts.tiles());
  std::vector<std::shared_ptr<const Share>> shares(tiles_.size());
  const auto keep_shares = [&](std::vector<Share> given) {
    for (std::size_t t = 0; t < given.size(); ++t)
      if (!shares[t]) shares[t] = std::make_shared<const Share>(std::move(given[t]));
  };
  keep_shares(std::move(all.tiles));
  std::vector<std::uint32_t> wanted(range_.size());
  std::iota(wanted.begin(), wanted.end(), static_cast<std::uint32_t>(range_.first));
  Spiller spiller(pool_, task_.staged, room_, range_);
  while (!wanted.empty()) {
    std::vector<std::uint64_t> n{0}, m{0};
    for (const std::uint32_t t : wanted) {
      // A few foreign vertices do not count, so that equal tiles are solved in their order (expect_constraints()).
      const std::uint64_t even = task_.input.n() / tiles_.size(), foreign = shares[t]->foreign.size();
      n.push_back(n.back() + even + (foreign > even / 16 ? foreign : 0));
      const std::uint64_t known = shares[t]->constraints.size();
      m.push_back(
          m.back() +
          (known > 0 ? known : constraints_to_try(n.back() - n[n.size() - 2], shares[t]->expected, pool_.capacity())));
    }
    const BatchInput sizes{wanted.size(), Points::Type::int32, nullptr, n.data(), nullptr, m.data()};
    std::mutex mutex;
    std::vector<bool> is_solved(tiles_.size(), false);
    spiller.expect(wanted.size());
    run("tiles", DevicePool::Who::gpus, 0, tiles_share, sizes, [&](DevicePool::Lent& lent, std::uint32_t problem) {
      const std::uint32_t t = wanted[problem];
      std::shared_ptr<const Share> share;  // as long as it is needed here
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (is_solved[t]) return ForestResult();  // another device was faster
        share = shares[t];
      }
      spiller.make_room(lent, sizes.n(problem), std::max(sizes.m(problem), share->expected), task_.constraints);
      SolvedTile solved = solve_tile(lent, task_, *share, t);
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (is_solved[t]) return ForestResult();
        tiles_[t] = std::move(solved), is_solved[t] = true;
        if (team_.is_alone()) shares[t].reset();
      }
      spiller.add(lent, t, tiles_[t].final, sizes.n(problem), sizes.m(problem));
      return ForestResult();
    });
    if (spiller.goes_on()) pool_.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) { spiller.finish(lent); });
    wanted.clear();
    for (std::uint32_t t = 0; t < tiles_.size(); ++t)
      if (tiles_[t].final.on_device() && pool_.report(tiles_[t].device).lost) wanted.push_back(t);
    if (!wanted.empty() && team_.is_alone()) keep_shares(share_out(roles).tiles);
  }
}

std::vector<Constraint> TiledRun::solve_seam() {
  const std::uint64_t n[2] = {0, seam_.points.size()}, m[2] = {0, seam_.constraints.size()};
  const BatchInput problem{1, Points::Type::int32, seam_.points.data(), n, seam_.constraints.data(), m};
  try {
    made_seam_ = {};
    const auto solve = [&](DevicePool::Lent& lent, std::uint32_t) {
      return triangulate_single(lent.runtime, lent.primitives, problem, 0, own_);
    };
    PoolResult made = run("seam", DevicePool::Who::first, tiles_share, seam_share, problem, solve);
    const auto [result, place] = made.places.at(0);
    made_seam_ = std::move(made.results.at(result).singles.at(place));
  } catch (const Error& error) {
    if (error.status() == Status::constraints_cross) return pairs_of(error.indices());
    if (error.status() != Status::out_of_memory) throw;
    throw SeamTooLarge(error.status(), "the seam between " + std::to_string(tiles_.size()) + " tiles, of " +
                                           std::to_string(seam_.points.size()) + " vertices and " +
                                           std::to_string(seam_.constraints.size()) + " constraints: " + error.what());
  }
  if (own_.crossing == Crossing::reject) {
    between_ = take_seam(seam_, ProblemMesh(made_seam_), elements_of<Neighbours>(made_seam_, GCDT_NEIGHBOURS),
                         elements_of<std::uint8_t>(made_seam_, GCDT_CONSTRAINED));
    forget(seam_.constraints);
    if (!pool_.spill_directory().empty()) spill_seam();
  }
  return {};
}

/// To a file: until its triangles are given to the tiles, they are read in their order.
void TiledRun::spill_seam() {
  ProblemMesh& mesh = between_.mesh;
  const auto bytes_of = [](const auto& array) {
    return Span<unsigned char>(reinterpret_cast<const unsigned char*>(array.data()),
                               array.size() * sizeof(*array.data()));
  };
  seam_file_.emplace(pool_.spill_directory(),
                     std::vector<Span<unsigned char>>{bytes_of(mesh.triangles), bytes_of(mesh.neighbours),
                                                      bytes_of(mesh.constrained)});
  mesh.triangles = seam_file_->array<Triangle>(0);
  mesh.neighbours = seam_file_->array<Neighbours>(1);
  mesh.constrained = seam_file_->array<std::uint8_t>(2);
  for (const std::size_t array : {GCDT_TRIANGLES, GCDT_NEIGHBOURS, GCDT_CONSTRAINED}) made_seam_.arrays[array] = {};
}

/// By GPUs if there are some: a CPU beside them takes longer for one problem than they do for all, and takes cores from
/// the threads that feed them. By all if that fails for want of memory, or because GPUs are lost. Throws the error of
/// the first problem that has one.
PoolResult TiledRun::run(const char* phase, DevicePool::Who who, double from, double to, const BatchInput& sizes,
                         const DevicePool::MakeOne& make) {
  Options options;
  options.progress = [&](const char*, double done) { return tell(phase, from + (to - from) * done); };
  const auto by = [&](DevicePool::Who these) {
    PoolResult made = pool_.make_each(sizes, options, these, make);
    if (!made.errors.empty()) throw made.errors.begin()->second;
    return made;
  };
  const auto lost = [&] {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pool_.size(); ++i) count += pool_.report(i).lost.has_value();
    return count;
  };
  const std::size_t before = lost();
  try {
    return by(who);
  } catch (const Error& error) {
    if (error.status() == Status::cancelled) throw;
    const bool for_memory = error.status() == Status::out_of_memory;
    if (pool_.size() - lost() < (for_memory ? 2u : 1u) || (!for_memory && lost() == before)) throw;
  }
  return by(DevicePool::Who::all);
}

/// Of pairs of the seam's constraints those of the input, the smaller number first, ascending. Two straight
/// constraints meet in one point, so each pair occurs once.
std::vector<Constraint> TiledRun::pairs_of(const std::vector<std::uint64_t>& indices) const {
  std::vector<Constraint> pairs;
  check_below(indices, seam_.constraints.size(), "a constraint that crosses another one is none of the seam");
  for (std::size_t i = 0; i + 1 < indices.size(); i += 2)
    for (const std::uint32_t c : seam_.sources_of(indices[i], tiles_))
      for (const std::uint32_t d : seam_.sources_of(indices[i + 1], tiles_))
        pairs.push_back({std::min(c, d), std::max(c, d)});
  if (pairs.empty()) throw Error(Status::check_failed, "tiles: a constraint crosses the border of final triangles");
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Ranks have the ends of their own constraints: each gives what it has.
Error TiledRun::crossings_of(const std::vector<Constraint>& pairs) {
  const GivenConstraints& given = task_.input.constraints;
  std::vector<std::uint64_t> known;  // of the constraints of the pairs the ends, which are not 0
  for (const Constraint& pair : pairs)
    for (const std::uint32_t c : pair) {
      const std::uint64_t place = c - given.first;
      const bool is_own = c >= given.first && place < given.size();
      for (std::size_t end = 0; end < 2; ++end)
        known.push_back(is_own ? given.ends[static_cast<std::size_t>(place)][end] + std::uint64_t{1} : 0);
    }
  team_.raise(known.data(), known.size());
  std::map<std::uint32_t, Constraint> ends;
  for (std::size_t i = 0; i < 2 * pairs.size(); ++i)
    ends[pairs[i / 2][i % 2]] = {static_cast<std::uint32_t>(known[2 * i] - 1),
                                 static_cast<std::uint32_t>(known[2 * i + 1] - 1)};
  return crossings_error(
      pairs, [&](std::uint32_t c) { return ends.at(c); }, task_.input.chosen.grid.kind == Grid::Kind::rounded);
}

double TiledRun::largest_move() {
  std::uint64_t key = 0;
  for (const SolvedTile& tile : tiles_) key = std::max(key, tile.move_key);
  key = team_.greatest(key);
  const double own = move_of(task_.input, key);
  std::uint64_t bits;  // of doubles that are not negative: in their order
  std::memcpy(&bits, &own, sizeof bits);
  bits = team_.greatest(bits);
  double move;
  std::memcpy(&move, &bits, sizeof move);
  return move;
}

RoundedTogether TiledRun::together() {
  const GivenVertices& given = task_.input.given;
  std::uint64_t count = 0, first = 0;  // first: the complement of the least vertex and what stands for it
  for (const SolvedTile& tile : tiles_)
    for (const auto& [v, r] : tile.merged) {
      if (v >= given.count) continue;
      const std::size_t a = given.place_of(v), b = given.place_of(r);
      if (given.points.coordinate(a, 0) == given.points.coordinate(b, 0) &&
          given.points.coordinate(a, 1) == given.points.coordinate(b, 1))
        continue;
      ++count;
      first = std::max(first, ~(std::uint64_t{v} << 32 | r));
    }
  count = team_.sum(count), first = ~team_.greatest(first);
  if (count == 0) return {};
  return {count, {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(first >> 32)}};
}

}  // namespace gcdt::tiles
