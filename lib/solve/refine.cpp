// SPDX-License-Identifier: Apache-2.0
#include "solve/refine.hpp"

#include <algorithm>
#include <cmath>

#include "phases/check.hpp"
#include "phases/refine.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(Status::invalid_argument, "refine: " + what); }

// A length or an area in units of the input, of which the cell has `unit`, in whole numbers of these; at most `most`.
std::uint64_t in_cells(double value, double unit, std::uint64_t most) {
  const double cells = std::floor(value / unit);
  return cells < static_cast<double>(most) ? static_cast<std::uint64_t>(cells) : most;
}

constexpr std::uint64_t longest = 0x7FFFFFFF, no_limit = ~std::uint64_t{0};

device::RefineRules rules_of(const Refinement& wanted, double cell) {
  const auto millionths = static_cast<std::uint32_t>(std::lround(wanted.least_angle * 1e6));
  const auto least = static_cast<std::uint32_t>(in_cells(std::ceil(wanted.least_length / cell), 1, longest));
  device::RefineRules rules = refine_rules(millionths, std::max(least_refined_side, least));
  // Doubled areas are below 2^62.
  if (wanted.most_area < HUGE_VAL)
    rules.most_area = in_cells(wanted.most_area, cell * cell / 2, std::uint64_t{1} << 62);
  rules.conforming = wanted.conforming;
  rules.splits = static_cast<cl_uint>(wanted.splits);
  rules.sized = !wanted.sizes.empty();
  return rules;
}

Buffer<cl_uint> sizes_in_cells(Run& run, const Refinement& wanted) {
  if (wanted.sizes.empty()) return {};
  const double cell = run.vertices.grid.cell();
  std::vector<cl_uint> cells(wanted.sizes.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    cells[i] = std::max(cl_uint{1}, static_cast<cl_uint>(in_cells(wanted.sizes[i], cell, longest)));
  const auto given = run.runtime.upload("wanted lengths of inputs", cells);
  const cl_uint n = run.vertices.n();
  auto sizes = run.runtime.allocate<cl_uint>("wanted lengths", n);
  run.runtime.launch("renew", "refine_gather", over(n), n, run.vertices.vertex_input, given, sizes);
  return sizes;
}

void tell(Run& run, const RefineResult& done) {
  run.result.refined = done;
  run.statistics.flips += done.flips;
  run.statistics.rounds.flip += done.flip_rounds;
  run.statistics.vertices_added += done.added;
  if (!done.complete)
    run.statistics.notes.push_back("the limit of added vertices ended the refinement: " +
                                   std::to_string(done.all_left()) + " triangles are not as wanted");
}

// Behind the vertices that crossings have added.
void append_added(Run& run, const RefinedMesh& refined) {
  runtime::Runtime& runtime = run.runtime;
  AddedVertices& added = run.result.added;
  const cl_uint crossings = added.count, all = crossings + refined.added;
  auto points = runtime.allocate<cl_int2>("added vertices", all);
  auto crossing = runtime.filled<cl_uint2>("constraints of added vertices", all, {{GCDT_NONE, GCDT_NONE}});
  auto origins = runtime.allocate<cl_uint4>("origins of added vertices", all);
  runtime.launch("renew", "refine_append", over(all), crossings, cl_uint{refined.added},
                 crossings > 0 ? added.points : points, refined.added_points, refined.added_origins, points, origins);
  if (crossings > 0) runtime.copy(added.crossing, crossing, crossings);
  added.count = all;
  added.points = std::move(points);
  added.crossing = std::move(crossing);
  added.origins = std::move(origins);
}

// The domain's triangles of the refined hull. Their regions are those of the triangles that they are made of.
OrderedMesh select(Run& run, const RefinedMesh& refined, OrderedMesh hull, const Buffer<cl_uint>& refs) {
  runtime::Runtime& runtime = run.runtime;
  const cl_uint all = hull.triangles;
  auto before = runtime.allocate<cl_uint>("kept before", std::size_t{all} + 1);
  runtime.launch("renew", "refine_flags", over(all), all, refs, refined.mesh.face_data, refined.mesh.edge_marks,
                 hull.constrained, before);
  const cl_uint count = run.primitives.scan_total(before, all);
  run.primitives.release();
  auto places = runtime.allocate<cl_int>("kept triangles", all);
  runtime.launch("domain", "place_kept", over(all), all, before, places);
  OrderedMesh kept = make_ordered(runtime, count);
  runtime.launch("domain", "gather_kept", over(all), all, places, hull.corners, hull.neighbours, hull.constrained,
                 kept.corners, kept.neighbours, kept.constrained);
  Regions& r = run.result.regions;
  if (r.region.allocated()) {
    auto labels = runtime.allocate<cl_uint>("labels of triangles", count);
    runtime.launch("renew", "refine_labels", over(all), all, refs, places, refined.mesh.face_data, labels);
    const auto gather = [&](auto& array, const char* name) {
      auto gathered = runtime.allocate<std::decay_t<decltype(runtime.read_one(array))>>(name, count);
      runtime.launch("renew", "refine_gather", over(count), count, labels, array, gathered);
      array = std::move(gathered);
    };
    gather(r.region, "region of triangles");
    gather(r.depth, "depth of triangles");
    gather(r.winding, "winding of triangles");
    gather(r.seed, "seed of triangles");
  }
  run.statistics.triangles_removed = all - count;
  run.result.hull = std::move(hull);
  run.result.kept = std::move(places);
  return kept;
}

}  // namespace

void check_refinement(const Refinement& wanted, const Options& options, std::uint64_t vertices) {
  if (!(wanted.least_angle >= 1 && wanted.least_angle <= 34))
    refuse("the least angle must be from 1 to 34 degrees, not " + std::to_string(wanted.least_angle));
  if (!(wanted.most_area > 0)) refuse("the largest area must be above 0");
  if (!(wanted.least_length >= 0)) refuse("the least length must not be negative");
  if (wanted.splits != Splits::all && wanted.splits != Splits::inner && wanted.splits != Splits::none)
    refuse("unknown rule of what may be split");
  if (wanted.sizes.empty()) return;
  if (wanted.sizes.size() != vertices)
    refuse(std::to_string(wanted.sizes.size()) + " wanted lengths for " + std::to_string(vertices) + " vertices");
  if (options.crossing == Crossing::split) refuse("wanted lengths at vertices do not go with crossings that are split");
  for (std::size_t i = 0; i < vertices; ++i)
    if (!(wanted.sizes[i] > 0)) refuse("the wanted length at vertex " + std::to_string(i) + " must be above 0");
}

OrderedMesh refine(Run& run, const Refinement& wanted, OrderedMesh ordered, Buffer<cl_uint> refs) {
  runtime::Runtime& runtime = run.runtime;
  const OrderedMesh& hull = run.result.hull.corners.allocated() ? run.result.hull : ordered;
  if (ordered.triangles == 0) return ordered;
  Buffer<cl_uint> sizes = sizes_in_cells(run, wanted);
  Refiner refiner(runtime, run.primitives, rules_of(wanted, run.vertices.grid.cell()), wanted.most_added,
                  std::move(run.vertices), std::move(run.mesh), run.pieces, std::move(sizes));
  refiner.keep(refs, run.result.kept, hull.triangles);
  ordered = {};
  run.result.hull = {};
  run.result.kept = {};
  tell(run, refiner.run(run.ticker));
  RefinedMesh refined = refiner.finish();
  run.plan = make_plan(runtime, refined.vertices);
  Plan plan = run.plan;
  plan.output = Plan::By::all;
  const Pieces subsegments = refined_pieces(runtime, run.primitives, refined, run.pieces, true);
  OrderedMesh all =
      order_triangles(runtime, run.primitives, plan, refined.mesh, refined.vertices, run.options.canonical, &refs);
  if (run.options.check) check(runtime, run.plan, all, refined.vertices, subsegments);
  run.pieces = refined_pieces(runtime, run.primitives, refined, run.pieces, false);
  OrderedMesh kept = select(run, refined, std::move(all), refs);
  append_added(run, refined);
  run.vertices = std::move(refined.vertices);
  return kept;
}

}  // namespace gcdt
