// SPDX-License-Identifier: Apache-2.0
// The order phase of a forest: every problem's points on its own grid, in device memory (kernels/order/forest.cl).
#pragma once

#include <utility>
#include <vector>

#include "phases/order.hpp"

namespace gcdt {

/// Problems of one run that no forest can have, by number in the run: invalid ones, each with its own error, and those
/// that cross under Crossing::split, which are to be run alone (alone.hpp). They were found before any result was
/// made; the others may be right.
struct InvalidProblems {
  std::vector<std::pair<std::uint32_t, Error>> errors;
  std::vector<std::uint32_t> crossing;  ///< ascending
};

/// Where the problems of a run begin among all input vertices and constraints, on host and device: P + 1 elements.
struct ProblemRanges {
  std::vector<cl_uint> first_input, first_constraint;
  runtime::Buffer<cl_uint> first_input_buffer, first_constraint_buffer;
  std::uint32_t count() const { return static_cast<std::uint32_t>(first_input.size() - 1); }
};

struct ForestOrder {
  OrderResult ordered;                    ///< its grid says nothing
  std::vector<Grid> grids;                ///< by problem
  std::vector<RoundedTogether> together;  ///< by problem; empty: none of any
};

/// As order(), problem by problem. Throws InvalidProblems (coordinate_not_finite, coordinate_outside_grid: indices
/// {vertex, axis} in the problem), and invalid_argument for a bad fixed grid.
ForestOrder order_forest(runtime::Runtime& runtime, Primitives& primitives, InputPoints points,
                         const ProblemRanges& ranges, const std::optional<FixedGrid>& fixed);

}  // namespace gcdt
