// SPDX-License-Identifier: Apache-2.0
// The order phase: from the caller's points to distinct vertices on the grid, in device memory.
#pragma once

#include <optional>

#include "mesh/grid.hpp"
#include "mesh/mesh.hpp"
#include "mesh/plan.hpp"
#include "mesh/primitives.hpp"
#include "phases/given.hpp"

namespace gcdt {

/// The input vertices in device memory: pairs of numbers of one type (GCDT_COORDINATES_..., quantise.h).
struct InputPoints {
  cl_uint n = 0, type = 0;
  runtime::Buffer<cl_ulong> coordinates;
};

/// The error for coordinate number 2 * vertex + axis.
Error coordinate_error(Status status, const char* what, std::uint64_t coordinate);
/// The error for a coordinate that the survey calls not finite. An int64 is so called if it is beyond 2^53.
Error survey_error(cl_uint type, std::uint64_t coordinate);

/// The GCDT_COORDINATES_... constant of a type, and the number of 8-byte words of a vertex.
cl_uint coordinates_type(Points::Type type);
std::size_t words_per_vertex(Points::Type type);

/// Throws too_many_vertices for more than max_vertices.
void check_vertex_count(std::uint64_t n);
/// Throws invalid_argument.
void check_constraint_count(std::uint64_t m);

/// Copies points from host memory. Throws too_many_vertices.
InputPoints stage(runtime::Runtime& runtime, Points points);

/// The columns of kernel `survey` (order.h). Blocks.
std::array<cl_ulong, GCDT_SURVEY_COLUMNS> survey_maxima(runtime::Runtime& runtime, const InputPoints& points);
/// How many decimals the points need to be written; more than `limit` if more than `limit`. Blocks.
int count_decimals(runtime::Runtime& runtime, const InputPoints& points, cl_int limit);

/// Points on a grid that was chosen before.
struct Codes {
  runtime::Buffer<cl_ulong> codes;   ///< Morton codes
  runtime::Buffer<cl_uint> numbers;  ///< of the points: 0, 1, ...
  /// The columns of kernel `quantise` (order.h); on a decimal grid 0.
  std::array<cl_ulong, GCDT_QUANTISE_COLUMNS> maxima{};
};
/// Blocks, but on a decimal grid.
Codes codes_on(runtime::Runtime& runtime, const InputPoints& points, const ChosenGrid& chosen);
/// The error for the greatest of a column GCDT_QUANTISE_OUTSIDE, if there is one.
void check_outside(cl_ulong outside);

struct OrderResult {
  Vertices vertices;
  std::uint64_t merged = 0;  ///< input points that are not representatives
  RoundedTogether together;  ///< those of them that were given elsewhere; not set for a forest
  /// Wall time of sorting and numbering, which `core` of the statistics includes. Where one work-item does the whole
  /// phase (by_one_item.cl), it also has surveying and quantising.
  double sort_ms = 0;
};

/// Quantises, sorts along the Z-order curve, merges duplicates, and numbers level by level (phases/levels.hpp).
/// Throws invalid_argument (a bad fixed grid), coordinate_not_finite and coordinate_outside_grid (indices {vertex,
/// axis}, the least such vertex). `points`, at most max_vertices, are released as soon as their keys are made, unless
/// rounding may have made some one: then these are counted.
OrderResult order(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan, InputPoints points,
                  const std::optional<FixedGrid>& fixed);

}  // namespace gcdt
