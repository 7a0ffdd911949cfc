// SPDX-License-Identifier: Apache-2.0
#include "solve/crossing_policy.hpp"

#include <memory>

namespace gcdt {

namespace {

[[noreturn]] void reject(Run& run, const std::vector<Constraint>& crossings) {
  runtime::Runtime& runtime = run.runtime;
  auto one = runtime.allocate<cl_uint2>("ends of a constraint", 1);  // the host may not read the caller's buffer
  const auto ends = [&](std::uint32_t c) {
    runtime.copy(run.constraints, one, 1, c);
    const cl_uint2 e = runtime.read_one(one);
    return Constraint{e.s[0], e.s[1]};
  };
  throw crossings_error(crossings, ends, run.vertices.grid.kind == Grid::Kind::rounded);
}

// The pixels of the crossings become vertices, once. Then the constraints that cross are routed, and those that cross
// a routed one, until none cross (docs/splitting.md). Ends: each further round has marked another constraint.
void split(Run& run) {
  auto splitter =
      std::make_unique<Splitter>(run.runtime, run.primitives, run.constraints, static_cast<std::uint32_t>(run.n));
  Statistics& s = run.statistics;
  s.crossings = splitter->find(run.walked(), run.pieces, run.counters);
  if (s.crossings == 0) fail_without_crossings({});
  run.pieces = {};
  run.mesh = {};
  run.lists = {};
  run.history = {};
  run.vertices = splitter->add(std::move(run.vertices));
  run.plan = make_plan(run.runtime, run.vertices);
  run.plan.constraints = Plan::By::all;  // those that cross a routed one are found among all
  for (;;) {
    run.ticker.tick("constrain", 0.5);
    const auto& links = splitter->route(run.plan, run.vertices);
    run.insert();
    const ConstrainResult enforced = run.clean_and_enforce(links, run.vertices.input_vertex.size());
    if (!enforced.failed) break;
    if (enforced.mesh_changed) run.insert();
    if (splitter->mark(run.walked(), run.pieces, run.counters) == 0) fail_without_crossings(enforced);
  }
  splitter->name_sources(run.pieces);
  run.result.added = std::move(splitter->added());
  run.result.added.crossings = run.result.added.count;
  s.vertices_added = run.result.added.count;
  s.constraints_split = splitter->marked();
  run.result.routed = splitter->take_marks();
  s.constraint_move = splitter->largest_move() * run.vertices.grid.cell();
}

// Those of pieces that were edges when others failed.
void clear_marks(Run& run) { run.runtime.fill<cl_uint>(run.mesh.edge_marks, 0, run.mesh.edges()); }

void must_fit(const ConstrainResult& second) {
  if (second.failed)
    throw Error(Status::check_failed, "constrain: constraints still cross after dropping (failure bits " +
                                          std::to_string(second.failed) + ")");
}

}  // namespace

void follow_crossing_policy(Run& run, const ConstrainResult& failed) {
  if (failed.mesh_changed) run.insert();
  if (run.options.crossing == Crossing::split) return split(run);
  const std::vector<Constraint> crossings = find_crossings(run, failed);
  if (run.options.crossing != Crossing::drop) reject(run, crossings);
  drop_crossings(run, crossings);
}

std::vector<Constraint> find_crossings(Run& run, const ConstrainResult& failed) {
  std::vector<Constraint> crossings =
      find_crossings(run.runtime, run.primitives, run.walked(), run.pieces, run.counters);
  if (crossings.empty()) fail_without_crossings(failed);
  run.statistics.crossings = crossings.size();
  return crossings;
}

void drop_crossings(Run& run, const std::vector<Constraint>& crossings) {
  const std::vector<std::uint32_t> dropped = drop_crossing(crossings);
  name_dropped(run, dropped);
  std::vector<cl_uint> wanted(run.m, 1);
  for (const std::uint32_t d : dropped) wanted[d] = 0;
  clear_marks(run);
  must_fit(run.clean_and_enforce(run.constraints, run.n, wanted));
}

void name_dropped(Run& run, const std::vector<std::uint32_t>& dropped) {
  run.statistics.constraints_dropped = dropped.size();
  run.result.dropped = run.runtime.upload("dropped constraints", dropped);
}

void enforce_rest(Run& run) {
  clear_marks(run);
  must_fit(run.enforce());
}

void fail_without_crossings(const ConstrainResult& failed) {
  throw Error(Status::check_failed, "constrain: the mesh would be invalid though no constraints cross (failure bits " +
                                        std::to_string(failed.failed) + ")");
}

}  // namespace gcdt
