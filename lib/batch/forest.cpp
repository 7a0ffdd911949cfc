// SPDX-License-Identifier: Apache-2.0
#include "batch/forest.hpp"

#include <algorithm>

#include "batch/forest_copy.hpp"
#include "batch/forest_gather.hpp"
#include "phases/arrange.hpp"
#include "phases/crossings.hpp"
#include "phases/enforce.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

namespace {

class ForestPipeline final : public Pipeline {
 public:
  ForestPipeline(runtime::Runtime& runtime, Primitives& primitives, InputSource source, const Options& options,
                 const BatchInput& batch, const std::vector<std::uint32_t>& numbers, ProblemRanges& ranges)
      : Pipeline(runtime, primitives, std::move(source), options), batch_(batch), numbers_(numbers), ranges_(ranges) {}

  std::vector<Grid> grids;
  std::vector<RoundedTogether> together;
  Buffer<cl_uint> first_triangle, first_piece;

 private:
  OrderResult order_points(InputPoints points) override {
    ranges_.first_input_buffer = upload("first inputs", ranges_.first_input);
    ranges_.first_constraint_buffer = upload("first constraints", ranges_.first_constraint);
    ForestOrder made = order_forest(runtime_, primitives_, std::move(points), ranges_, options_.grid,
                                    runtime_.tuning().coarsest_level);
    grids = std::move(made.grids);
    together = std::move(made.together);
    if (options_.distinct) refuse_together();
    return std::move(made.ordered);
  }

  void refuse_together() const {
    InvalidProblems invalid;
    for (std::uint32_t p = 0; p < together.size(); ++p)
      if (together[p].count > 0) invalid.errors.emplace_back(p, together_error(together[p]));
    if (!invalid.errors.empty()) throw invalid;
  }

  // Crossing constraints are each problem's own error. Pairs are sorted, so by problem.
  [[noreturn]] void reject(const std::vector<Constraint>& crossings) override {
    InvalidProblems invalid;
    for (std::size_t begin = 0, end = 0; begin < crossings.size(); begin = end) {
      const auto& first = ranges_.first_constraint;
      const std::uint32_t p = problem_of_constraint(crossings[begin][0]);
      std::vector<Constraint> own;
      for (; end < crossings.size() && crossings[end][0] < first[p + 1]; ++end)
        own.push_back({crossings[end][0] - first[p], crossings[end][1] - first[p]});
      const Constraint* given = batch_.constraints + batch_.constraint_offsets[numbers_[p]];
      invalid.errors.emplace_back(
          p, crossings_error(
                 own, [&](std::uint32_t c) { return given[c]; }, grids[p].kind == Grid::Kind::rounded));
    }
    throw invalid;
  }

  bool enforce_by_problem() override {
    EnforceResult r = enforce_problems(runtime_, primitives_, vertices_, mesh_, ranges_, constraints_, counters_);
    if (r.crossing) return false;
    statistics_.constraints_zero = r.zero_length;
    auto& cases = statistics_.cases;
    cases.constraint_hits = r.hits;
    cases.existing_edges = r.existing_edges;
    cases.pieces_walked = r.pieces.count - r.existing_edges;
    cases.chain_vertices = r.chain_vertices;
    statistics_.crossed_pairs = r.crossed_pairs;
    statistics_.flips += r.flips;
    pieces_ = std::move(r.pieces);
    return true;
  }

  // Added vertices would be numbered through all problems, and are ordered by their place on one grid: what crosses is
  // to be run alone.
  [[noreturn]] void split_crossings() override {
    Splitter splitter(runtime_, primitives_, constraints_, static_cast<std::uint32_t>(source_.n));
    const auto& marked = splitter.mark_crossing(WalkedMesh{vertices_, mesh_, history_}, pieces_, counters_);
    if (splitter.marked() == 0) fail_without_crossings({});
    std::vector<cl_uint> crosses(ranges_.first_constraint.back());
    runtime_.read(marked, crosses.data(), crosses.size());
    InvalidProblems invalid;
    for (std::uint32_t p = 0; p < ranges_.count(); ++p) {
      const auto first = crosses.begin() + ranges_.first_constraint[p];
      const auto end = crosses.begin() + ranges_.first_constraint[p + 1];
      if (std::find(first, end, 1u) != end) invalid.crossing.push_back(p);
    }
    throw invalid;
  }

  void output() override {
    auto& ms = statistics_.ms;
    OrderedMesh ordered;
    timed("output", ms.output, [&] {
      ticker_.tick("output", 0);
      history_ = {};
      lists_ = {};
      if (by_problem_) {
        ArrangedForest arranged = arrange_problems(runtime_, primitives_, mesh_, vertices_);
        ordered = std::move(arranged.mesh);
        first_triangle = std::move(arranged.first_triangle);
      } else {
        ordered = order_triangles(runtime_, primitives_, mesh_, vertices_, true);
        first_triangle = begins("first triangles", ordered.triangles, 3, ordered.corners);
      }
      ms.gather = ordered.gather_ms;
      mesh_ = {};
      first_piece = begins("first pieces", pieces_.count, 2, pieces_.ends);
    });
    if (options_.check)
      timed("check", ms.check,
            [&] { check_forest(runtime_, ordered, vertices_, pieces_, first_triangle, first_piece); });
    const bool wants_regions = options_.regions || options_.domain != Domain::hull;
    if (wants_regions && ordered.triangles > 0) timed("domain", ms.domain, [&] { select_by_problem(ordered); });
    timed("output", ms.output, [&] { number_by_problem(ordered); });
    result_.mesh = std::move(ordered);
    if (!result_.dropped.allocated()) result_.dropped = runtime_.allocate<cl_uint>("dropped constraints", 0);
  }

  // Regions do not lead from one problem to another, and outside is the same for all; so a search through the forest
  // is one through each problem, and the order of triangles and half edges within each is what it would be alone.
  void select_by_problem(OrderedMesh& ordered) {
    SelectedDomain selected = select_domain(runtime_, primitives_, ordered, vertices_, pieces_, turns_, options_);
    turns_ = {};
    result_.regions = std::move(selected.regions);
    const Buffer<cl_uint> first_of_hull = std::move(first_triangle);
    if (options_.domain != Domain::hull) ordered = std::move(selected.mesh);
    first_triangle = begins("first triangles", ordered.triangles, 3, ordered.corners);
    runtime_.launch("forest", "forest_local_regions", over(ordered.triangles), cl_uint{ordered.triangles},
                    vertices_.n(), vertices_.points, ordered.corners, first_of_hull, selected.region_of_hull,
                    result_.regions.region);
  }

  void number_by_problem(const OrderedMesh& ordered) {
    const cl_uint n = vertices_.n(), inputs = static_cast<cl_uint>(source_.n);
    runtime_.launch("forest", "forest_local_triangles", over(ordered.triangles), cl_uint{ordered.triangles}, n,
                    vertices_.points, vertices_.vertex_input, ranges_.first_input_buffer, first_triangle,
                    ordered.corners, ordered.neighbours);
    result_.representatives = runtime_.allocate<cl_uint>("output representatives", inputs);
    runtime_.launch("forest", "forest_representatives", over(inputs), inputs, n, vertices_.points,
                    vertices_.vertex_input, vertices_.input_vertex, ranges_.first_input_buffer,
                    result_.representatives);
    runtime_.launch("forest", "forest_local_sources", over(pieces_.source_count), cl_uint{pieces_.source_count},
                    ranges_.count(), ranges_.first_constraint_buffer, pieces_.sources);
    runtime_.launch("forest", "forest_local_pieces", over(pieces_.count), cl_uint{pieces_.count}, n, vertices_.points,
                    vertices_.vertex_input, ranges_.first_input_buffer, pieces_.ends);
    if (pieces_.count == 0) runtime_.fill<cl_uint>(pieces_.source_offsets, 0, 1);
  }

  template <class T>
  Buffer<cl_uint> begins(const char* name, cl_uint count, cl_uint stride, const Buffer<T>& things) {
    const cl_uint problems = ranges_.count();
    auto found = runtime_.allocate<cl_uint>(name, std::size_t{problems} + 1);
    runtime_.launch("forest", "forest_begins", over(std::size_t{problems} + 1), problems, count, stride, vertices_.n(),
                    vertices_.points, things, found);
    return found;
  }

  std::uint32_t problem_of_constraint(std::uint32_t c) const {
    const auto& first = ranges_.first_constraint;
    return static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), c) - first.begin() - 1);
  }

  Buffer<cl_uint> upload(const char* name, const std::vector<cl_uint>& values) {
    auto buffer = runtime_.allocate<cl_uint>(name, values.size());
    runtime_.write(buffer, values.data(), values.size());
    return buffer;
  }

  const BatchInput& batch_;
  const std::vector<std::uint32_t>& numbers_;
  ProblemRanges& ranges_;
};

}  // namespace

ForestResult triangulate_forest(runtime::Runtime& runtime, Primitives& primitives, const BatchInput& batch,
                                std::vector<std::uint32_t> numbers, const Options& options, Staging& staging) {
  ForestResult result;
  ProblemRanges ranges = ranges_of(batch, numbers);
  ForestRoom room(runtime, ranges, staging, result);
  const InputSource source = {ranges.first_input.back(), ranges.first_constraint.back(),
                              [&] { return gather(runtime, batch, numbers, ranges, staging.chunks); }};
  runtime.memory().begin_call();
  ForestPipeline pipeline(runtime, primitives, source, options, batch, numbers, ranges);
  const DeviceTriangulation made = pipeline.run();
  runtime.tracer().begin_phase("copy");
  room.wait();
  copy_forest(runtime, made, pipeline.first_triangle, pipeline.first_piece, ranges, staging, result);
  runtime.tracer().end_phase();
  result.problems = std::move(numbers);
  result.grids = std::move(pipeline.grids);
  result.together = std::move(pipeline.together);
  result.statistics = made.statistics;
  return result;
}

// Beside what one problem of that size needs: the second sort, the problems of vertices, tables of problems.
std::uint64_t forest_bytes(std::uint64_t problems, std::uint64_t n, std::uint64_t m) {
  return device_bytes_needed(n + problems, m, 2 * n + problems) + 24 * n + 256 * problems;
}

}  // namespace gcdt
