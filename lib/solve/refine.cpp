// SPDX-License-Identifier: Apache-2.0
#include "solve/refine.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "phases/check.hpp"
#include "phases/refine.hpp"
#include "phases/refine_lengths.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

namespace {

std::string text_of(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << value;
  return text.str();
}

// `what` begins with the member.
[[noreturn]] void refuse(const std::string& what, std::vector<std::uint64_t> indices = {}) {
  throw Error(Status::invalid_argument, "refine." + what, std::move(indices));
}

void refuse_unless(bool right, const std::string& member, const char* must_be, double value,
                   std::vector<std::uint64_t> indices = {}) {
  if (!right) refuse(member + " must be " + must_be + ", not " + text_of(value), std::move(indices));
}
void check_above_zero(const std::string& member, Span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!(values[i] > 0)) refuse_unless(false, member + "[" + std::to_string(i) + "]", "above 0", values[i], {i});
}

// A length or an area in units of the input, of which the cell has `unit`, in whole numbers of these; at most `most`.
std::uint64_t in_cells(double value, double unit, std::uint64_t most) {
  const double cells = std::floor(value / unit);
  return cells < static_cast<double>(most) ? static_cast<std::uint64_t>(cells) : most;
}

// How notes of a refinement begin.
const std::string limit_note = "the limit of added vertices ended the refinement: ",
                  grid_note = "the grid is too coarse for triangles with sides of about ";

constexpr std::uint64_t longest = 0x7FFFFFFF, no_limit = ~std::uint64_t{0};

// Doubled areas are below 2^62.
std::uint64_t doubled_in_cells(double area, double cell) {
  return area < HUGE_VAL ? in_cells(area, cell * cell / 2, std::uint64_t{1} << 62) : no_limit;
}

device::RefineRules rules_of(const Refinement& wanted, double cell) {
  const bool by_angle = wanted.least_angle > 0;
  const auto millionths =
      by_angle ? static_cast<std::uint32_t>(std::lround(wanted.least_angle * 1e6)) : least_refined_angle;
  const auto least = static_cast<std::uint32_t>(in_cells(std::ceil(wanted.least_length / cell), 1, longest));
  device::RefineRules rules = refine_rules(millionths, std::max(least_refined_side, least));
  if (!by_angle) rules.tangent = rules.lens = 0;  // no angle is less, no lens has a corner
  rules.most_area = doubled_in_cells(wanted.most_area, cell);
  rules.conforming = wanted.conforming;
  rules.splits = static_cast<cl_uint>(wanted.splits);
  rules.sized = !wanted.sizes.empty();
  rules.by_label = !wanted.region_areas.empty();
  return rules;
}

// By label less 1, which is the place of a triangle of the domain.
Buffer<cl_ulong> areas_of_labels(Run& run, const Refinement& wanted, cl_uint triangles) {
  if (wanted.region_areas.empty()) return {};
  std::vector<cl_ulong> given(wanted.region_areas.size());
  for (std::size_t i = 0; i < given.size(); ++i)
    given[i] = doubled_in_cells(wanted.region_areas[i], run.vertices.grid.cell());
  auto areas = run.runtime.allocate<cl_ulong>("areas of labels", triangles);
  run.runtime.launch("renew", "refine_areas", over(triangles), triangles, run.result.regions.seed,
                     run.runtime.upload("areas of regions", given), areas);
  return areas;
}

Buffer<cl_uint> sizes_in_cells(Run& run, const Refinement& wanted) {
  if (wanted.sizes.empty()) return {};
  const double cell = run.vertices.grid.cell();
  std::vector<cl_uint> cells(wanted.sizes.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    cells[i] = std::max(cl_uint{1}, static_cast<cl_uint>(in_cells(wanted.sizes[i], cell, longest)));
  if (run.result.added.count > 0) extend_lengths(run.runtime, run.vertices, run.result.added.origins, cells);
  const auto given = run.runtime.upload("wanted lengths of inputs", cells);
  const cl_uint n = run.vertices.n();
  auto sizes = run.runtime.allocate<cl_uint>("wanted lengths", n);
  run.runtime.launch("renew", "refine_gather", over(n), n, run.vertices.vertex_input, given, sizes);
  return sizes;
}

void tell(Run& run, const RefineResult& done) {
  run.result.refined = done;
  Statistics& s = run.statistics;
  s.flips += done.flips;
  s.rounds.flip += done.flip_rounds;
  s.vertices_added += done.added;
  auto& r = s.refine;
  r.complete = done.complete;
  r.rounds = done.rounds, r.added = done.added;
  r.on_subsegments = done.on_subsegments, r.bent = done.bent, r.far = done.far;
  r.move = done.move * run.vertices.grid.cell();
  r.encroached = done.encroached;
  r.left_input_angle = done.left[GCDT_LEFT_INPUT_ANGLE], r.left_beside_angle = done.left[GCDT_LEFT_BESIDE_ANGLE];
  r.left_grid = done.left[GCDT_LEFT_GRID] + done.left[GCDT_LEFT_TARGET], r.left_target = done.left[GCDT_LEFT_TARGET];
  r.left_fixed = done.left[GCDT_LEFT_FIXED];
  r.left_refused = done.left[GCDT_LEFT_REFUSED], r.left_limit = done.left[GCDT_LEFT_LIMIT];
  if (!done.complete) s.notes.push_back(limit_note + std::to_string(done.all_left()) + " triangles are not as wanted");
}

// The shortest of the sides that triangles as large as wanted have, if they are equilateral, or of the wanted lengths.
double shortest_wanted(const Refinement& wanted) {
  double area = wanted.most_area, length = HUGE_VAL;
  for (const double of_region : wanted.region_areas) area = std::min(area, of_region);
  for (const double size : wanted.sizes) length = std::min(length, size);
  return std::min(length, 2 * std::sqrt(area / std::sqrt(3.0)));
}

// Behind the vertices that crossings and earlier refinements have added.
void append_added(Run& run, const RefinedMesh& refined) {
  runtime::Runtime& runtime = run.runtime;
  AddedVertices& added = run.result.added;
  const cl_uint before = added.count, all = before + refined.added;
  auto points = runtime.allocate<cl_int2>("added vertices", all);
  auto crossing = runtime.filled<cl_uint2>("constraints of added vertices", all, {{GCDT_NONE, GCDT_NONE}});
  auto origins = runtime.allocate<cl_uint4>("origins of added vertices", all);
  runtime.launch("renew", "refine_append", over(all), before, cl_uint{refined.added}, cl_uint{run.pieces.count},
                 run.pieces.source_offsets, run.pieces.sources, before > 0 ? added.points : points,
                 refined.added_points, refined.added_origins, points, origins);
  if (before > 0) runtime.copy(added.crossing, crossing, before);
  if (before > 0 && added.origins.allocated()) runtime.copy(added.origins, origins, before);
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
  run.result.excuses = runtime.allocate<cl_uchar>("excuses of triangles", count);
  runtime.launch("renew", "refine_excuses", over(all), all, refs, places, refined.reasons, run.result.excuses);
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
  const double angle = wanted.least_angle;
  refuse_unless(angle == 0 || (angle >= 1 && angle <= 34), "least_angle", "0, or from 1 to 34 degrees", angle);
  refuse_unless(wanted.most_area > 0, "most_area", "above 0", wanted.most_area);
  refuse_unless(wanted.least_length >= 0 && wanted.least_length < HUGE_VAL, "least_length", "finite and not below 0",
                wanted.least_length);
  if (wanted.splits != Splits::all && wanted.splits != Splits::inner && wanted.splits != Splits::none)
    refuse("splits is none of all, inner and none");
  const auto& areas = wanted.region_areas;
  if (!areas.empty() && areas.size() != options.region_seeds.size())
    refuse("region_areas has " + std::to_string(areas.size()) + " areas for " +
           std::to_string(options.region_seeds.size()) + " region seeds");
  check_above_zero("region_areas", areas);
  const auto& sizes = wanted.sizes;
  if (sizes.empty()) return;
  if (sizes.size() != vertices)
    refuse("sizes has " + std::to_string(sizes.size()) + " lengths for " + std::to_string(vertices) + " vertices");
  if (options.crossing == Crossing::split)
    refuse("sizes do not go with crossings that are split: the vertices there would have none");
  check_above_zero("sizes", sizes);
}

void tell_coarse_grid(Run& run) {
  const double cell = run.vertices.grid.cell(), least = least_refined_side * cell,
               side = shortest_wanted(*run.options.refine);
  if (side >= 2 * least || run.vertices.n() < 3) return;
  const std::string said = grid_note + text_of(side) + ": those with a side below " +
                           std::to_string(least_refined_side) + " cells, " + text_of(least) + ", are left as they are";
  run.runtime.log(GCDT_LOG_WARNING, "refine: " + said);
  run.statistics.notes.push_back(said);
}

void forget_notes(Statistics& statistics) {
  auto& notes = statistics.notes;
  notes.erase(std::remove_if(notes.begin(), notes.end(),
                             [](const std::string& note) {
                               return note.rfind(limit_note, 0) == 0 || note.rfind(grid_note, 0) == 0;
                             }),
              notes.end());
}

OrderedMesh refine(Run& run, TriangleCounts counts, Buffer<cl_uint> refs, Subsegments subsegments) {
  const Refinement& wanted = *run.options.refine;
  runtime::Runtime& runtime = run.runtime;
  run.result.hull = {};
  Buffer<cl_uint> sizes = sizes_in_cells(run, wanted);
  Buffer<cl_ulong> areas = areas_of_labels(run, wanted, counts.kept);
  Refiner refiner(runtime, run.primitives, rules_of(wanted, run.vertices.grid.cell()), wanted.most_added,
                  std::move(run.vertices), std::move(run.mesh), std::move(subsegments), std::move(sizes),
                  std::move(areas));
  refiner.keep(refs, run.result.kept, counts.hull);
  run.result.kept = {};
  tell(run, refiner.run(run.ticker));
  RefinedMesh refined = refiner.finish();
  run.plan = make_plan(runtime, refined.vertices);
  Plan plan = run.plan;
  plan.output = Plan::By::all;
  RefinedPieces links = refined_pieces(runtime, run.primitives, refined, run.pieces, true);
  OrderedMesh all =
      order_triangles(runtime, run.primitives, plan, refined.mesh, refined.vertices, run.options.canonical, &refs);
  if (run.options.check) check(runtime, run.plan, all, refined.vertices, links.pieces);
  append_added(run, refined);
  Pieces pieces = refined_pieces(runtime, run.primitives, refined, run.pieces, false).pieces;
  std::swap(run.pieces, pieces);
  pieces.ends = std::move(refined.piece_ends);
  run.result.chains = {std::move(pieces), refined.piece_count, std::move(refined.sharp), std::move(links.pieces.ends),
                       std::move(links.before)};
  OrderedMesh kept = select(run, refined, std::move(all), refs);
  run.vertices = std::move(refined.vertices);
  return kept;
}

}  // namespace gcdt
