// SPDX-License-Identifier: Apache-2.0
// The order phase: from the caller's points to distinct vertices on the grid, in device memory.
#pragma once

#include <optional>

#include "mesh.hpp"
#include "primitives.hpp"

namespace gcdt {

struct OrderResult {
  Vertices vertices;
  std::uint64_t merged = 0;  ///< input points that are not representatives
  double sort_ms = 0;        ///< wall time of sorting and numbering, which `core` of the statistics includes
};

/// Quantises, sorts along the Z-order curve, merges duplicates, and numbers level by level
/// (make_levels(n, coarsest_level)). Throws invalid_argument (a bad fixed grid), coordinate_not_finite and
/// coordinate_outside_grid (indices {vertex, axis}, the least such vertex), too_many_vertices.
OrderResult order(runtime::Runtime& runtime, Primitives& primitives, Points points,
                  const std::optional<FixedGrid>& fixed, std::uint32_t coarsest_level);

}  // namespace gcdt
