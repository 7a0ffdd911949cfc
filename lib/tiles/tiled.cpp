// SPDX-License-Identifier: Apache-2.0
#include "tiles/tiled.hpp"

#include "device/parts.hpp"
#include "device/step.hpp"
#include "phases/clean.hpp"
#include "phases/pinned_input.hpp"
#include "tiles/domain.hpp"
#include "tiles/tiled_run.hpp"

namespace gcdt::tiles {

namespace {

/// Vertices of a tile at least, where tiles are made for want of memory: smaller ones are mostly seam.
constexpr std::size_t least_of_tile = 4096;
/// So many times as many tiles as must be, for the input and a tile that leaves to have room beside the next one: the
/// seam grows with the root of their number.
constexpr std::size_t most_tiles_for_room = 2;

}  // namespace

namespace {

/// Threads that look through all ends of constraints while the vertices are sent: few, if the host copies these at the
/// same time.
constexpr std::size_t threads_for_ends = 4, threads_for_ends_of_pinned = 16;

/// Waits for what is under way, whatever happens.
struct RestingStaged {
  const Staged& staged;
  ~RestingStaged() { staged.rest(); }
};

}  // namespace

void take_survey(GridInput& input, const Survey& surveyed, Team& team) {
  if (some_outside(input.chosen, surveyed)) check_outside(team.greatest(outside_of(input)));
  input.box = box_of(input.chosen, surveyed);
}

void check_ends(const GridInput& input, Team& team) {
  if (team.sum(has_good_ends(input, threads_for_ends) ? 0 : 1) == 0) return;
  const std::uint64_t bad = ~team.greatest(~first_bad_end(input));
  throw index_error(bad / 2, bad % 2, input.n());
}

void describe(TiledRun& run, const GridInput& input, const Options& options, const TiledReport& report,
              ForestResult& joined) {
  Grid grid = input.chosen.grid;
  grid.largest_move = run.largest_move();
  joined.problems = {0};
  joined.grids = {grid};
  joined.tiles = report;
  joined.statistics.grid = grid;
  if (may_round_together(grid)) joined.together = {run.together()};
  if (options.distinct && !joined.together.empty() && joined.together[0].count > 0)
    throw together_error(joined.together[0]);
}

ForestResult triangulate_cut(DevicePool& pool, const BatchInput& batch, const Options& options, std::size_t tiles,
                             const std::function<Cuts(const GridInput&)>& cut) {
  const Points points = part_of(batch.type, batch.vertices, static_cast<std::size_t>(batch.vertex_offsets[0]),
                                static_cast<std::size_t>(batch.n(0)));
  const Constraints constraints = {batch.constraints + batch.constraint_offsets[0],
                                   static_cast<std::size_t>(batch.m(0))};
  check_vertex_count(points.size());
  std::optional<Crew> crew;
  if (points.size() >= Tuning::least_prepared_vertices)  // what is less is not worth the threads
    crew.emplace(std::min<std::size_t>(Tuning::most_of_crew, std::max(1u, std::thread::hardware_concurrency()) - 1));
  Team alone;
  TiledReport report;
  GridInput input{{points, 0, {}, points.size()}, {}, {}, {constraints, 0, {}, constraints.size(), {}}, {}};
  Staged staged(pool, points, tiles);
  std::optional<Cuts> cuts;
  const std::vector<Role> any_role;
  auto constraints_sent = std::make_unique<StagedConstraints>(pool, staged, input, any_role, tiles);
  const RestingStaged resting{staged};  // who sends uses them
  {
    const Timed timed(report.ms_share);
    const std::size_t threads = options.pinned ? threads_for_ends_of_pinned : threads_for_ends;
    bool good_ends = true;  // looked for beside the transfers of the vertices
    std::future<void> looking = begin_in_thread([&] { good_ends = has_good_ends(input, threads); });
    Survey surveyed;
    input.chosen = staged.choose(options.grid, surveyed, 0, alone,
                                 [&](DevicePool::Lent& lent, auto& taker) { constraints_sent->send(lent, taker); });
    if (points.size() > 0) take_survey(input, surveyed, alone);
    cuts = cut(input);
    looking.get();
    staged.settle();
    if (!good_ends) check_ends(input, alone);
  }
  TiledRun run(pool, alone, input, staged, *cuts, options, report, std::move(constraints_sent));
  ForestResult joined = run.solve().result;
  if ((options.regions || options.domain != Domain::hull) && joined.statistics.triangles > 0) {
    const Timed timed(report.ms_join);
    select_domain(input, options, joined);
  }
  describe(run, input, options, report, joined);
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
    ForestResult made = triangulate_cut(pool, one_of(batch, problem), options, tiles, [&](const GridInput& input) {
      Team alone;
      return even_cuts(input, tiles, alone);
    });
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

std::optional<PinnedInput> pinned_input(DevicePool& pool, const BatchInput& batch, const Options& options) {
  if (batch.problems == 0) return std::nullopt;
  const auto count = [&](const std::uint64_t* offsets) {
    return static_cast<std::size_t>(offsets[batch.problems] - offsets[0]);
  };
  return std::optional<PinnedInput>(
      std::in_place, pool.pinned(),
      part_of(batch.type, batch.vertices, static_cast<std::size_t>(batch.vertex_offsets[0]),
              count(batch.vertex_offsets)),
      Constraints(batch.constraints + batch.constraint_offsets[0], count(batch.constraint_offsets)), options);
}

}  // namespace

std::size_t tiles_that_fit(const DevicePool& pool, std::uint64_t n, std::uint64_t m) {
  const auto tile_bytes = [&](std::size_t tiles) { return forest_bytes(1, n / tiles, m / tiles); };
  std::size_t least = 1;
  while (least < GCDT_MAX_TILES && tile_bytes(least) > pool.capacity() / 5 * 4) ++least;
  if (least == 1 || !pool.prepares_host_memory()) return least;
  const std::uint64_t input = 16 * n;
  for (std::size_t tiles = least; tiles <= std::min<std::size_t>(GCDT_MAX_TILES, most_tiles_for_room * least); ++tiles)
    if (input + FinalTriangles::bytes_that_leave(n / tiles) + tile_bytes(tiles) <= pool.capacity()) return tiles;
  return least;
}

PoolResult triangulate(DevicePool& pool, const BatchInput& batch, const Options& options) {
  const std::optional<PinnedInput> pinned = pinned_input(pool, batch, options);
  if (options.tiles <= 1) {
    PoolResult all = pool.triangulate(batch, options);
    if (options.tiles == 1) return all;
    std::vector<std::uint32_t> too_large;
    for (const auto& [problem, error] : all.errors)
      if (error.status() == Status::out_of_memory) too_large.push_back(problem);
    for (const std::uint32_t problem : too_large) {
      const std::uint64_t n = batch.n(problem);
      // A tile may turn out to need more than its size says; then more are tried, as long as they are worth it.
      for (std::size_t tiles = std::max<std::size_t>(2, tiles_that_fit(pool, n, batch.m(problem)));
           tiles * least_of_tile <= n; tiles *= 2)
        if (!solve_in_tiles(pool, batch, problem, options, tiles, all)) break;
    }
    return all;
  }
  check_seeds(options, batch.problems);
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
