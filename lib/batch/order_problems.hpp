// SPDX-License-Identifier: Apache-2.0
// The order phase of a forest: it puts each problem's points on a grid of its own (kernels/order/forest.cl).
#pragma once

#include "batch/problems.hpp"

namespace gcdt {

struct ForestOrder {
  OrderResult ordered;                    ///< its grid says nothing
  std::vector<Grid> grids;                ///< by problem
  std::vector<RoundedTogether> together;  ///< by problem; empty: none of any
};

/// As order(), problem by problem. Throws InvalidProblems with coordinate_not_finite and coordinate_outside_grid, whose
/// indices {vertex, axis} count in the problem, and Error with invalid_argument for a bad fixed grid.
ForestOrder order_problems(runtime::Runtime& runtime, Primitives& primitives, InputPoints points,
                           const ProblemRanges& ranges, const std::optional<FixedGrid>& fixed);

}  // namespace gcdt
