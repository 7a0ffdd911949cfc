// SPDX-License-Identifier: Apache-2.0
#include "solve/refine_result.hpp"

#include "phases/flip.hpp"
#include "phases/relink.hpp"
#include "query/derived.hpp"
#include "solve/refine.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::Runtime;

namespace {

/// A buffer with the same elements, if there is one.
template <class T>
Buffer<T> copy_of(Runtime& runtime, const char* name, const Buffer<T>& from) {
  if (!from.allocated()) return {};
  Buffer<T> made = runtime.allocate<T>(name, from.size());
  if (from.size() > 0) runtime.copy(from, made, from.size());
  return made;
}

Vertices copy_of(Runtime& runtime, const Vertices& from) {
  Vertices made;
  made.grid = from.grid, made.decimals = from.decimals, made.levels = from.levels;
  made.levels_buffer = copy_of(runtime, "levels", from.levels_buffer);
  made.points = copy_of(runtime, "points", from.points);
  made.vertex_input = copy_of(runtime, "vertex inputs", from.vertex_input);
  made.input_vertex = copy_of(runtime, "input vertices", from.input_vertex);
  return made;
}

/// With other ends.
Pieces copy_of(Runtime& runtime, const Pieces& from, Buffer<cl_uint2> ends) {
  Pieces made;
  made.count = from.count, made.source_count = from.source_count;
  made.ends = std::move(ends);
  made.source_offsets = copy_of(runtime, "source offsets", from.source_offsets);
  made.sources = copy_of(runtime, "sources of pieces", from.sources);
  return made;
}

OrderedMesh copy_of(Runtime& runtime, const OrderedMesh& from) {
  OrderedMesh made;
  made.triangles = from.triangles;
  made.corners = copy_of(runtime, "output corners", from.corners);
  made.neighbours = copy_of(runtime, "output neighbours", from.neighbours);
  made.constrained = copy_of(runtime, "output flags", from.constrained);
  return made;
}

Regions copy_of(Runtime& runtime, const Regions& from) {
  Regions made;
  made.count = from.count, made.deepest = from.deepest, made.seeds = from.seeds;
  made.open_parity = from.open_parity, made.open_winding = from.open_winding;
  made.region = copy_of(runtime, "region of triangles", from.region);
  made.depth = copy_of(runtime, "depth of triangles", from.depth);
  made.winding = copy_of(runtime, "winding of triangles", from.winding);
  made.seed = copy_of(runtime, "seed of triangles", from.seed);
  return made;
}

/// What a refinement does not change, or takes over and adds to.
void take_over(Run& run, const DeviceTriangulation& made) {
  Runtime& runtime = run.runtime;
  run.statistics = made.statistics;
  run.statistics.ms = {};
  forget_notes(run.statistics);
  run.vertices = copy_of(runtime, made.vertices);
  // Of a result that was refined the pieces as they were, of which the ends are in its chains.
  run.pieces = made.chains.there()
                   ? copy_of(runtime, made.chains.pieces, {})
                   : copy_of(runtime, made.pieces, ends_as_vertices(runtime, made.vertices, made.pieces));
  DeviceTriangulation& result = run.result;
  result.dropped = copy_of(runtime, "dropped constraints", made.dropped);
  result.routed = copy_of(runtime, "constraints that were routed", made.routed);
  result.regions = copy_of(runtime, made.regions);
  result.kept = copy_of(runtime, "kept triangles", made.kept);
  result.added.count = made.added.count;
  result.added.points = copy_of(runtime, "added vertices", made.added.points);
  result.added.crossing = copy_of(runtime, "constraints of added vertices", made.added.crossing);
  result.added.crossings = made.added.crossings;
  result.added.origins = copy_of(runtime, "origins of added vertices", made.added.origins);
}

/// Edges of an adopted mesh that are neither constraints nor around it may be flipped, and are, where they are not
/// Delaunay. Faces stay on their side of its border.
Subsegments release_adopted(Run& run, const DeviceTriangulation& made, const Buffer<cl_uint>& refs) {
  Runtime& runtime = run.runtime;
  Subsegments found = find_adopted_subsegments(runtime, run.vertices, run.mesh, run.pieces, refs, made.kept);
  const WorkLists lists = make_work_lists(runtime, run.vertices.n());
  run.counters.zero();
  const FlipResult flipped =
      flip(runtime, run.plan, run.vertices, run.mesh, lists, run.counters, run.vertices.n(), run.ticker);
  run.statistics.flips += flipped.flips;
  run.statistics.rounds.flip += flipped.rounds;
  return found;
}

Subsegments subsegments_of(Run& run, const DeviceTriangulation& made, const Buffer<cl_uint>& refs) {
  if (made.adopted) return release_adopted(run, made, refs);
  return made.chains.there() ? find_subsegments(run.runtime, run.vertices, run.mesh, made.chains)
                             : find_subsegments(run.runtime, run.vertices, run.mesh, run.pieces);
}

OrderedMesh relink_and_refine(Run& run, const DeviceTriangulation& made) {
  const OrderedMesh& hull = hull_mesh(made);
  RelinkedMesh relinked = relink(run.runtime, run.primitives, run.vertices, hull);
  run.mesh = std::move(relinked.mesh);
  Subsegments subsegments = subsegments_of(run, made, relinked.refs);
  return refine(run, {made.mesh.triangles, hull.triangles}, std::move(relinked.refs), std::move(subsegments));
}

DeviceTriangulation refine_steps(Run& run, const DeviceTriangulation& made) {
  auto& ms = run.statistics.ms;
  run.ticker.tick("refine", 0);
  take_over(run, made);
  run.plan = make_plan(run.runtime, run.vertices);
  tell_coarse_grid(run);
  const bool some = made.mesh.triangles > 0;
  OrderedMesh refined;
  run.step("refine", ms.refine, 1,
           [&] { refined = some ? relink_and_refine(run, made) : copy_of(run.runtime, made.mesh); });
  run.step("output", ms.output, [&] {
    run.number(std::move(refined));
    if (!some) run.result.hull = copy_of(run.runtime, made.hull);  // of input numbers already
  });
  return run.finish();
}

/// The options of the call that made `made`, as far as they matter here, with those that are read of `options`.
Options options_of(const DeviceTriangulation& made, const Options& options) {
  Options own;
  own.check = options.check, own.canonical = options.canonical, own.progress = options.progress;
  own.refine = options.refine;
  own.regions = made.regions.seeds.has_value();
  own.region_seeds.resize(made.regions.seeds.value_or(0));
  if (made.added.crossings > 0) own.crossing = Crossing::split;
  return own;
}

void check_made(const DeviceTriangulation& made, const Refinement& wanted) {
  const auto refuse = [](const char* why) { throw Error(Status::invalid_argument, why); };
  if (!wanted.region_areas.empty() && !made.regions.seeds)
    refuse("refine.region_areas: the result has no regions, which are an option of the call that made it");
}

}  // namespace

DeviceTriangulation refine_result(Runtime& runtime, Primitives& primitives, const DeviceTriangulation& made,
                                  const Options& options) {
  check_made(made, *options.refine);
  const Statistics& before = made.statistics;
  const Options own = options_of(made, options);
  check_refinement(*own.refine, own, before.n);
  runtime.use_programs(runtime::Meshes::one);
  Run run(runtime, primitives, own, before.n, before.m);
  try {
    return refine_steps(run, made);
  } catch (const Error& error) {
    if (error.status() == Status::workspace_too_small) throw run.with_bytes_needed(error);
    throw;
  }
}

}  // namespace gcdt
