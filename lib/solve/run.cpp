// SPDX-License-Identifier: Apache-2.0
#include "solve/run.hpp"

#include "phases/ahead.hpp"
#include "phases/grow.hpp"
#include "solve/memory.hpp"

namespace gcdt {

Run::Run(runtime::Runtime& device, Primitives& all, const Options& wanted, std::uint64_t inputs, std::uint64_t given)
    : runtime(device),
      primitives(all),
      options(wanted),
      n(inputs),
      m(given),
      in_use_before(device.meter().now),
      ticker(wanted.progress),
      counters(device),
      built_(device.build_ms()),
      launches_(device.launches()),
      read_backs_(device.read_backs()) {
  check_vertex_count(n);
  check_constraint_count(m);
  runtime.meter().restart_peaks();
}

void Run::take(OrderResult ordered) {
  vertices = std::move(ordered.vertices);
  statistics.vertices_merged = ordered.merged;
  statistics.vertices_rounded_together = ordered.together.count;
  statistics.rounded_pair = ordered.together.first;
  if (options.distinct && ordered.together.count > 0) throw together_error(ordered.together);
  sort_ms_ = ordered.sort_ms;
  primitives.release();
  plan = make_plan(runtime, vertices);
}

void Run::tell_plan() const {
  const std::string text = plan.text();
  runtime.log(GCDT_LOG_INFORMATION, "plan: " + text);
  runtime.tracer().note("plan", text);
}

void Run::insert() {
  if (!mesh.face_data.allocated()) mesh = make_mesh(runtime, vertices.n(), vertices.roots);
  need_lists();
  plan.grows ? grow_all() : insert_levels();
}

void Run::insert_levels() {
  const auto& levels = vertices.levels;
  insert_root(runtime, vertices, mesh);
  if (!history.nodes.allocated()) history = make_history(runtime, levels, vertices.roots);
  // Constraints are located in the last level, and vertices without a tree.
  for (unsigned level = 0; level < levels.count; ++level) {
    const bool last = level + 1 == levels.count;
    statistics.rounds.insert +=
        insert_level(runtime, plan, vertices, mesh, history, last && m > 0, lists, counters, level, ticker);
    const device::Counters& c = counters.last();
    statistics.cases.edge_splits += c.edge_splits;
    statistics.history_depth = c.history_depth;
    statistics.location_steps += wide(c.steps_low, c.steps_high);
    if (!last) count(gcdt::flip(runtime, plan, vertices, mesh, lists, counters, levels.begin[level + 1], ticker));
  }
}

void Run::grow_all() {
  const GrowResult r = grow(runtime, plan, vertices, mesh, lists, counters, vertices.n(), ticker);
  statistics.rounds.insert += r.rounds;
  statistics.cases.edge_splits += r.edge_splits;
  statistics.location_steps += r.steps;
  count(r.flips);
  if (m > 0 && plan.constraints == Plan::By::all) history = freeze_all(runtime, vertices, mesh, counters);
}

void Run::need_lists() {
  if (!lists.first.allocated()) lists = make_work_lists(runtime, vertices.n(), vertices.roots);
}

void Run::count(const FlipResult& flipped) {
  statistics.rounds.flip += flipped.rounds;
  statistics.flips += flipped.flips;
}

void Run::no_pieces() {
  pieces.ends = runtime.allocate<cl_uint2>("pieces", 0);
  pieces.source_offsets = runtime.allocate<cl_uint>("source offsets", 1);
  pieces.sources = runtime.allocate<cl_uint>("sources of pieces", 0);
  turns = runtime.allocate<cl_int>("turns of pieces", 0);
}

void Run::clean(const runtime::Buffer<cl_uint2>& given, std::uint64_t inputs, const std::vector<cl_uint>& wanted) {
  step("clean", statistics.ms.clean, [&] {
    pieces = {};
    Cleaner cleaner(runtime, primitives, vertices, given, static_cast<std::uint32_t>(inputs));
    make_pieces(cleaner, cleaner.keep(plan, wanted), wanted.empty());
  });
}

// `all`: what is told of constraints is of all that were given.
void Run::make_pieces(Cleaner& cleaner, const KeptConstraints& kept, bool all) {
  lists = {};
  CleanResult cleaned = cleaner.clean(walked(), kept, counters);
  count(cleaned);
  pieces = std::move(cleaned.pieces);
  if (!all) return;
  statistics.constraints_zero = kept.zero_length;
  statistics.cases.constraint_hits = cleaned.hits;
}

void Run::count(const CleanResult& cleaned) {
  statistics.ms.walk += cleaned.walk_ms;
  statistics.location_steps += cleaned.steps;
}

ConstrainResult Run::enforce() {
  const ConstrainResult r = constrain(runtime, primitives, plan, vertices, mesh, history, pieces, counters);
  count(r);
  return r;
}

void Run::count(const ConstrainResult& r) {
  auto& cases = statistics.cases;
  cases.existing_edges = r.existing_edges;
  cases.pieces_walked = r.walked;
  cases.chain_vertices = r.chain_vertices;
  cases.holes = r.holes;
  cases.symbolic_chain_vertices = r.symbolic_chain_vertices;
  cases.pairs_cut_one_corner = r.pairs_of_two[0], cases.pairs_from_one_corner = r.pairs_of_two[1];
  cases.pairs_cut_two_corners = r.pairs_of_two[2], cases.pairs_cut_and_from = r.pairs_of_two[3];
  statistics.crossed_pairs = r.crossed_pairs;
  statistics.location_steps += r.steps;
}

ConstrainResult Run::clean_and_enforce(const runtime::Buffer<cl_uint2>& given, std::uint64_t inputs,
                                       const std::vector<cl_uint>& wanted) {
  const bool all = wanted.empty();
  Cleaner cleaner(runtime, primitives, vertices, given, static_cast<std::uint32_t>(inputs));
  KeptConstraints kept;
  CleanResult some;
  step("clean", statistics.ms.clean, [&] {
    pieces = {};
    lists = {};
    kept = cleaner.keep(plan, wanted);
    some = clean_ahead(cleaner, walked(), kept, counters);
    count(some);
    if (some.pieces.count > 0) return;
    make_pieces(cleaner, kept, all);
    if (!pays_in_turn(plan, sizes_of(vertices), kept.count, pieces.walked.crossed)) return;
    pieces = {};  // their lengths have not told
    kept = {};
    kept = cleaner.keep(plan, wanted, true);
    some = cleaner.clean(walked(), cleaner.every(kept, plan.step_ahead), counters);
    count(some);
  });
  if (some.pieces.count > 0) return enforce_in_turn(cleaner, std::move(some), std::move(kept), all);
  ticker.tick("constrain", cleaned_share);
  return enforce();
}

// If constraints cross, some of those ahead do, or others cross these or one another. What crosses is then found in the
// mesh without any; the pieces are the same in both.
ConstrainResult Run::enforce_in_turn(Cleaner& cleaner, CleanResult some, KeptConstraints kept, bool all) {
  ConstrainResult ahead =
      enforce_ahead(runtime, primitives, plan, vertices, mesh, history, some.pieces, kept, counters);
  some = {};
  if (ahead.failed && ahead.mesh_changed) insert();
  step("clean", statistics.ms.clean, [&] { make_pieces(cleaner, kept, all); });
  ticker.tick("constrain", cleaned_share);
  if (ahead.failed) {
    ahead.mesh_changed = false;
    return ahead;
  }
  ConstrainResult rest = constrain(runtime, primitives, plan, vertices, mesh, history, pieces, counters);
  if (rest.failed) {
    history = {};
    rest.mesh_changed = true;
  } else {
    add_ahead(ahead, rest);
  }
  count(rest);
  return rest;
}

EnforceResult Run::enforce_in_order(const runtime::Buffer<cl_uint>& first_constraint) {
  EnforceResult r = enforce_problems(runtime, primitives, vertices, mesh, first_constraint, constraints,
                                     options.crossing == Crossing::drop, counters);
  statistics.constraints_zero = r.zero_length;
  statistics.crossed_pairs = r.crossed_pairs;
  statistics.flips += r.flips;
  auto& cases = statistics.cases;
  cases.constraint_hits = r.hits;
  cases.existing_edges = r.existing_edges;
  cases.pieces_walked = r.pieces.count - r.existing_edges;
  cases.chain_vertices = r.chain_vertices;
  return r;
}

void Run::count_turns() {
  if (wants_regions()) turns = gcdt::count_turns(runtime, vertices, pieces, constraints);
  constraints = {};
}

void Run::flip() {
  // Grown Delaunay, and unchanged, or kept so.
  if (plan.grows && (m == 0 || plan.constraints != Plan::By::all)) return;
  need_lists();
  if (plan.grows) return count(grow_flip(runtime, plan, vertices, mesh, lists, counters, ticker));
  counters.zero();
  count(gcdt::flip(runtime, plan, vertices, mesh, lists, counters, vertices.n(), ticker));
}

SelectedDomain Run::select(OrderedMesh& ordered) {
  SelectedDomain selected = select_domain(runtime, primitives, ordered, vertices, pieces, turns, options);
  turns = {};
  result.regions = std::move(selected.regions);
  if (options.domain != Domain::hull) std::swap(ordered, selected.mesh);
  return selected;
}

void Run::begin_output() {
  ticker.tick("output", 0);
  history = {};
  lists = {};
}

void Run::number(OrderedMesh ordered) {
  result.representatives = number_by_input(runtime, plan, vertices, ordered, pieces);
  if (result.kept.allocated()) number_corners(runtime, vertices, result.hull);
  AddedVertices& added = result.added;
  if (!added.points.allocated()) {
    added.points = runtime.allocate<cl_int2>("added vertices", 0);
    added.crossing = runtime.allocate<cl_uint2>("constraints of added vertices", 0);
  }
  if (options.refine && !result.excuses.allocated()) {  // nothing was there to be refined
    result.excuses = runtime.allocate<cl_uchar>("excuses of triangles", 0);
    if (!added.origins.allocated())
      added.origins = runtime.filled<cl_uint4>("origins of added vertices", added.count,
                                               {{GCDT_NONE, GCDT_NONE, GCDT_NONE, GCDT_NONE}});
  }
  result.mesh = std::move(ordered);
}

DeviceTriangulation Run::finish() {
  Statistics& s = statistics;
  auto& ms = s.ms;
  ms.core = sort_ms_ + ms.insert + ms.constrain - (ms.clean - ms.walk) + ms.flip + ms.gather;
  ms.full = ms.order + ms.insert + ms.constrain + ms.flip + ms.check + ms.output + ms.domain + ms.refine;
  ms.build = runtime.build_ms() - built_;
  s.launches = runtime.launches() - launches_;
  s.read_backs = runtime.read_backs() - read_backs_;
  s.n = n;
  s.m = m;
  s.constraints_pieces = pieces.count;
  s.constraints_overlapping = pieces.source_count - pieces.count;
  s.triangles = result.mesh.triangles;
  s.grid = vertices.grid;
  s.peak_device_bytes = runtime.meter().peak - in_use_before;
  s.held_device_bytes = runtime.meter().held_peak;
  s.device = runtime.info().name;
  s.driver = runtime.info().driver;
  s.platform = runtime.info().platform;
  s.version = GCDT_VERSION;
  if (!result.dropped.allocated()) result.dropped = runtime.allocate<cl_uint>("dropped constraints", 0);
  if (wants_regions()) result.regions.seeds = options.region_seeds.size();
  result.pieces = std::move(pieces);
  result.vertices = std::move(vertices);
  return std::move(result);
}

// What was missing may not be all that is: the formula knows the later steps, once the pairs are counted.
Error Run::with_bytes_needed(const Error& error) const {
  const device::Counters& c = counters.last();
  const std::uint64_t pairs = std::max(statistics.crossed_pairs, wide(c.pairs_low, c.pairs_high));
  const bool limited = options.refine && options.refine->most_added != UINT64_MAX;
  const std::uint64_t all =
      limited ? refined_bytes_needed(n, m, pairs, options.refine->most_added) : device_bytes_needed(n, m, pairs);
  const std::uint64_t needed = std::max(error.indices().at(0), all);
  return Error(Status::workspace_too_small, std::string(error.what()) + ", and should have " + std::to_string(needed),
               {needed});
}

}  // namespace gcdt
