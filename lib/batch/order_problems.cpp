// SPDX-License-Identifier: Apache-2.0
#include "batch/order_problems.hpp"

#include <algorithm>

#include "device/step.hpp"
#include "mesh/grid.hpp"
#include "mesh/phase.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

namespace {

class ProblemOrdering {
 public:
  ProblemOrdering(runtime::Runtime& runtime, InputPoints points, const ProblemRanges& ranges)
      : runtime_(runtime), points_(std::move(points)), ranges_(ranges), problems_(ranges.count()) {
    for (cl_uint p = 0; p < problems_; ++p) largest_ = std::max(largest_, size(p));
    cut();
  }

  void choose_grids(const std::optional<FixedGrid>& fixed) {
    std::optional<ChosenGrid> given;
    if (fixed) given = fixed_grid(*fixed);
    const std::vector<cl_ulong> found = survey();
    chosen_.resize(problems_);
    std::vector<cl_int> limits(problems_, -1);
    std::vector<GridChoice> choices(problems_);
    bool any_decimal = false;
    for (cl_uint p = 0; p < problems_; ++p) {
      if (given) chosen_[p] = *given;
      if (given || size(p) == 0) continue;
      choices[p] = choose_grid(survey_of(&found[std::size_t{p} * GCDT_SURVEY_COLUMNS]));
      chosen_[p] = choices[p].grid;
      limits[p] = choices[p].decimals_limit;
      any_decimal = any_decimal || limits[p] >= 0;
    }
    if (any_decimal) try_decimals(limits, choices);
  }

  /// Leaves keys, values and input_problem.
  void quantise() {
    std::vector<device::ProblemGrid> grids(problems_);
    for (cl_uint p = 0; p < problems_; ++p) {
      grids[p].scale = chosen_[p].scale;
      grids[p].is_decimal = chosen_[p].decimals ? 1 : 0;
      if (chosen_[p].decimals) grids[p].decimals = *chosen_[p].decimals;
    }
    const auto grid_buffer = runtime_.upload("grids of problems", grids);
    keys_ = runtime_.allocate<cl_ulong>("Morton codes", points_.n);
    values_ = runtime_.allocate<cl_uint>("input numbers", points_.n);
    input_problem_ = runtime_.allocate<cl_uint>("problems of inputs", points_.n);
    auto maxima = runtime_.allocate<cl_ulong>("maxima", std::size_t{chunks_} * GCDT_QUANTISE_COLUMNS);
    runtime_.launch("forest", "forest_quantise", over(chunks_), chunks_, chunk_buffer_, ranges_.first_input_buffer,
                    points_.type, points_.coordinates, grid_buffer, keys_, values_, input_problem_, maxima);
    const std::vector<cl_ulong> found = fold(maxima, GCDT_QUANTISE_COLUMNS);
    InvalidProblems invalid;
    for (cl_uint p = 0; p < problems_; ++p) {
      const cl_ulong* row = &found[std::size_t{p} * GCDT_QUANTISE_COLUMNS];
      const cl_ulong outside = row[GCDT_QUANTISE_OUTSIDE];
      if (outside != 0)
        invalid.errors.emplace_back(
            p, coordinate_error(Status::coordinate_outside_grid, " is outside the grid", ~outside));
      if (outside == 0 && !chosen_[p].decimals && size(p) != 0) {
        chosen_[p].grid.largest_move =
            largest_move(runtime_, points_, ranges_.first_input[p], ranges_.first_input[p + 1], row[GCDT_QUANTISE_MOVE],
                         chosen_[p].scale);
        may_round_together_ = may_round_together_ || may_round_together(chosen_[p].grid);
      }
    }
    if (!invalid.errors.empty()) throw invalid;
    if (!may_round_together_) points_ = {};
  }

  // Sorts each problem's vertices by their keys within the problem's places, or sorts all vertices twice, stably: by
  // key, then by problem. The vertices of a single problem are sorted by their keys.
  void sort(Primitives& primitives, cl_uint n) {
    if (problems_ == 1) return primitives.sort(keys_, values_, n, GCDT_MORTON_BITS);
    const Plan::By by = plan_of(0).sort_problems;
    if (by == Plan::By::groups) return primitives.sort_segments(keys_, values_, ranges_.first_input_buffer, problems_);
    if (by == Plan::By::each) {
      const auto other_keys = runtime_.allocate<cl_ulong>("other half of the keys", n);
      const auto other_values = runtime_.allocate<cl_uint>("other half of the values", n);
      runtime_.launch("arrange", "arrange_keys", runtime::over_large(problems_), problems_, ranges_.first_input_buffer,
                      keys_, values_, other_keys, other_values);
      return;
    }
    auto key_of_input = runtime_.allocate<cl_ulong>("Morton codes of inputs", n);
    runtime_.copy(keys_, key_of_input, n);
    primitives.sort(keys_, values_, n, GCDT_MORTON_BITS);
    auto problems = runtime_.allocate<cl_uint>("problems in order", n);
    runtime_.launch("forest", "forest_problem_at", over(n), n, values_, input_problem_, problems);
    primitives.sort(problems, values_, n, bit_width(problems_ - 1));
    input_problem_ = std::move(problems);
    runtime_.launch("forest", "forest_key_at", over(n), n, values_, key_of_input, keys_);
  }

  OrderResult number(Primitives& primitives, cl_uint n) {
    auto before = runtime_.allocate<cl_uint>("distinct before", std::size_t{n} + 1);
    runtime_.launch("forest", "forest_mark_first", over(n), n, input_problem_, keys_, before);
    const cl_uint distinct = primitives.scan_total(before, n);
    OrderResult result;
    result.merged = n - distinct;
    Vertices& vertices = result.vertices;
    vertices.roots = problems_;
    vertices.largest = largest_;
    vertices.levels = device::make_levels(distinct, coarsest(distinct));
    vertices.levels_buffer = runtime_.upload_one("levels", vertices.levels);
    vertices.points = runtime_.allocate<cl_int2>("points", device::gcdt_forest_points(distinct, problems_));
    vertices.vertex_input = runtime_.allocate<cl_uint>("vertex inputs", distinct);
    vertices.input_vertex = runtime_.allocate<cl_uint>("input vertices", n);
    runtime_.launch("forest", "forest_number", over(n), n, vertices.levels_buffer, input_problem_, keys_, values_,
                    before, vertices.points, vertices.vertex_input, vertices.input_vertex);
    runtime_.launch("forest", "forest_first_ranks", over(std::size_t{problems_} + 1), problems_, distinct,
                    ranges_.first_input_buffer, before, vertices.points);
    return result;
  }

  std::vector<RoundedTogether> together(const OrderResult& ordered) const {
    if (!may_round_together_ || ordered.merged == 0) return {};
    return rounded_together(runtime_, points_, ordered.vertices, ranges_.first_input);
  }

  std::vector<Grid> grids() const {
    std::vector<Grid> grids(problems_);
    for (cl_uint p = 0; p < problems_; ++p) grids[p] = chosen_[p].grid;
    return grids;
  }

 private:
  Plan plan_of(cl_uint distinct) const {
    return make_plan(runtime_, {problems_, ranges_.first_input.back(), distinct, largest_});
  }
  cl_uint size(cl_uint p) const { return ranges_.first_input[p + 1] - ranges_.first_input[p]; }

  // Returns how many vertices the coarsest level has. One level has all of them where the plan needs no more: then
  // numbers are ranks, those of a problem are consecutive, and so are the faces and edges that they bring. Else there
  // are as many levels as the largest problem would have by itself, and the vertices of smaller ones are in the finest
  // levels.
  std::uint32_t coarsest(cl_uint distinct) const {
    const Plan plan = plan_of(distinct);
    if (plan.one_level) return std::max(distinct, 1u);
    const std::uint64_t largest = std::max<cl_uint>(largest_, plan.coarsest_level);
    return static_cast<std::uint32_t>((std::uint64_t{distinct} * plan.coarsest_level + largest - 1) / largest);
  }

  void cut() {
    const cl_uint span = std::max(Tuning::least_chunk, largest_ / Tuning::most_chunks + 1);
    std::vector<device::Chunk> chunks;
    std::vector<cl_uint> first_chunk;
    for (cl_uint p = 0; p < problems_; ++p) {
      first_chunk.push_back(static_cast<cl_uint>(chunks.size()));
      const cl_uint end = ranges_.first_input[p + 1];
      for (cl_uint first = ranges_.first_input[p]; first < end;) {
        const cl_uint next = end - first > span ? first + span : end;
        chunks.push_back({first, next, p, 0});
        first = next;
      }
    }
    first_chunk.push_back(static_cast<cl_uint>(chunks.size()));
    chunks_ = first_chunk.back();
    chunk_buffer_ = runtime_.upload("chunks", chunks);
    first_chunk_ = runtime_.upload("first chunks", first_chunk);
  }

  // Folds rows of chunks to one row a problem: the greatest of each column. Blocks.
  std::vector<cl_ulong> fold(const Buffer<cl_ulong>& maxima, cl_uint columns) {
    const std::size_t elements = std::size_t{problems_} * columns;
    auto folded = runtime_.allocate<cl_ulong>("folded maxima", elements);
    runtime_.launch("forest", "forest_fold", over(elements), problems_, columns, first_chunk_, maxima, folded);
    std::vector<cl_ulong> found(elements);
    runtime_.read(folded, found.data(), elements);
    return found;
  }

  std::vector<cl_ulong> survey() {
    auto maxima = runtime_.allocate<cl_ulong>("maxima", std::size_t{chunks_} * GCDT_SURVEY_COLUMNS);
    runtime_.launch("forest", "forest_survey", over(chunks_), chunks_, chunk_buffer_, ranges_.first_input_buffer,
                    points_.type, points_.coordinates, maxima);
    std::vector<cl_ulong> found = fold(maxima, GCDT_SURVEY_COLUMNS);
    InvalidProblems invalid;
    for (cl_uint p = 0; p < problems_; ++p) {
      const cl_ulong bad = found[std::size_t{p} * GCDT_SURVEY_COLUMNS + GCDT_SURVEY_BAD];
      if (bad != 0) invalid.errors.emplace_back(p, survey_error(points_.type, ~bad));
    }
    if (!invalid.errors.empty()) throw invalid;
    return found;
  }

  void try_decimals(const std::vector<cl_int>& limits, const std::vector<GridChoice>& choices) {
    const auto limit_buffer = runtime_.upload("limits of decimals", limits);
    auto maxima = runtime_.allocate<cl_ulong>("maxima", chunks_);
    runtime_.launch("forest", "forest_decimals", over(chunks_), chunks_, chunk_buffer_, points_.type,
                    points_.coordinates, limit_buffer, maxima);
    const std::vector<cl_ulong> found = fold(maxima, 1);
    for (cl_uint p = 0; p < problems_; ++p)
      if (limits[p] >= 0) chosen_[p] = choices[p].with_decimals(static_cast<int>(found[p]));
  }

  runtime::Runtime& runtime_;
  InputPoints points_;
  const ProblemRanges& ranges_;
  cl_uint problems_, chunks_ = 0;
  cl_uint largest_ = 1;  ///< inputs of the largest problem, at least one
  bool may_round_together_ = false;
  Buffer<device::Chunk> chunk_buffer_;
  Buffer<cl_uint> first_chunk_, values_, input_problem_;
  Buffer<cl_ulong> keys_;
  std::vector<ChosenGrid> chosen_;
};

}  // namespace

ForestOrder order_problems(runtime::Runtime& runtime, Primitives& primitives, InputPoints points,
                           const ProblemRanges& ranges, const std::optional<FixedGrid>& fixed) {
  const cl_uint n = points.n;
  ProblemOrdering ordering(runtime, std::move(points), ranges);
  ordering.choose_grids(fixed);
  ordering.quantise();
  runtime.end_step();
  Step sorting(runtime, "sort");
  ordering.sort(primitives, n);
  primitives.release();
  ForestOrder result;
  result.ordered = ordering.number(primitives, n);
  result.grids = ordering.grids();
  result.together = ordering.together(result.ordered);
  result.ordered.sort_ms = sorting.end();
  return result;
}

}  // namespace gcdt
