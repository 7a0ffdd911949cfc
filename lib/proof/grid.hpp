// SPDX-License-Identifier: Apache-2.0
// The numbers under the grid (docs/contract.md, 1): doubles as integers times powers of two, decimals, cells, rounding.
#pragma once

#include <array>
#include <cstdint>
#include <gcdt/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "exact/integer.hpp"
#include "proof/wide.hpp"

namespace gcdt::proof {

/// A vertex on the grid; both in [0, 2^31 - 1].
struct Vertex {
  std::int32_t x = 0, y = 0;
  std::uint64_t key() const { return std::uint64_t(x) << 32 | std::uint32_t(y); }  ///< in order of x, then y
};

using exact::dyadic;
using exact::Dyadic;

bool is_finite(double v);

/// units / 10^decimals
struct Decimal {
  std::int64_t units = 0;
  int decimals = 0;
};

constexpr int max_decimals = 22;                 ///< 10^22 is the largest power of ten that is a double
constexpr std::uint64_t grid_max = 0x7fffffffu;  ///< the largest grid coordinate

std::uint64_t power_of_five(int exponent);  ///< 0 <= exponent <= 22, so less than 2^52

/// The decimal with the fewest digits after the point (at most max_decimals, |units| < 2^63) whose
/// nearest double, ties to even, is v. Among those with that many digits the nearest to v, half to even.
std::optional<Decimal> shortest_decimal(double v);

/// v in units of 10^-decimals, v being read as its shortest decimal; nothing if that has more digits or is too large.
std::optional<Wide> in_units(double v, int decimals);

/// Length units * 2^two * 5^five of a cell's edge.
struct Cell {
  std::uint64_t units = 1;
  int two = 0, five = 0;
};

/// Reads FixedGrid::cell into cell_units, cell_decimals and cell_exponent. Throws invalid_argument.
void read_cell(const std::string& text, Grid& grid);

Cell cell_of(const Grid& grid);

/// Where one coordinate stands on the grid, and how far it moved.
struct Placed {
  bool outside = false;  ///< not in [0, grid_max]
  bool moved = false;
  std::int32_t at = 0;
  double move = 0;  ///< the double nearest to the exact distance, or less if that is below `least_move`
};

/// round_half_even((v - origin) / cell), exactly. Moves below `least_move` need not be computed.
Placed place(double v, double origin, const Cell& cell, double least_move);

/// A reason why `grid` describes no grid, or an empty text.
std::string grid_defect(const Grid& grid);

/// The double nearest to the coordinate of grid line `at` of a grid without defect.
double coordinate_at(const Grid& grid, std::size_t axis, std::int32_t at);

/// The same of many grid lines: by one operation in doubles where that is exact, that is for almost all grids.
class Coordinates {
 public:
  explicit Coordinates(const Grid& grid);
  double at(std::size_t axis, std::int32_t at) const;

 private:
  const Grid& grid_;
  std::array<std::optional<std::int64_t>, 2> first_{};  ///< of a decimal grid: its origin in cells, if it is small
  double ten_ = 0;                                      ///< of a decimal grid: cells in 1, if it is exact
  double cell_ = 0;                                     ///< of others, if multiples of it by grid lines are exact
};

/// The grid line to which a finite coordinate is rounded; none if that is outside. On a decimal grid the coordinate
/// is read as it is written, if it is written with its decimals.
std::optional<std::int32_t> nearest_at(const Grid& grid, std::size_t axis, double v);

/// All vertices on `grid`. Returns an empty vector and a reason if one does not fit or, on a binary
/// or decimal grid, is not on the grid.
std::vector<Vertex> quantise(Points points, const Grid& grid, std::string& reason);

/// Where a point that need not be a vertex stands on the grid, rounded; false: nowhere.
bool place_seed(const std::array<double, 2>& point, const Grid& grid, Vertex& at);

/// What the public functions of these names say.
Grid choose_grid(Points points, const std::optional<FixedGrid>& fixed);
Verification verify(Points points, Constraints constraints, const MeshView& mesh, const Grid& grid, Crossing crossing);

}  // namespace gcdt::proof
