// SPDX-License-Identifier: Apache-2.0
#include "tiles/tiled.hpp"

#include "device/step.hpp"
#include "phases/crossings.hpp"
#include "tiles/domain.hpp"
#include "tiles/parts.hpp"
#include "tiles/routes.hpp"

namespace gcdt::tiles {

namespace {

/// Problems on a grid of integers, one after the other, as a batch.
class GridBatch {
 public:
  /// Room for so many of all problems together.
  GridBatch(std::size_t points, std::size_t constraints) {
    points_.reserve(points);
    constraints_.reserve(constraints);
  }
  void add(const GridPoints& points, const Array<Constraint>& constraints) {
    append(points_, points);
    append(constraints_, constraints);
    vertex_offsets_.push_back(points_.size());
    constraint_offsets_.push_back(constraints_.size());
  }
  BatchInput view() const {
    return {vertex_offsets_.size() - 1, Points::Type::int32, points_.data(),
            vertex_offsets_.data(),     constraints_.data(), constraint_offsets_.data()};
  }

 private:
  template <class T>
  static void append(Array<T>& to, const Array<T>& from) {
    const std::size_t before = to.size();
    to.resize(before + from.size());
    Parts(from.size()).run([&](std::size_t, std::size_t first, std::size_t end) {
      std::copy(from.begin() + static_cast<std::ptrdiff_t>(first), from.begin() + static_cast<std::ptrdiff_t>(end),
                to.begin() + static_cast<std::ptrdiff_t>(before + first));
    });
  }

  GridPoints points_;
  Array<Constraint> constraints_;
  std::vector<std::uint64_t> vertex_offsets_{0}, constraint_offsets_{0};
};

/// The seam is too large for every device. More tiles do not help: they have more seam.
struct SeamTooLarge : Error {
  using Error::Error;
};

/// Adds the time until its end.
class Timed {
 public:
  explicit Timed(double& ms) : ms_(ms) {}
  Timed(const Timed&) = delete;
  ~Timed() { ms_ += milliseconds_since(start_); }

 private:
  double& ms_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Vertices of a tile at least, where tiles are made for want of memory: smaller ones are mostly seam.
constexpr std::size_t least_of_tile = 4096;

/// Shares of the whole that progress is told by.
constexpr double tiles_share = 0.7, seam_share = 0.9;

class Tiled {
 public:
  Tiled(DevicePool& pool, const GridInput& input, const Grid& grid, const Cuts& cuts, const Options& options,
        TiledReport& report)
      : pool_(pool), input_(input), grid_(grid), cuts_(cuts), options_(options), report_(report) {
    own_.grid = FixedGrid{0, 0, "1"};  // tiles and seam are in cells of the common grid
    own_.check = options.check;
  }

  ForestResult solve() {
    std::vector<std::uint32_t> dropped;
    std::vector<Role> roles;
    const std::vector<Constraint> crossings = solve_parts(roles);
    if (!crossings.empty()) {
      if (options_.crossing == Crossing::reject) throw crossings_of(crossings);
      if (options_.crossing == Crossing::split) return split(crossings);
      dropped = drop_crossing(crossings);
      roles.assign(input_.constraints.size(), Role::any);
      for (const std::uint32_t c : dropped) roles[c] = Role::out;
      if (!solve_parts(roles).empty())
        throw Error(Status::check_failed, "tiles: constraints still cross after dropping");
    }
    if (!tell("join", seam_share)) throw Error(Status::cancelled, "cancelled during join");
    const Timed timed(report_.ms_join);
    const Solved solved{input_, all_, tiles_, seam_, between_};
    ForestResult joined = join(solved, dropped, options_.check);
    joined.statistics.crossings = crossings.size();
    const bool wants_regions = options_.regions || options_.domain != Domain::hull;
    if (wants_regions && joined.statistics.triangles > 0) select_domain(input_, options_, joined);
    return joined;
  }

 private:
  /// The seam's call finds the added vertices and the routes; with these, which do not cross, all is solved once more
  /// (docs/scale.md, T6).
  ForestResult split(const std::vector<Constraint>& crossings) {
    const Routed routed = route(crossings);
    Options options = options_;
    options.crossing = Crossing::reject;
    const GridInput input{routed.points, Constraints(routed.constraints)};
    ForestResult joined = Tiled(pool_, input, grid_, cuts_, options, report_).solve();
    auto* sources = reinterpret_cast<std::uint32_t*>(joined.arrays[GCDT_SOURCES].bytes.get());
    for (std::size_t i = 0; i < joined.begins[GCDT_SOURCES].back(); ++i) sources[i] = routed.owners[sources[i]];
    const std::size_t n = input_.points.size(), added = routed.points.size() - n;
    std::copy(routed.points.begin() + static_cast<std::ptrdiff_t>(n), routed.points.end(),
              room<GridPoint>(joined, GCDT_ADDED, added));
    std::copy(routed.crossing.begin(), routed.crossing.end(), room<Constraint>(joined, GCDT_ADDED_CROSSINGS, added));
    Statistics& s = joined.statistics;
    s.n = n, s.m = input_.constraints.size();
    s.crossings = crossings.size(), s.vertices_added = added;
    s.constraints_split = routed.count, s.constraint_move = routed.largest_move;
    return joined;
  }

  /// The constraints that cross are wide, so that the seam has all that may be near their routes; and so are those that
  /// cross a route, which only the seam's call can tell. Ends: each round has more wide ones.
  Routed route(const std::vector<Constraint>& crossings) {
    own_.crossing = Crossing::split;
    std::vector<Role> roles(input_.constraints.size(), Role::any);
    for (const Constraint& pair : crossings) roles[pair[0]] = roles[pair[1]] = Role::wide;
    std::vector<bool> is_routed;
    for (bool more = true; more;) {
      solve_parts(roles);
      more = false;
      is_routed.assign(roles.size(), false);
      for (const std::uint32_t marked : made_seam().routed)
        for (const std::uint32_t c : seam_.sources_of(marked, all_, tiles_)) {
          more = more || roles[c] != Role::wide;
          roles[c] = Role::wide;
          is_routed[c] = true;
        }
    }
    Routed routed = take_routes(input_, {seam_, all_, tiles_, made_seam(), ProblemMesh(made_seam_, 0)}, is_routed);
    routed.largest_move = made_seam().statistics.constraint_move * grid_.cell();
    return routed;
  }

  const ForestResult& made_seam() const { return *made_seam_.at(0).first; }

  /// Tiles and seam. Returns the pairs of constraints that cross, of which each has one that is open, or was dropped in
  /// its tile and so handed up to the seam (docs/scale.md, T3).
  std::vector<Constraint> solve_parts(const std::vector<Role>& roles) {
    {
      const Timed timed(report_.ms_share);
      all_ = partition(input_, cuts_, roles);
    }
    solve_tiles();
    const Timed timed(report_.ms_seam);
    seam_ = make_seam(input_, all_, tiles_);
    report_.tiles = static_cast<std::uint32_t>(cuts_.tiles());
    report_.seam_vertices = seam_.points.size();
    report_.seam_constraints = seam_.constraints.size();
    return solve_seam();
  }

  void solve_tiles() {
    std::size_t points = 0, constraints = 0;
    for (const Tile& tile : all_.tiles) points += tile.points.size(), constraints += tile.constraints.size();
    GridBatch batch(points, constraints);
    for (const Tile& tile : all_.tiles) batch.add(tile.own > 0 ? tile.points : GridPoints{}, tile.constraints);
    Options own = own_;
    own.crossing = Crossing::drop;
    {
      const Timed timed(report_.ms_tiles);
      run(made_tiles_, batch, own, "tiles", 0, tiles_share);
    }
    const Timed timed(report_.ms_final);
    tiles_.clear();
    tiles_.resize(all_.tiles.size());
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      tiles_[t].mesh = ProblemMesh(made_tiles_, t);
      tiles_[t].final = final_triangles(tiles_[t].mesh, all_, t, cuts_);
    }
  }

  std::vector<Constraint> solve_seam() {
    GridBatch batch(seam_.points.size(), seam_.constraints.size());
    batch.add(seam_.points, seam_.constraints);
    try {
      run(made_seam_, batch, own_, "seam", tiles_share, seam_share);
    } catch (const Error& error) {
      if (error.status() == Status::constraints_cross) return pairs_of(error.indices());
      if (error.status() != Status::out_of_memory) throw;
      throw SeamTooLarge(error.status(), "the seam between " + std::to_string(cuts_.tiles()) + " tiles, of " +
                                             std::to_string(seam_.points.size()) + " vertices and " +
                                             std::to_string(seam_.constraints.size()) +
                                             " constraints: " + error.what());
    }
    if (own_.crossing == Crossing::reject) between_ = take_seam(seam_, ProblemMesh(made_seam_, 0));
    return {};
  }

  /// Throws the error of the first problem that has one.
  void run(PoolResult& made, const GridBatch& batch, Options options, const char* phase, double from, double to) {
    options.progress = [&](const char*, double done) { return tell(phase, from + (to - from) * done); };
    made = {};
    made = pool_.triangulate(batch.view(), options);
    if (!made.errors.empty()) throw made.errors.begin()->second;
  }

  bool tell(const char* phase, double done) const { return !options_.progress || options_.progress(phase, done); }

  /// Of pairs of the seam's constraints those of the input, the smaller number first, ascending. Two straight
  /// constraints meet in one point, so each pair occurs once.
  std::vector<Constraint> pairs_of(const std::vector<std::uint64_t>& indices) const {
    std::vector<Constraint> pairs;
    for (std::size_t i = 0; i + 1 < indices.size(); i += 2)
      for (const std::uint32_t c : seam_.sources_of(indices[i], all_, tiles_))
        for (const std::uint32_t d : seam_.sources_of(indices[i + 1], all_, tiles_))
          pairs.push_back({std::min(c, d), std::max(c, d)});
    if (pairs.empty()) throw Error(Status::check_failed, "tiles: a constraint crosses the border of final triangles");
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

  Error crossings_of(const std::vector<Constraint>& pairs) const {
    const auto ends = [&](std::uint32_t c) { return input_.constraints[c]; };
    return crossings_error(pairs, ends, grid_.kind == Grid::Kind::rounded);
  }

  DevicePool& pool_;
  const GridInput& input_;
  const Grid& grid_;
  const Cuts& cuts_;
  const Options& options_;
  TiledReport& report_;
  Options own_;
  Partition all_;
  PoolResult made_tiles_, made_seam_;
  std::vector<SolvedTile> tiles_;
  Seam seam_;
  SolvedSeam between_;
};

/// Vertices that rounding has made one with a lesser one.
RoundedTogether together(const Points& points, const ForestResult& joined) {
  RoundedTogether found;
  const auto representative = array_of<std::uint32_t>(joined, GCDT_REPRESENTATIVES);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    const std::uint32_t r = representative[v];
    if (points.coordinate(v, 0) == points.coordinate(r, 0) && points.coordinate(v, 1) == points.coordinate(r, 1))
      continue;
    if (found.count++ == 0) found.first = {r, v};
  }
  return found;
}

}  // namespace

ForestResult triangulate_cut(DevicePool& pool, const BatchInput& batch, const Options& options,
                             const std::function<Cuts(const GridPoints&)>& cut) {
  const Points points = part_of(batch.type, batch.vertices, static_cast<std::size_t>(batch.vertex_offsets[0]),
                                static_cast<std::size_t>(batch.n(0)));
  const Constraints constraints = {batch.constraints + batch.constraint_offsets[0],
                                   static_cast<std::size_t>(batch.m(0))};
  TiledReport report;
  Placed placed;
  {
    const Timed timed(report.ms_share);
    placed = place(points, options.grid);
  }
  const GridInput input{placed.points, constraints};
  const Cuts cuts = cut(placed.points);
  ForestResult joined = Tiled(pool, input, placed.chosen.grid, cuts, options, report).solve();
  joined.problems = {0};
  joined.grids = {placed.chosen.grid};
  joined.tiles = report;
  joined.statistics.grid = placed.chosen.grid;
  if (may_round_together(placed.chosen.grid)) joined.together = {together(points, joined)};
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
    ForestResult made = triangulate_cut(pool, one_of(batch, problem), options,
                                        [&](const GridPoints& points) { return even_cuts(points, tiles); });
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
