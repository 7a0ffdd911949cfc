// SPDX-License-Identifier: Apache-2.0
#include "solve/triangulate.hpp"

#include "phases/check.hpp"
#include "solve/crossing_policy.hpp"
#include "solve/programs.hpp"
#include "solve/refine.hpp"
#include "solve/run.hpp"

namespace gcdt {

namespace {

// By one work-item. False: some cross, or an end is no vertex. What follows from that needs all of them at once, in a
// mesh without constraints.
bool constrain_by_one(Run& run) {
  const auto ends = run.runtime.upload("first constraints", std::vector<cl_uint>{0, static_cast<cl_uint>(run.m)});
  EnforceResult enforced = run.enforce_in_order(ends);
  if (!enforced.wrong_index && enforced.crosses.empty()) {
    run.pieces = std::move(enforced.pieces);
    return true;
  }
  run.plan.constraints = Plan::By::all;
  run.insert();
  return false;
}

void constrain(Run& run) {
  if (run.m == 0) return run.no_pieces();
  run.pieces = {};
  run.ticker.tick("constrain", 0);
  if (run.plan.constraints == Plan::By::one && constrain_by_one(run)) return run.count_turns();
  const ConstrainResult enforced = run.clean_and_enforce(run.constraints, run.n);
  if (enforced.failed) follow_crossing_policy(run, enforced);
  run.pieces.walked = {};
  run.count_turns();
}

// `refs`: the face of each triangle, if the mesh is refined afterwards.
OrderedMesh put_in_order(Run& run, bool refines, runtime::Buffer<cl_uint>& refs) {
  run.begin_output();
  Plan plan = run.plan;
  if (refines) plan.output = Plan::By::all;
  OrderedMesh ordered = order_triangles(run.runtime, run.primitives, plan, run.mesh, run.vertices,
                                        run.options.canonical, refines ? &refs : nullptr);
  run.statistics.ms.gather = ordered.gather_ms;
  if (!refines) run.mesh = {};
  return ordered;
}

// Regions that are open to the outside are all at depth 0.
std::string empty_note(const Run& run) {
  const bool by_outer = run.options.domain == Domain::outer || run.options.domain == Domain::outer_holes;
  if (!by_outer || run.statistics.deepest > 0) return "the domain is empty: no triangles";
  return "the domain is empty: all of the hull is open to the outside across edges of it that are no constraints, as "
         "with Triangle's -p, which closes the hull with -c; the domain of holes alone takes nothing away there";
}

void select_domain(Run& run, OrderedMesh& ordered) {
  if (ordered.triangles == 0) return;
  run.ticker.tick("domain", 0.5);
  const std::uint32_t all = ordered.triangles;
  SelectedDomain selected = run.select(ordered);
  Statistics& s = run.statistics;
  s.regions = run.result.regions.count;
  s.deepest = run.result.regions.deepest;
  s.open_parity = run.result.regions.open_parity;
  s.open_winding = run.result.regions.open_winding;
  const Domain domain = run.options.domain;
  const std::uint64_t open = domain == Domain::even_odd  ? s.open_parity
                             : domain == Domain::nonzero ? s.open_winding
                                                         : 0;
  if (open != 0)
    s.notes.push_back(std::to_string(open) +
                      " constrained edges are not part of closed borders: regions are taken as seen along the shortest "
                      "way from outside");
  if (domain == Domain::hull) return;
  s.triangles_removed = all - ordered.triangles;
  if (ordered.triangles == 0) s.notes.push_back(empty_note(run));
  run.result.hull = std::move(selected.mesh);
  run.result.kept = std::move(selected.kept);
}

OrderedMesh refine_domain(Run& run, OrderedMesh ordered, runtime::Buffer<cl_uint> refs) {
  if (ordered.triangles == 0) return ordered;
  const TriangleCounts counts = {ordered.triangles,
                                 run.result.kept.allocated() ? run.result.hull.triangles : ordered.triangles};
  ordered = {};
  Subsegments subsegments = find_subsegments(run.runtime, run.vertices, run.mesh, run.pieces);
  return refine(run, counts, std::move(refs), std::move(subsegments));
}

// Fewer than three vertices, or all on one line.
std::string flat_note(runtime::Runtime& runtime, const Vertices& vertices, const InputSource& source) {
  const bool few = vertices.n() < 3;
  if (may_round_together(vertices.grid) && !given_on_one_line(runtime, source.load().points))
    return few ? "fewer than three distinct vertices are left by rounding to the grid, of more that are not on one "
                 "line as given: no triangles"
               : "all vertices lie on one line after rounding to the grid, but not as given: no triangles";
  return few ? "fewer than three distinct vertices: no triangles" : "all vertices lie on one line: no triangles";
}

DeviceTriangulation run_steps(Run& run, const InputSource& source) {
  runtime::Runtime& runtime = run.runtime;
  const bool refines = run.options.refine.has_value();
  auto& ms = run.statistics.ms;
  run.step("order", ms.order, ordered_share, [&] {
    run.ticker.tick("order", 0);
    DeviceInput input = source.load();
    run.constraints = std::move(input.constraints);
    run.plan = make_plan(runtime, {1, input.points.n, input.points.n});
    run.take(order(runtime, run.primitives, run.plan, std::move(input.points), run.options.grid));
  });
  run.tell_plan();
  if (run.options.refine) tell_coarse_grid(run);
  run.step("insert", ms.insert, inserted_share, [&] { run.insert(); });
  run.step("constrain", ms.constrain, constrained_share, [&] { constrain(run); });
  run.step("flip", ms.flip, flipped_share, [&] { run.flip(); });
  OrderedMesh ordered;
  runtime::Buffer<cl_uint> refs;
  run.step("output", ms.output, refines ? ordered_before_refining : 1,
           [&] { ordered = put_in_order(run, refines, refs); });
  if (run.options.check)
    run.step("check", ms.check, [&] { check(runtime, run.plan, ordered, run.vertices, run.pieces); });
  if (run.wants_regions()) run.step("domain", ms.domain, [&] { select_domain(run, ordered); });
  if (refines)
    run.step("refine", ms.refine, 1, [&] { ordered = refine_domain(run, std::move(ordered), std::move(refs)); });
  run.step("output", ms.output, [&] { run.number(std::move(ordered)); });
  DeviceTriangulation made = run.finish();
  Statistics& s = made.statistics;
  if (s.triangles + s.triangles_removed == 0) s.notes.push_back(flat_note(runtime, made.vertices, source));
  return made;
}

// Of a mesh of `edges` at most.
CallShape shape_of_call(const runtime::Runtime& runtime, const InputSource& source, std::uint64_t edges) {
  const Tuning& tuning = runtime.tuning();
  CallShape call;
  call.constrained = source.m > 0;
  call.merged = source.n <= tuning.most_merged;
  call.swept = edges >= tuning.least_sweep;
  call.patched = edges >= tuning.least_patched;
  call.grouped = edges >= tuning.least_grouped;
  call.spares = runtime.spares_programs();
  return call;
}

}  // namespace

DeviceTriangulation triangulate(runtime::Runtime& runtime, Primitives& primitives, const InputSource& source,
                                const Options& options) {
  if (options.refine) check_refinement(*options.refine, options, source.n);
  runtime.use_programs(runtime::Meshes::one);
  const std::uint64_t edges = 3 * std::uint64_t{source.n};
  const runtime::SparedPrograms spared(runtime, edges < Tuning::least_all_programs);
  const runtime::Builders ahead(runtime, programs_of_call(shape_of_call(runtime, source, edges)));
  // Few vertices may be refined to many.
  const std::uint64_t most = options.refine ? 0 : runtime.most_here();
  const runtime::WorkHere here(runtime, source.n <= most && source.m <= 2 * most);
  Run run(runtime, primitives, options, source.n, source.m);
  try {
    return run_steps(run, source);
  } catch (const Error& error) {
    if (error.status() == Status::workspace_too_small) throw run.with_bytes_needed(error);
    throw;
  }
}

}  // namespace gcdt
