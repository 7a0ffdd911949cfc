// SPDX-License-Identifier: Apache-2.0
// Chooses the grid (docs/contract.md, 1), on the host and by code of its own.
#include "proof/grid.hpp"

#include <algorithm>
#include <limits>

namespace gcdt::proof {

namespace {

using exact::Natural;
using Limits = std::array<std::array<double, 2>, 2>;  // [axis][least, largest]

[[noreturn]] void fail(Status status, std::size_t vertex, std::size_t axis, const char* what) {
  throw Error(status, std::string(axis ? "y" : "x") + " of vertex " + std::to_string(vertex) + " " + what,
              {vertex, axis});
}

template <class Action>
void for_each_coordinate(Points points, Action action) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t axis = 0; axis < 2; ++axis) action(i, axis, points.coordinate(i, axis));
}

/// Adding zero turns -0 into 0.
Limits limits_of(Points points) {
  Limits limits;
  for (std::size_t axis = 0; axis < 2; ++axis) limits[axis].fill(points.coordinate(0, axis) + 0.0);
  for_each_coordinate(points, [&](std::size_t, std::size_t axis, double v) {
    limits[axis][0] = std::min(limits[axis][0], v + 0.0);
    limits[axis][1] = std::max(limits[axis][1], v + 0.0);
  });
  return limits;
}

constexpr int least_double = -1074;  // every double is a multiple of 2^least_double

/// largest - least, in units of 2^least_double.
Natural extent(const std::array<double, 2>& limits) {
  return (dyadic(limits[1]).in_units(least_double) - dyadic(limits[0]).in_units(least_double)).size();
}

/// The least k >= least_double with round_half_even(extent / 2^k) <= grid_max; the extent is positive. The limit,
/// at which nothing moves, keeps the cell a double.
int finest_power_of_two(const Natural& extent) {
  const int shift = bit_length(extent) - 31;  // leaves 31 bits: 2^30 to 2^31 before rounding
  const bool rounds_to_32_bits = shift > 0 && bits_from(extent, shift) == grid_max &&
                                 bits_from(extent, shift - 1) % 2 == 1;  // half or more above an odd number
  return std::max(0, shift + rounds_to_32_bits) + least_double;
}

/// The largest k such that every coordinate is a multiple of 2^k.
int common_power_of_two(Points points) {
  int power = std::numeric_limits<int>::max();
  for_each_coordinate(points, [&](std::size_t, std::size_t, double v) {
    const Dyadic d = dyadic(v);
    if (d.mantissa == 0) return;
    power = std::min(power, d.exponent + bit_length(d.mantissa & (~d.mantissa + 1)) - 1);
  });
  return power;
}

/// The decimals of the finest power of ten that fits, if every coordinate is a decimal and they fit.
std::optional<int> decimals_of(Points points, const Limits& limits) {
  int digits = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto number = shortest_decimal(points.coordinate(i, axis));
      if (!number) return std::nullopt;
      digits = std::max(digits, number->decimals);
    }
  const Wide most = std::numeric_limits<std::int64_t>::max();
  Wide larger = 0;                               // the larger extent in units of 10^-digits
  for (const auto& [least, largest] : limits) {  // what fits at both ends fits between them
    const auto begin = in_units(least, digits), end = in_units(largest, digits);
    if (!begin || !end || *begin < -most || *end > most) return std::nullopt;
    larger = std::max(larger, *end - *begin);
  }
  if (larger > static_cast<Wide>(grid_max)) return std::nullopt;
  for (; digits < max_decimals && 10 * larger <= static_cast<Wide>(grid_max); ++digits) larger *= 10;
  return digits;
}

void set_largest_move(Points points, Grid& grid) {
  const Cell cell = cell_of(grid);
  for_each_coordinate(points, [&](std::size_t i, std::size_t axis, double v) {
    const Placed placed = place(v, grid.origin[axis], cell, grid.largest_move);
    if (placed.outside) fail(Status::coordinate_outside_grid, i, axis, "is outside the grid");
    grid.largest_move = std::max(grid.largest_move, placed.move);
  });
}

Grid fixed_grid(Points points, const FixedGrid& fixed) {
  Grid grid;
  grid.kind = Grid::Kind::fixed;
  read_cell(fixed.cell, grid);
  if (!is_finite(fixed.x) || !is_finite(fixed.y))
    throw Error(Status::invalid_argument, "the grid's origin is not finite");
  grid.origin = {fixed.x + 0.0, fixed.y + 0.0};
  set_largest_move(points, grid);
  return grid;
}

Grid chosen_grid(Points points) {
  Grid grid;
  if (points.size() == 0) return grid;
  const Limits limits = limits_of(points);
  grid.origin = {limits[0][0], limits[1][0]};
  const Natural width = extent(limits[0]), height = extent(limits[1]), larger = width < height ? height : width;
  if (larger == Natural()) return grid;
  grid.cell_exponent = finest_power_of_two(larger);
  if (grid.cell_exponent <= common_power_of_two(points)) return grid;
  if (const auto decimals = decimals_of(points, limits)) {
    grid.kind = Grid::Kind::decimal;
    grid.cell_exponent = 0;
    grid.cell_units = 1;
    grid.cell_decimals = *decimals;
    return grid;
  }
  grid.kind = Grid::Kind::rounded;
  set_largest_move(points, grid);
  return grid;
}

}  // namespace

Grid choose_grid(Points points, const std::optional<FixedGrid>& fixed) {
  const bool whole = points.type() == Points::Type::int64;
  for_each_coordinate(points, [whole](std::size_t i, std::size_t axis, double v) {
    if (is_finite(v)) return;
    if (whole) fail(Status::coordinate_outside_grid, i, axis, "is beyond 2^53");
    fail(Status::coordinate_not_finite, i, axis, "is not finite");
  });
  return fixed ? fixed_grid(points, *fixed) : chosen_grid(points);
}

}  // namespace gcdt::proof
