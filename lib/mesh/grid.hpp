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

/// The grid of an input that was surveyed, before its decimals are counted.
struct GridChoice {
  Survey survey;
  ChosenGrid grid;     ///< with a cell of 2^k: binary if nothing can move, else rounded
  int decimals_limit;  ///< decimals that a decimal grid, which goes before a rounded one, has at most; -1: none does

  /// The grid if the input needs so many decimals to be written: decimal if that fits, else `grid`.
  ChosenGrid with_decimals(int digits) const;
};
GridChoice choose_grid(const Survey& survey);

/// The grid that the caller gave. Throws invalid_argument.
ChosenGrid fixed_grid(const FixedGrid& given);

/// How coordinates get on a grid that was chosen before; a decimal grid is taken for a given one.
device::Scale scale_of(const Grid& grid);

/// How points that are no vertices get on a grid that was chosen for decimals (gcdt_place_query): decimals in units of
/// the cell, so that such a point may have more digits than any vertex; where that leaves 63 bits, those of the
/// vertices.
device::Decimals query_decimals(const Grid& grid, const std::optional<device::Decimals>& of_vertices);

/// The length that `key` (gcdt_move_key) stands for: 0 iff the key is 0. Where the key has all digits of the move, or
/// 56 and what is behind them: the nearest double, or on a grid with a decimal cell that or up to 2^-51 of it more,
/// never less.
double move_length(std::uint64_t key, const device::Scale& scale);

}  // namespace gcdt
