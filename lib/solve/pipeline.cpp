// SPDX-License-Identifier: Apache-2.0
#include "solve/pipeline.hpp"

#include "phases/check.hpp"
#include "phases/crossings.hpp"
#include "phases/enforce.hpp"

namespace gcdt {

namespace {

// What the steps take of a call with as many constraints as vertices, roughly, added up: only progress
// is told by it.
constexpr double order_share = 0.1, insert_share = 0.5, constrain_share = 0.75, flip_share = 0.9;

}  // namespace

Pipeline::Pipeline(runtime::Runtime& runtime, Primitives& primitives, InputSource source, const Options& options)
    : runtime_(runtime),
      primitives_(primitives),
      source_(std::move(source)),
      in_use_before_(runtime.meter().now),
      options_(options),
      ticker_(options.progress),
      counters_(runtime) {}

OrderResult Pipeline::order_points(InputPoints points) {
  return order(runtime_, primitives_, std::move(points), options_.grid, runtime_.tuning().coarsest_level);
}

DeviceTriangulation Pipeline::run() {
  check_vertex_count(source_.n);
  if (source_.m > GCDT_MAX_CONSTRAINTS)
    throw Error(Status::invalid_argument, "more than 2^31 - 1 constraints: " + std::to_string(source_.m));
  try {
    run_steps();
  } catch (const Error& error) {
    if (error.status() == Status::workspace_too_small) ask_for_workspace(error);
    throw;
  }
  return std::move(result_);
}

// What was missing may not be all that is: the formula knows the later steps, once the pairs are counted.
void Pipeline::ask_for_workspace(const Error& error) const {
  const device::Counters& c = counters_.last();
  const std::uint64_t pairs = std::max(statistics_.crossed_pairs, wide(c.pairs_low, c.pairs_high));
  const std::uint64_t needed = std::max(error.indices().at(0), device_bytes_needed(source_.n, source_.m, pairs));
  throw Error(Status::workspace_too_small, std::string(error.what()) + ", and should have " + std::to_string(needed),
              {needed});
}

void Pipeline::run_steps() {
  runtime_.meter().restart_peaks();
  const std::uint64_t launches = runtime_.launches(), reads = runtime_.read_backs();
  const double built = runtime_.build_ms();
  auto& ms = statistics_.ms;
  timed("order", ms.order, [&] {
    ticker_.enter(0, order_share);
    ticker_.tick("order", 0);
    DeviceInput input = source_.load();
    constraints_ = std::move(input.constraints);
    OrderResult ordered = order_points(std::move(input.points));
    vertices_ = std::move(ordered.vertices);
    statistics_.vertices_merged = ordered.merged;
    statistics_.vertices_rounded_together = ordered.together.count;
    statistics_.rounded_pair = ordered.together.first;
    if (options_.distinct && ordered.together.count > 0) throw together_error(ordered.together);
    sort_ms_ = ordered.sort_ms;
    primitives_.release();
    by_problem_ = enforces_by_problem(runtime_, vertices_);
  });
  ticker_.enter(order_share, insert_share);
  timed("insert", ms.insert, [&] { insert(); });
  ticker_.enter(insert_share, constrain_share);
  timed("constrain", ms.constrain, [&] { constrain_all(); });
  ticker_.enter(constrain_share, flip_share);
  timed("flip", ms.flip, [&] { flip_all(); });
  ticker_.enter(flip_share, 1);
  output();
  ms.core = sort_ms_ + ms.insert + ms.constrain - (ms.clean - ms.walk) + ms.flip + ms.gather;
  ms.full = ms.order + ms.insert + ms.constrain + ms.flip + ms.check + ms.output + ms.domain;
  ms.build = runtime_.build_ms() - built;
  statistics_.launches = runtime_.launches() - launches;
  statistics_.read_backs = runtime_.read_backs() - reads;
  finish_statistics();
}

// Level by level: insert, then flip, so that each level goes into a Delaunay mesh (paper, section 8). The
// last level is left unflipped: constraints are enforced first, and located by its history tree. Where a work-item is a
// thread's loop, vertices go in one after the other instead, each with its flips, and constraints come to a
// Delaunay mesh, in which they cross fewer edges (bench/NOTES.md).
void Pipeline::insert() {
  if (!mesh_.face_data.allocated()) mesh_ = make_mesh(runtime_, vertices_.n(), vertices_.roots);
  need_lists();
  if (runtime_.contiguous()) {
    const GrowResult grown = grow(runtime_, vertices_, mesh_, lists_, counters_, vertices_.n(), ticker_);
    statistics_.rounds.insert += grown.rounds;
    statistics_.cases.edge_splits += grown.edge_splits;
    statistics_.location_steps += grown.steps;
    count_flips(grown.flips);
    if (source_.m > 0 && !by_problem_) history_ = freeze_all(runtime_, vertices_, mesh_);
    return;
  }
  insert_root(runtime_, vertices_, mesh_);
  if (!history_.nodes.allocated()) history_ = make_history(runtime_, vertices_.levels, vertices_.roots);
  for (unsigned level = 0; level < vertices_.levels.count; ++level) {
    statistics_.rounds.insert += insert_level(runtime_, vertices_, mesh_, history_, lists_, counters_, level, ticker_);
    const device::Counters& c = counters_.last();
    statistics_.cases.edge_splits += c.edge_splits;
    statistics_.history_depth = c.history_depth;
    statistics_.location_steps += wide(c.steps_low, c.steps_high);
    if (level + 1 < vertices_.levels.count)
      count_flips(flip(runtime_, vertices_, mesh_, lists_, counters_, vertices_.levels.begin[level + 1], ticker_));
  }
}

// While constraints are enforced, the nearest pieces of edges take their place.
void Pipeline::need_lists() {
  if (!lists_.first.allocated()) lists_ = make_work_lists(runtime_, vertices_.n(), vertices_.roots);
}

void Pipeline::count_flips(const FlipResult& flipped) {
  statistics_.rounds.flip += flipped.rounds;
  statistics_.flips += flipped.flips;
}

void Pipeline::constrain_all() {
  pieces_ = {};
  if (source_.m == 0) {
    pieces_.ends = runtime_.allocate<cl_uint2>("pieces", 0);
    pieces_.source_offsets = runtime_.allocate<cl_uint>("source offsets", 1);
    pieces_.sources = runtime_.allocate<cl_uint>("sources of pieces", 0);
    turns_ = runtime_.allocate<cl_int>("turns of pieces", 0);
    return;
  }
  ticker_.tick("constrain", 0);
  if (by_problem_ && !enforce_by_problem()) {  // crossings are found with all constraints at once
    by_problem_ = false;
    insert();
  }
  if (!by_problem_) clean_and_enforce();
  if (wants_regions()) turns_ = count_turns(runtime_, vertices_, pieces_, constraints_);
  constraints_ = {};
}

void Pipeline::clean_and_enforce() {
  cleaner_ = std::make_unique<Cleaner>(runtime_, primitives_, vertices_, constraints_, std::uint32_t(source_.n));
  timed("clean", statistics_.ms.clean, [&] { clean({}); });
  ticker_.tick("constrain", 0.3);
  const ConstrainResult first = enforce();
  if (first.failed) resolve_crossings(first);
  cleaner_.reset();
  pieces_.walked = {};
}

void Pipeline::clean(const std::vector<cl_uint>& wanted) {
  pieces_ = {};
  counters_.zero();
  CleanResult cleaned = cleaner_->clean(WalkedMesh{vertices_, mesh_, history_}, wanted, counters_);
  pieces_ = std::move(cleaned.pieces);
  statistics_.ms.walk += cleaned.walk_ms;
  const device::Counters& c = counters_.last();
  statistics_.location_steps += wide(c.steps_low, c.steps_high);
  if (wanted.empty()) {
    statistics_.constraints_zero = cleaned.zero_length;
    statistics_.cases.constraint_hits = cleaned.hits;
  }
}

ConstrainResult Pipeline::enforce() {
  lists_ = {};
  const ConstrainResult r =
      constrain(runtime_, primitives_, WalkedMesh{vertices_, mesh_, history_}, pieces_, counters_);
  auto& cases = statistics_.cases;
  cases.existing_edges = r.existing_edges;
  cases.pieces_walked = r.walked;
  cases.chain_vertices = r.chain_vertices;
  cases.holes = r.holes;
  cases.symbolic_chain_vertices = r.symbolic_chain_vertices;
  cases.pairs_cut_one_corner = r.pairs_of_two[0], cases.pairs_from_one_corner = r.pairs_of_two[1];
  cases.pairs_cut_two_corners = r.pairs_of_two[2], cases.pairs_cut_and_from = r.pairs_of_two[3];
  statistics_.crossed_pairs = r.crossed_pairs;
  statistics_.location_steps += r.steps;
  return r;
}

// Enforcement failed: either constraints cross, and their pairs are named, or something is wrong.
void Pipeline::resolve_crossings(const ConstrainResult& first) {
  if (first.mesh_changed) insert();
  if (options_.crossing == Crossing::split) return split_crossings();
  const std::vector<Constraint> crossings =
      find_crossings(runtime_, primitives_, WalkedMesh{vertices_, mesh_, history_}, pieces_, counters_);
  if (crossings.empty()) fail_without_crossings(first);
  statistics_.crossings = crossings.size();
  if (options_.crossing != Crossing::drop) reject(crossings);
  drop_crossings(crossings);
}

void Pipeline::fail_without_crossings(const ConstrainResult& failed) const {
  throw Error(Status::check_failed, "constrain: the mesh would be invalid though no constraints cross (failure bits " +
                                        std::to_string(failed.failed) + ")");
}

void Pipeline::drop_crossings(const std::vector<Constraint>& crossings) {
  const std::vector<std::uint32_t> dropped = drop_crossing(crossings);
  statistics_.constraints_dropped = dropped.size();
  result_.dropped = runtime_.allocate<cl_uint>("dropped constraints", dropped.size());
  runtime_.write(result_.dropped, dropped.data(), dropped.size());
  std::vector<cl_uint> wanted(source_.m, 1);
  for (const std::uint32_t d : dropped) wanted[d] = 0;
  timed("clean", statistics_.ms.clean, [&] { clean(wanted); });
  runtime_.fill<cl_uint>(mesh_.edge_marks, 0, mesh_.edges());
  const ConstrainResult second = enforce();
  if (second.failed)
    throw Error(Status::check_failed, "constrain: constraints still cross after dropping (failure bits " +
                                          std::to_string(second.failed) + ")");
}

// The pixels of the crossings become vertices, once. Then the constraints that cross are routed, and those that cross
// a routed one, until none cross (docs/splitting.md). Ends: each further round has marked another constraint.
void Pipeline::split_crossings() {
  auto splitter = std::make_unique<Splitter>(runtime_, primitives_, constraints_, std::uint32_t(source_.n));
  auto walked = [&] { return WalkedMesh{vertices_, mesh_, history_}; };
  cleaner_.reset();
  statistics_.crossings = splitter->find(walked(), pieces_, counters_);
  if (statistics_.crossings == 0) fail_without_crossings({});
  pieces_ = {};
  mesh_ = {};
  lists_ = {};
  history_ = {};
  vertices_ = splitter->add(std::move(vertices_), runtime_.tuning().coarsest_level);
  for (;;) {
    ticker_.tick("constrain", 0.5);
    const auto& links = splitter->route(vertices_);
    insert();
    cleaner_ = std::make_unique<Cleaner>(runtime_, primitives_, vertices_, links,
                                         std::uint32_t(vertices_.input_vertex.size()));
    timed("clean", statistics_.ms.clean, [&] { clean({}); });
    const ConstrainResult enforced = enforce();
    if (!enforced.failed) break;
    if (enforced.mesh_changed) insert();
    if (splitter->mark(walked(), pieces_, counters_) == 0) fail_without_crossings(enforced);
  }
  cleaner_.reset();
  splitter->name_sources(pieces_);
  result_.added = std::move(splitter->added());
  statistics_.vertices_added = result_.added.count;
  statistics_.constraints_split = splitter->marked();
  statistics_.constraint_move = splitter->largest_move() * vertices_.grid.cell();
}

void Pipeline::reject(const std::vector<Constraint>& crossings) {
  auto one = runtime_.allocate<cl_uint2>("ends of a constraint", 1);  // the host may not read the caller's buffer
  const auto ends = [&](std::uint32_t c) {
    runtime_.copy(constraints_, one, 1, c);
    const cl_uint2 e = runtime_.read_one(one);
    return Constraint{e.s[0], e.s[1]};
  };
  throw crossings_error(crossings, ends, vertices_.grid.kind == Grid::Kind::rounded);
}

void Pipeline::flip_all() {
  // Grown Delaunay, and unchanged, or kept so.
  if (runtime_.contiguous() && (source_.m == 0 || by_problem_)) return;
  need_lists();
  count_flips(runtime_.contiguous() ? grow_flip(runtime_, vertices_, mesh_, lists_, counters_, ticker_)
                                    : flip(runtime_, vertices_, mesh_, lists_, counters_, vertices_.n(), ticker_));
}

void Pipeline::output() {
  auto& ms = statistics_.ms;
  OrderedMesh ordered;
  timed("output", ms.output, [&] {
    ticker_.tick("output", 0);
    history_ = {};
    lists_ = {};
    ordered = order_triangles(runtime_, primitives_, mesh_, vertices_, options_.canonical);
    ms.gather = ordered.gather_ms;
    mesh_ = {};
  });
  if (options_.check) timed("check", ms.check, [&] { check(runtime_, primitives_, ordered, vertices_, pieces_); });
  if (wants_regions()) timed("domain", ms.domain, [&] { select(ordered); });
  timed("output", ms.output, [&] {
    result_.representatives = number_by_input(runtime_, vertices_, ordered, pieces_);
    if (!result_.dropped.allocated()) result_.dropped = runtime_.allocate<cl_uint>("dropped constraints", 0);
    if (result_.kept.allocated()) number_corners(runtime_, vertices_, result_.hull);
    if (!result_.added.points.allocated()) {
      result_.added.points = runtime_.allocate<cl_int2>("added vertices", 0);
      result_.added.crossing = runtime_.allocate<cl_uint2>("constraints of added vertices", 0);
    }
    result_.mesh = std::move(ordered);
  });
}

void Pipeline::select(OrderedMesh& ordered) {
  if (ordered.triangles == 0) return;
  ticker_.tick("domain", 0.5);
  SelectedDomain selected = select_domain(runtime_, primitives_, ordered, vertices_, pieces_, turns_, options_);
  turns_ = {};
  Statistics& s = statistics_;
  s.regions = selected.regions.count;
  s.deepest = selected.regions.deepest;
  s.open_parity = selected.regions.open_parity;
  s.open_winding = selected.regions.open_winding;
  result_.regions = std::move(selected.regions);
  const bool by_parity = options_.domain == Domain::even_odd, by_winding = options_.domain == Domain::nonzero;
  if ((by_parity && s.open_parity != 0) || (by_winding && s.open_winding != 0))
    s.notes.push_back(std::to_string(by_parity ? s.open_parity : s.open_winding) +
                      " constrained edges are not part of closed borders: regions are taken as seen along the shortest "
                      "way from outside");
  if (options_.domain == Domain::hull) return;
  s.triangles_removed = ordered.triangles - selected.mesh.triangles;
  if (selected.mesh.triangles == 0) s.notes.push_back(empty_note());
  result_.hull = std::move(ordered);
  result_.kept = std::move(selected.kept);
  ordered = std::move(selected.mesh);
}

// Regions that are open to the outside are all at depth 0.
std::string Pipeline::empty_note() const {
  const bool by_outer = options_.domain == Domain::outer || options_.domain == Domain::outer_holes;
  if (!by_outer || statistics_.deepest > 0) return "the domain is empty: no triangles";
  return "the domain is empty: all of the hull is open to the outside across edges of it that are no constraints, as "
         "with Triangle's -p, which closes the hull with -c; the domain of holes alone takes nothing away there";
}

// Fewer than three vertices, or all on one line.
std::string Pipeline::flat_note() {
  const bool few = vertices_.n() < 3;
  if (may_round_together(vertices_.grid) && !given_on_one_line(runtime_, source_.load().points))
    return few ? "fewer than three distinct vertices are left by rounding to the grid, of more that are not on one "
                 "line as given: no triangles"
               : "all vertices lie on one line after rounding to the grid, but not as given: no triangles";
  return few ? "fewer than three distinct vertices: no triangles" : "all vertices lie on one line: no triangles";
}

void Pipeline::finish_statistics() {
  Statistics& s = statistics_;
  s.n = source_.n;
  s.m = source_.m;
  s.constraints_pieces = pieces_.count;
  s.constraints_overlapping = pieces_.source_count - pieces_.count;
  s.triangles = result_.mesh.triangles;
  s.grid = vertices_.grid;
  s.peak_device_bytes = runtime_.meter().peak - in_use_before_;
  s.held_device_bytes = runtime_.meter().held_peak;
  s.device = runtime_.info().name;
  s.driver = runtime_.info().driver;
  s.platform = runtime_.info().platform;
  s.version = GCDT_VERSION;
  if (s.triangles + s.triangles_removed == 0) s.notes.push_back(flat_note());
  result_.pieces = std::move(pieces_);
  result_.vertices = std::move(vertices_);
}

}  // namespace gcdt
