// SPDX-License-Identifier: Apache-2.0
// Chooses the grid from what a survey of the input found, with integer arithmetic only.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <gcdt/types.hpp>

#include "order/grid.h"

namespace gcdt {

/// The whole input at a glance. Doubles are held as their bits, -0 as 0.
struct Survey {
  std::array<std::uint64_t, 2> least{}, most{};  ///< by axis
  std::optional<int> trailing_exponent;          ///< all coordinates are multiples of 2^e; none: all are 0
};

/// From the maxima of kernel `survey` (kernels/order/order.cl), of finite coordinates.
Survey survey_of(const std::uint64_t* maxima);

/// A grid, and how coordinates get there: by `decimals` if present, else by `scale`.
struct ChosenGrid {
  Grid grid;
  device::Scale scale = {};
  std::optional<device::Decimals> decimals;
};

/// The double nearest to the edge of a cell; see Grid.
double cell_edge(std::uint64_t units, int decimals, int exponent);

/// The least k >= -1074 with round_half_even(extent / 2^k) <= 2^31 - 1 on both axes; 0 if both extents are 0.
/// Not finer than 2^-1074, so that every cell is a double.
int finest_exponent(const Survey& survey);

/// The grid with origin at the least coordinates and cell 2^k: `binary` if nothing can move, else `rounded`.
ChosenGrid power_of_two_grid(const Survey& survey, int k);

/// No decimal grid has more decimals than this (which may be -1), given k = finest_exponent(survey) and
/// that the binary grid does not do.
int decimals_limit(const Survey& survey, int k);

/// The decimal grid of an input that needs `digits` decimals to be written; none if it does not fit.
std::optional<ChosenGrid> decimal_grid(const Survey& survey, int digits);

/// The grid that the caller gave. Throws invalid_argument.
ChosenGrid fixed_grid(const FixedGrid& given);

/// How coordinates get on a grid that was chosen before; a decimal grid is taken for a given one.
device::Scale scale_of(const Grid& grid);

/// The length that `key` (gcdt_move_key) stands for: 0 iff the key is 0. Where the key has all digits of the move, or
/// 56 and what is behind them: the nearest double, or on a grid with a decimal cell that or up to 2^-51 of it more,
/// never less.
double move_length(std::uint64_t key, const device::Scale& scale);

}  // namespace gcdt
