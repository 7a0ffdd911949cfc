// SPDX-License-Identifier: Apache-2.0
// The order phase: from the caller's points to distinct vertices on the grid, in device memory.
#pragma once

#include <optional>

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

/// What is wrong with coordinate 2 * vertex + axis.
Error coordinate_error(Status status, const char* what, std::uint64_t coordinate);
/// What is wrong with one that a survey calls not finite: for int64, that it is beyond 2^53.
Error survey_error(cl_uint type, std::uint64_t coordinate);

/// GCDT_COORDINATES_... of a type, and the words of 8 bytes that a vertex takes.
cl_uint coordinates_type(Points::Type type);
std::size_t words_per_vertex(Points::Type type);

/// Throws too_many_vertices for more than max_vertices.
void check_vertex_count(std::uint64_t n);

/// Copies points from host memory. Throws too_many_vertices.
InputPoints stage(runtime::Runtime& runtime, Points points);

struct OrderResult {
  Vertices vertices;
  std::uint64_t merged = 0;  ///< input points that are not representatives
  RoundedTogether together;  ///< of these, those that were given elsewhere; of a forest not set
  /// Wall time of sorting and numbering, which `core` of the statistics includes; with Plan::By::one, of surveying and
  /// quantising, too.
  double sort_ms = 0;
};

/// Quantises, sorts along the Z-order curve, merges duplicates, and numbers level by level
/// (make_levels(n, plan.coarsest_level)). Throws invalid_argument (a bad fixed grid), coordinate_not_finite and
/// coordinate_outside_grid (indices {vertex, axis}, the least such vertex). `points`, at most max_vertices, are
/// released as soon as their keys are made, unless rounding may have made some one: then these are counted.
OrderResult order(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan, InputPoints points,
                  const std::optional<FixedGrid>& fixed);

}  // namespace gcdt
