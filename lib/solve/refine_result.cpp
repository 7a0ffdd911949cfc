// SPDX-License-Identifier: Apache-2.0
#include "solve/refine_result.hpp"

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

/// Their ends as vertices again.
Pieces copy_of(Runtime& runtime, const Vertices& vertices, const Pieces& from) {
  Pieces made;
  made.count = from.count, made.source_count = from.source_count;
  made.ends = ends_as_vertices(runtime, vertices, from);
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
  run.vertices = copy_of(runtime, made.vertices);
  run.pieces = copy_of(runtime, made.vertices, made.pieces);
  DeviceTriangulation& result = run.result;
  result.dropped = copy_of(runtime, "dropped constraints", made.dropped);
  result.routed = copy_of(runtime, "constraints that were routed", made.routed);
  result.regions = copy_of(runtime, made.regions);
  result.kept = copy_of(runtime, "kept triangles", made.kept);
  result.added.count = made.added.count;
  result.added.points = copy_of(runtime, "added vertices", made.added.points);
  result.added.crossing = copy_of(runtime, "constraints of added vertices", made.added.crossing);
}

OrderedMesh relink_and_refine(Run& run, const DeviceTriangulation& made) {
  const OrderedMesh& hull = hull_mesh(made);
  RelinkedMesh relinked = relink(run.runtime, run.primitives, run.vertices, hull);
  run.mesh = std::move(relinked.mesh);
  return refine(run, {made.mesh.triangles, hull.triangles}, std::move(relinked.refs));
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
  if (made.added.count > 0) own.crossing = Crossing::split;
  return own;
}

void check_made(const DeviceTriangulation& made, const Refinement& wanted) {
  const auto refuse = [](const char* why) { throw Error(Status::invalid_argument, why); };
  if (made.adopted) refuse("a mesh that was adopted is not refined: triangulate its vertices and constraints");
  if (made.added.origins.allocated()) refuse("the result is refined already: refine the one that it was made of");
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
