// SPDX-License-Identifier: Apache-2.0
#include "batch/pipeline.hpp"

#include <algorithm>
#include <utility>

#include "batch/copy.hpp"
#include "batch/gather.hpp"
#include "batch/order_problems.hpp"
#include "phases/check.hpp"
#include "phases/domain_each.hpp"
#include "solve/crossing_policy.hpp"
#include "solve/memory.hpp"
#include "solve/programs.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

namespace {

/// A run of many problems in one mesh, with what a run of one problem does not have.
struct ForestRun : Run {
  ForestRun(runtime::Runtime& device, Primitives& all, const Options& wanted, const BatchInput& whole,
            const std::vector<std::uint32_t>& some, ProblemRanges& begins)
      : Run(device, all, wanted, begins.first_input.back(), begins.first_constraint.back()),
        batch(whole),
        numbers(some),
        ranges(begins) {}

  const BatchInput& batch;
  const std::vector<std::uint32_t>& numbers;  ///< of the problems in the batch
  ProblemRanges& ranges;
  std::vector<Grid> grids;                               ///< of each problem
  std::vector<RoundedTogether> together;                 ///< of each problem; empty if no problem has any
  Buffer<cl_uint> first_triangle, first_piece;           ///< of each problem
  std::vector<std::pair<std::uint32_t, Error>> refused;  ///< as in ForestResult
  std::vector<std::uint32_t> to_split;                   ///< as in ForestResult
};

void take(ForestRun& run, ForestOrder made) {
  run.grids = std::move(made.grids);
  run.together = std::move(made.together);
  InvalidProblems invalid;
  for (std::uint32_t p = 0; run.options.distinct && p < run.together.size(); ++p)
    if (run.together[p].count > 0) invalid.errors.emplace_back(p, together_error(run.together[p]));
  if (!invalid.errors.empty()) throw invalid;
  run.take(std::move(made.ordered));
}

/// Where the things of each problem begin. A thing has `stride` words, and the first one is a vertex.
template <class T>
Buffer<cl_uint> begins(ForestRun& run, const char* name, cl_uint count, cl_uint stride, const Buffer<T>& things) {
  const cl_uint problems = run.ranges.count();
  auto found = run.runtime.allocate<cl_uint>(name, std::size_t{problems} + 1);
  run.runtime.launch("forest", "forest_begins", over(std::size_t{problems} + 1), problems, count, stride,
                     run.vertices.n(), run.vertices.points, things, found);
  return found;
}

// The problems that have a constraint c with marks[c] != 0.
std::vector<std::uint32_t> problems_of(const ForestRun& run, const std::vector<cl_uint>& marks) {
  const auto& begins = run.ranges.first_constraint;
  std::vector<std::uint32_t> found;
  for (std::uint32_t p = 0; p < run.ranges.count(); ++p) {
    const auto end = marks.begin() + begins[p + 1];
    if (std::find(marks.begin() + begins[p], end, 1u) != end) found.push_back(p);
  }
  return found;
}

// One word for each constraint: 1 for those of the problems.
std::vector<cl_uint> constraints_of(const ForestRun& run, const std::vector<std::uint32_t>& problems) {
  const auto& begins = run.ranges.first_constraint;
  std::vector<cl_uint> words(begins.back(), 0);
  for (const std::uint32_t p : problems) std::fill(words.begin() + begins[p], words.begin() + begins[p + 1], 1);
  return words;
}

// Each problem that has crossing constraints gets an error of its own. The pairs are sorted, so those of a problem
// follow one another. Returns the problems.
std::vector<std::uint32_t> refuse(ForestRun& run, const std::vector<Constraint>& crossings) {
  std::vector<std::uint32_t> problems;
  const auto& first = run.ranges.first_constraint;
  for (std::size_t begin = 0, end = 0; begin < crossings.size(); begin = end) {
    const auto after = std::upper_bound(first.begin(), first.end(), crossings[begin][0]);
    const auto p = static_cast<std::uint32_t>(after - first.begin() - 1);
    std::vector<Constraint> own;
    for (; end < crossings.size() && crossings[end][0] < first[p + 1]; ++end)
      own.push_back({crossings[end][0] - first[p], crossings[end][1] - first[p]});
    const Constraint* given = run.batch.constraints + run.batch.constraint_offsets[run.numbers[p]];
    problems.push_back(p);
    run.refused.emplace_back(
        p, crossings_error(
               own, [&](std::uint32_t c) { return given[c]; }, run.grids[p].kind == Grid::Kind::rounded));
  }
  return problems;
}

// Splitting adds vertices, numbers them through the whole mesh and orders them by their places on one grid. A forest
// has many grids, so problems that cross are split one by one.
std::vector<std::uint32_t> leave_to_split(ForestRun& run, const ConstrainResult& failed) {
  Splitter splitter(run.runtime, run.primitives, run.constraints, static_cast<std::uint32_t>(run.n));
  const auto& marked = splitter.mark_crossing(run.walked(), run.pieces, run.counters);
  if (splitter.marked() == 0) fail_without_crossings(failed);
  std::vector<cl_uint> crosses(run.ranges.first_constraint.back());
  run.runtime.read(marked, crosses.data(), crosses.size());
  return run.to_split = problems_of(run, crosses);
}

// The problems that cross have all of their constraints but those from the first on that crosses another (or, under
// Crossing::drop, but those that do). So every problem is constrained Delaunay, and any such mesh shows what crosses.
void follow_crossing_policy(ForestRun& run, const std::vector<cl_uint>& crosses) {
  if (run.options.crossing == Crossing::drop) {
    std::vector<std::uint32_t> dropped;
    for (std::uint32_t c = 0; c < crosses.size(); ++c)
      if (crosses[c] != 0) dropped.push_back(c);
    return name_dropped(run, dropped);
  }
  const std::vector<std::uint32_t> problems = problems_of(run, crosses);
  if (run.options.crossing == Crossing::split) {
    run.to_split = problems;
    return;
  }
  run.history = freeze_all(run.runtime, run.vertices, run.mesh, run.counters);
  run.clean(run.constraints, run.n, constraints_of(run, problems));
  if (refuse(run, find_crossings(run, {})) != problems) fail_without_crossings({});
}

// Each problem's constraints by one work-item.
void enforce_each(ForestRun& run) {
  EnforceResult r = run.enforce_in_order(run.ranges.first_constraint_buffer);
  if (!r.crosses.empty()) follow_crossing_policy(run, r.crosses);
  run.pieces = std::move(r.pieces);
}

// The run's pieces but those of the problems. `walked`: the mesh is the one in which they were cleaned.
Pieces pieces_without(ForestRun& run, const std::vector<std::uint32_t>& problems, bool walked) {
  runtime::Runtime& runtime = run.runtime;
  Pieces& all = run.pieces;
  const std::size_t ends = std::size_t{run.ranges.count()} + 1;
  const auto first_piece = begins(run, "first pieces", all.count, 2, all.ends);
  const auto first_source = runtime.allocate<cl_uint>("first sources", ends);
  runtime.launch("forest", "forest_problem_at", over(ends), static_cast<cl_uint>(ends), first_piece, all.source_offsets,
                 first_source);
  std::vector<cl_uint> piece(ends), source(ends);
  runtime.read(first_piece, piece.data(), ends);
  runtime.read(first_source, source.data(), ends);
  std::vector<cl_uint2> moves(ends);
  cl_uint pieces_out = 0, sources_out = 0;
  for (std::uint32_t p = 0, next = 0; p + 1 < ends; ++p) {
    const bool out = next < problems.size() && problems[next] == p;
    moves[p] = {{out ? GCDT_NONE : pieces_out, sources_out}};
    if (!out) continue;
    pieces_out += piece[p + 1] - piece[p], sources_out += source[p + 1] - source[p];
    ++next;
  }
  Pieces kept;
  kept.count = all.count - pieces_out, kept.source_count = all.source_count - sources_out;
  kept.ends = runtime.allocate<cl_uint2>("pieces", kept.count);
  kept.source_offsets = runtime.allocate<cl_uint>("source offsets", std::size_t{kept.count} + 1);
  kept.sources = runtime.allocate<cl_uint>("sources of pieces", kept.source_count);
  kept.walked.weights = runtime.allocate<cl_uint>("weights of pieces", kept.count);
  kept.walked.parts = runtime.allocate<cl_uint2>("parts of whole pieces", kept.count);
  kept.walked.faces = std::move(all.walked.faces);
  kept.walked.passed = std::move(all.walked.passed);
  kept.walked.crossed = all.walked.crossed, kept.walked.pool = all.walked.pool;
  runtime.launch("forest", "forest_keep_pieces", over(all.count), cl_uint{all.count}, cl_uint{walked}, run.vertices.n(),
                 run.vertices.points, runtime.upload("moves of pieces", moves), all.ends, all.source_offsets,
                 all.sources, all.walked.weights, all.walked.parts, kept.ends, kept.source_offsets, kept.sources,
                 kept.walked.weights, kept.walked.parts);
  runtime.fill<cl_uint>(kept.source_offsets, kept.source_count, 1, kept.count);
  return kept;
}

// All constraints at once; if some cross, all again but those that are dropped, or those of problems that cross.
void enforce_all(ForestRun& run) {
  const ConstrainResult enforced = run.clean_and_enforce(run.constraints, run.n);
  if (!enforced.failed) return;
  if (enforced.mesh_changed) run.insert();
  if (run.options.crossing == Crossing::drop) return drop_crossings(run, find_crossings(run, enforced));
  const std::vector<std::uint32_t> problems = run.options.crossing == Crossing::split
                                                  ? leave_to_split(run, enforced)
                                                  : refuse(run, find_crossings(run, enforced));
  run.pieces = pieces_without(run, problems, !enforced.mesh_changed);
  enforce_rest(run);
}

void constrain(ForestRun& run) {
  run.pieces = {};
  if (run.m == 0) return run.no_pieces();
  run.ticker.tick("constrain", 0);
  run.plan.constraints == Plan::By::all ? enforce_all(run) : enforce_each(run);
  run.pieces.walked = {};
  run.count_turns();
}

OrderedMesh put_in_order(ForestRun& run) {
  run.ticker.tick("output", 0);
  run.history = {};
  run.lists = {};
  OrderedMesh ordered;
  if (run.plan.output == Plan::By::each) {
    ArrangedForest arranged = arrange_problems(run.runtime, run.primitives, run.mesh, run.vertices);
    ordered = std::move(arranged.mesh);
    run.first_triangle = std::move(arranged.first_triangle);
  } else {
    ordered = order_triangles(run.runtime, run.primitives, run.plan, run.mesh, run.vertices, true);
    run.first_triangle = begins(run, "first triangles", ordered.triangles, 3, ordered.corners);
  }
  run.statistics.ms.gather = ordered.gather_ms;
  run.mesh = {};
  run.first_piece = begins(run, "first pieces", run.pieces.count, 2, run.pieces.ends);
  return ordered;
}

// No region leads from one problem to another, and the outside is the same for all. So a search through the forest is a
// search through each problem, and within each the order of triangles and half edges is what the problem would have by
// itself.
void select_domain(ForestRun& run, OrderedMesh& ordered) {
  if (run.plan.output == Plan::By::each) {
    SelectedDomains selected =
        select_domains(run.runtime, run.primitives, ordered, run.vertices, run.pieces, std::exchange(run.turns, {}),
                       run.first_triangle, run.first_piece, run.options.domain);
    run.result.regions = std::move(selected.regions);
    run.first_triangle = std::move(selected.first_triangle);
    if (run.options.domain != Domain::hull) ordered = std::move(selected.mesh);
    return;
  }
  const SelectedDomain selected = run.select(ordered);
  const Buffer<cl_uint> first_of_hull = std::move(run.first_triangle);
  run.first_triangle = begins(run, "first triangles", ordered.triangles, 3, ordered.corners);
  run.runtime.launch("forest", "forest_local_regions", over(ordered.triangles), cl_uint{ordered.triangles},
                     run.vertices.n(), run.vertices.points, ordered.corners, first_of_hull, selected.region_of_hull,
                     run.result.regions.region);
}

void number(ForestRun& run, OrderedMesh ordered) {
  runtime::Runtime& runtime = run.runtime;
  const Vertices& vertices = run.vertices;
  const Buffer<cl_uint>& first_input = run.ranges.first_input_buffer;
  Pieces& pieces = run.pieces;
  const cl_uint n = vertices.n(), inputs = static_cast<cl_uint>(run.n);
  runtime.launch("forest", "forest_local_triangles", over(ordered.triangles), cl_uint{ordered.triangles}, n,
                 vertices.points, vertices.vertex_input, first_input, run.first_triangle, ordered.corners,
                 ordered.neighbours);
  run.result.representatives = runtime.allocate<cl_uint>("output representatives", inputs);
  runtime.launch("forest", "forest_representatives", over(inputs), inputs, n, vertices.points, vertices.vertex_input,
                 vertices.input_vertex, first_input, run.result.representatives);
  runtime.launch("forest", "forest_local_sources", over(pieces.source_count), cl_uint{pieces.source_count},
                 run.ranges.count(), run.ranges.first_constraint_buffer, pieces.sources);
  runtime.launch("forest", "forest_local_pieces", over(pieces.count), cl_uint{pieces.count}, n, vertices.points,
                 vertices.vertex_input, first_input, pieces.ends);
  if (pieces.count == 0) runtime.fill<cl_uint>(pieces.source_offsets, 0, 1);
  run.result.mesh = std::move(ordered);
}

/// The steps of solve/triangulate.cpp, for many problems.
DeviceTriangulation run_steps(ForestRun& run, runtime::TransferChunks& chunks) {
  auto& ms = run.statistics.ms;
  run.step("order", ms.order, ordered_share, [&] {
    run.ticker.tick("order", 0);
    DeviceInput input = gather(run.runtime, run.batch, run.numbers, run.ranges, chunks);
    run.constraints = std::move(input.constraints);
    run.ranges.first_input_buffer = run.runtime.upload("first inputs", run.ranges.first_input);
    run.ranges.first_constraint_buffer = run.runtime.upload("first constraints", run.ranges.first_constraint);
    take(run, order_problems(run.runtime, run.primitives, std::move(input.points), run.ranges, run.options.grid));
  });
  run.tell_plan();
  run.step("insert", ms.insert, inserted_share, [&] { run.insert(); });
  run.step("constrain", ms.constrain, constrained_share, [&] { constrain(run); });
  run.step("flip", ms.flip, flipped_share, [&] { run.flip(); });
  OrderedMesh ordered;
  run.step("output", ms.output, 1, [&] { ordered = put_in_order(run); });
  if (run.options.check)
    run.step("check", ms.check, [&] {
      check_problems(run.runtime, run.plan, ordered, run.vertices, run.pieces, run.first_triangle, run.first_piece);
    });
  if (run.wants_regions() && ordered.triangles > 0) run.step("domain", ms.domain, [&] { select_domain(run, ordered); });
  run.step("output", ms.output, [&] { number(run, std::move(ordered)); });
  return run.finish();
}

}  // namespace

ForestResult triangulate_forest(runtime::Runtime& runtime, Primitives& primitives, const BatchInput& batch,
                                std::vector<std::uint32_t> numbers, const Options& options, Staging& staging) {
  ForestResult result;
  ProblemRanges ranges = ranges_of(batch, numbers);
  ForestRoom room(runtime, ranges, staging, result);
  runtime.memory().begin_call();
  runtime.use_programs(runtime::Meshes::many);
  const runtime::Builders ahead(runtime, programs_of_call({runtime::Meshes::many, ranges.first_constraint.back() > 0}));
  ForestRun run(runtime, primitives, options, batch, numbers, ranges);
  const DeviceTriangulation made = run_steps(run, staging.chunks);
  runtime.tracer().begin_phase("copy");
  room.wait();
  copy_forest(runtime, made, run.first_triangle, run.first_piece, ranges, staging, result);
  runtime.tracer().end_phase();
  result.problems = std::move(numbers);
  result.grids = std::move(run.grids);
  result.together = std::move(run.together);
  result.refused = std::move(run.refused);
  result.to_split = std::move(run.to_split);
  result.statistics = made.statistics;
  return result;
}

// What one problem of that size needs, and besides the second sort, the problems of vertices, and tables of problems.
std::uint64_t forest_bytes(std::uint64_t problems, std::uint64_t n, std::uint64_t m) {
  return device_bytes_needed(n + problems, m, 2 * n + problems) + 24 * n + 256 * problems;
}

}  // namespace gcdt
