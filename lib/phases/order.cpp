// SPDX-License-Identifier: Apache-2.0
#include "phases/order.hpp"

#include <algorithm>
#include <vector>

#include "device/step.hpp"
#include "mesh/grid.hpp"
#include "mesh/phase.hpp"
#include "phases/levels.hpp"
#include "phases/maxima.hpp"

namespace gcdt {

namespace {

/// Every vertex's Morton code and number.
struct Keys {
  Grid grid;
  std::optional<device::Decimals> decimals;
  runtime::Buffer<cl_ulong> codes;
  runtime::Buffer<cl_uint> numbers;
};

/// Of the maxima of kernel `survey`.
Survey checked_survey(cl_uint type, const cl_ulong* found) {
  if (found[GCDT_SURVEY_BAD] != 0) throw survey_error(type, ~found[GCDT_SURVEY_BAD]);
  return survey_of(found);
}

/// Of the maxima of kernel `quantise`; the largest move.
double checked_move(runtime::Runtime& runtime, const InputPoints& points, const cl_ulong* found,
                    const device::Scale& scale) {
  check_outside(found[GCDT_QUANTISE_OUTSIDE]);
  return largest_move(runtime, points, 0, points.n, found[GCDT_QUANTISE_MOVE], scale);
}

// In the order of docs/contract.md, 1: binary, decimal, rounded. A given grid is read first, as an error in it is the
// caller's; the survey is made for it, too, since it finds what is not finite, unless that cannot be.
ChosenGrid choose_grid(runtime::Runtime& runtime, const InputPoints& staged, const std::optional<FixedGrid>& fixed) {
  std::optional<ChosenGrid> given;
  if (fixed) given = fixed_grid(*fixed);
  if (given && staged.type == GCDT_COORDINATES_INT32) return *given;
  const Survey found = checked_survey(staged.type, survey_maxima(runtime, staged).data());
  if (given) return *given;
  const GridChoice choice = gcdt::choose_grid(found);
  if (choice.decimals_limit < 0) return choice.grid;
  return choice.with_decimals(count_decimals(runtime, staged, choice.decimals_limit));
}

Keys quantise(runtime::Runtime& runtime, const InputPoints& staged, const ChosenGrid& chosen) {
  Codes made = codes_on(runtime, staged, chosen);
  Keys keys = {chosen.grid, chosen.decimals, std::move(made.codes), std::move(made.numbers)};
  if (!chosen.decimals) keys.grid.largest_move = checked_move(runtime, staged, made.maxima.data(), chosen.scale);
  return keys;
}

OrderResult no_vertices(runtime::Runtime& runtime, const std::optional<FixedGrid>& fixed,
                        std::uint32_t coarsest_level) {
  OrderResult result;
  if (fixed) result.vertices.grid = fixed_grid(*fixed).grid;
  result.vertices.input_vertex = runtime.allocate<cl_uint>("input vertices", 0);
  result.vertices.levels = device::make_levels(0, coarsest_level);
  result.vertices.levels_buffer = runtime.upload_one("levels", result.vertices.levels);
  result.vertices.points = runtime.allocate<cl_int2>("points", 0);
  result.vertices.vertex_input = runtime.allocate<cl_uint>("vertex inputs", 0);
  return result;
}

void set_together(runtime::Runtime& runtime, const InputPoints& points, OrderResult& result) {
  if (result.merged == 0 || !may_round_together(result.vertices.grid)) return;
  result.together = rounded_together(runtime, points, result.vertices, {0, points.n})[0];
}

// Few vertices, where a work-item is a thread: by one of them.
OrderResult order_by_one_item(runtime::Runtime& runtime, const Plan& plan, const InputPoints& points,
                              const std::optional<FixedGrid>& fixed) {
  const cl_uint n = points.n;
  std::optional<ChosenGrid> given;
  if (fixed) given = fixed_grid(*fixed);
  device::OrderReport report = {};
  if (given) report.scale = given->scale;
  const auto reported = runtime.upload_one("order report", report);
  const auto keys = runtime.allocate<cl_ulong>("Morton codes", n),
             other_keys = runtime.allocate<cl_ulong>("other half of the keys", n);
  const auto numbers = runtime.allocate<cl_uint>("input numbers", n),
             other_numbers = runtime.allocate<cl_uint>("other half of the values", n);
  OrderResult result;
  Vertices& vertices = result.vertices;
  vertices.input_vertex = runtime.allocate<cl_uint>("input vertices", n);
  vertices.levels_buffer = runtime.allocate<device::Levels>("levels", 1);
  vertices.points = runtime.allocate<cl_int2>("points", n);
  vertices.vertex_input = runtime.allocate<cl_uint>("vertex inputs", n);
  runtime.launch("by_one_item", "order_by_one_item", runtime::one_item(), n, points.type, points.coordinates,
                 cl_uint(!!given), cl_uint{plan.coarsest_level}, reported, keys, numbers, other_keys, other_numbers,
                 vertices.levels_buffer, vertices.points, vertices.vertex_input, vertices.input_vertex);
  report = runtime.read_one(reported);

  const Survey found = checked_survey(points.type, report.surveyed);
  ChosenGrid chosen;
  if (given) {
    chosen = *given;
  } else {
    const GridChoice choice = choose_grid(found);
    chosen = report.decimal_digits >= 0 ? choice.with_decimals(report.decimal_digits) : choice.grid;
  }
  vertices.grid = chosen.grid;
  vertices.decimals = chosen.decimals;
  if (!chosen.decimals) vertices.grid.largest_move = checked_move(runtime, points, report.quantised, chosen.scale);
  vertices.levels = device::make_levels(report.distinct, plan.coarsest_level);
  vertices.points.shrink(report.distinct);
  vertices.vertex_input.shrink(report.distinct);
  result.merged = n - report.distinct;
  set_together(runtime, points, result);
  return result;
}

}  // namespace

Error coordinate_error(Status status, const char* what, std::uint64_t coordinate) {
  const std::uint64_t vertex = coordinate / 2, axis = coordinate % 2;
  return Error(status, std::string(axis == 0 ? "x" : "y") + " of vertex " + std::to_string(vertex) + what,
               {vertex, axis});
}

Error survey_error(cl_uint type, std::uint64_t coordinate) {
  if (type == GCDT_COORDINATES_INT64)
    return coordinate_error(Status::coordinate_outside_grid, " is beyond 2^53", coordinate);
  return coordinate_error(Status::coordinate_not_finite, " is not a finite number", coordinate);
}

void check_outside(cl_ulong outside) {
  if (outside != 0) throw coordinate_error(Status::coordinate_outside_grid, " is outside the grid", ~outside);
}

std::array<cl_ulong, GCDT_SURVEY_COLUMNS> survey_maxima(runtime::Runtime& runtime, const InputPoints& points) {
  Maxima maxima(runtime, points.n, GCDT_SURVEY_COLUMNS);
  runtime.launch("order", "survey", maxima.groups, points.n, points.type, points.coordinates, maxima.rows, maxima.table,
                 maxima.memory);
  const std::vector<cl_ulong> most = maxima.read(runtime);
  std::array<cl_ulong, GCDT_SURVEY_COLUMNS> columns{};
  std::copy(most.begin(), most.end(), columns.begin());
  return columns;
}

int count_decimals(runtime::Runtime& runtime, const InputPoints& points, cl_int limit) {
  Maxima maxima(runtime, points.n, 1);
  runtime.launch("decimals", "count_decimals", maxima.groups, points.n, points.type, points.coordinates, limit,
                 maxima.rows, maxima.table, maxima.memory);
  return static_cast<int>(maxima.read(runtime)[0]);
}

Codes codes_on(runtime::Runtime& runtime, const InputPoints& points, const ChosenGrid& chosen) {
  Codes made;
  made.codes = runtime.allocate<cl_ulong>("Morton codes", points.n);
  made.numbers = runtime.allocate<cl_uint>("input numbers", points.n);
  if (chosen.decimals) {
    const auto decimals = runtime.upload_one("decimals", *chosen.decimals);
    runtime.launch("decimals", "quantise_decimals", runtime::over(points.n), points.n, points.type, points.coordinates,
                   decimals, made.codes, made.numbers);
    return made;
  }
  const auto scale = runtime.upload_one("scale", chosen.scale);
  Maxima maxima(runtime, points.n, GCDT_QUANTISE_COLUMNS);
  runtime.launch("order", "quantise", maxima.groups, points.n, points.type, points.coordinates, scale, maxima.rows,
                 made.codes, made.numbers, maxima.table, maxima.memory);
  const std::vector<cl_ulong> most = maxima.read(runtime);
  std::copy(most.begin(), most.end(), made.maxima.begin());
  return made;
}

cl_uint coordinates_type(Points::Type type) {
  return type == Points::Type::float64   ? GCDT_COORDINATES_FLOAT64
         : type == Points::Type::int64   ? GCDT_COORDINATES_INT64
         : type == Points::Type::float32 ? GCDT_COORDINATES_FLOAT32
                                         : GCDT_COORDINATES_INT32;
}

std::size_t words_per_vertex(Points::Type type) {
  return type == Points::Type::float64 || type == Points::Type::int64 ? 2 : 1;
}

void check_vertex_count(std::uint64_t n) {
  if (n > max_vertices)
    throw Error(Status::too_many_vertices,
                std::to_string(n) + " vertices; at most " + std::to_string(max_vertices) + " can be numbered");
}

void check_constraint_count(std::uint64_t m) {
  if (m > GCDT_MAX_CONSTRAINTS)
    throw Error(Status::invalid_argument, "more than 2^31 - 1 constraints: " + std::to_string(m));
}

InputPoints stage(runtime::Runtime& runtime, Points points) {
  check_vertex_count(points.size());
  InputPoints staged;
  staged.n = static_cast<cl_uint>(points.size());
  staged.type = coordinates_type(points.type());
  const std::size_t words = points.size() * words_per_vertex(points.type());
  staged.coordinates = runtime.upload("coordinates", static_cast<const cl_ulong*>(points.data()), words);
  return staged;
}

OrderResult order(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan, InputPoints points,
                  const std::optional<FixedGrid>& fixed) {
  const std::uint32_t coarsest_level = plan.coarsest_level;
  const cl_uint n = points.n;
  if (n == 0) return no_vertices(runtime, fixed, coarsest_level);
  if (plan.order == Plan::By::one) {
    Step sorting(runtime, "sort");
    OrderResult result = order_by_one_item(runtime, plan, points, fixed);
    result.sort_ms = sorting.end();
    return result;
  }
  Keys keys = quantise(runtime, points, choose_grid(runtime, points, fixed));
  if (!may_round_together(keys.grid)) points = {};
  runtime.end_step();
  Step sorting(runtime, "sort");
  primitives.sort_by_prefix(keys.codes, keys.numbers, n, GCDT_MORTON_BITS, bit_width(n) + Tuning::spare_bits);
  primitives.release();

  auto before = runtime.allocate<cl_uint>("distinct before", n + 1);
  runtime.launch("order", "mark_first", runtime::over(n), n, keys.codes, before);
  primitives.exclusive_scan(before, before, n);
  const SortedCodes sorted = {n, keys.codes, before};
  const ChosenLevels chosen = choose_levels(runtime, sorted, coarsest_level);
  const cl_uint distinct = chosen.levels.n;

  OrderResult result;
  result.merged = n - distinct;
  Vertices& vertices = result.vertices;
  vertices.grid = keys.grid;
  vertices.decimals = keys.decimals;
  vertices.input_vertex = runtime.allocate<cl_uint>("input vertices", n);
  vertices.levels = chosen.levels;
  vertices.levels_buffer = make_levels(runtime, primitives, sorted, chosen);
  vertices.points = runtime.allocate<cl_int2>("points", distinct);
  vertices.vertex_input = runtime.allocate<cl_uint>("vertex inputs", distinct);
  runtime.launch("order", "number_vertices", runtime::over(n), n, vertices.levels_buffer, keys.codes, keys.numbers,
                 before, vertices.points, vertices.vertex_input, vertices.input_vertex);
  result.sort_ms = sorting.end();
  set_together(runtime, points, result);
  return result;
}

}  // namespace gcdt
