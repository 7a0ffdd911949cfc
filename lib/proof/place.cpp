// SPDX-License-Identifier: Apache-2.0
// Puts doubles on the grid, exactly: every rounding is decided on integers.
#include <cmath>
#include <sstream>

#include "proof/grid.hpp"

namespace gcdt::proof {

using exact::Integer;
using exact::Natural;

namespace {

/// (q + fraction) * 2^exponent as the nearest double, ties to even; the fraction, in (0, 1), is there iff
/// `sticky`, and then q has 55 bits at least.
double nearest_double(std::uint64_t q, bool sticky, int exponent) {
  const int drop = bit_length(q) - 53;
  if (drop <= 0) return std::ldexp(static_cast<double>(q), exponent);
  const std::uint64_t low = q & ((1ull << drop) - 1), half = 1ull << (drop - 1);
  q >>= drop;
  if (low > half || (low == half && (sticky || (q & 1)))) ++q;
  return std::ldexp(static_cast<double>(q), exponent + drop);
}

/// The double nearest to n * 2^two.
template <class Number>
double nearest_double(const Number& n, int two) {
  const int shift = std::max(0, bit_length(n) - 64);
  return nearest_double(bits_from(n, shift), any_below(n, shift), two + shift);
}

/// The double nearest to n * 2^two / 5^five, five > 0.
double nearest_double(Natural n, int two, int five) {
  Natural divisor(power_of_five(five));
  const int shift = 58 + bit_length(divisor) - bit_length(n);
  if (shift > 0) n = n << shift;
  if (shift < 0) divisor = divisor << -shift;
  const std::uint64_t q = divide(n, divisor);  // of 58 or 59 bits
  return nearest_double(q, n != Natural(), two - shift);
}

/// The double nearest to n * 2^two / 5^five, unless that is surely below `least`.
template <class Number>
double move_length(const Number& n, int two, int five, double least) {
  const double rough = nearest_double(n, two);
  if (five == 0 || rough == 0) return rough;
  const double quotient = rough / static_cast<double>(power_of_five(five));
  if (quotient > 1e-290 && quotient * (1 + 1e-9) < least) return quotient;
  return nearest_double(Natural(n), two, five);
}

/// |v - origin| = distance * 2^base, not 0; numbers have at most 126 bits, or any number.
template <class Number>
Placed place_distance(bool negative, const Number& distance, int base, const Cell& cell, double least_move) {
  const int fives_down = std::max(0, cell.five), fives_up = std::max(0, -cell.five);
  Number rest = (distance * power_of_five(fives_up)) << std::max(0, base - cell.two);
  const Number unit = (Number(cell.units) * power_of_five(fives_down)) << std::max(0, cell.two - base);
  std::uint64_t at = divide(rest, unit);
  const Number above = unit - rest;
  if (rest > above || (rest == above && (at & 1))) {
    ++at;
    rest = above;
  }
  Placed placed;
  placed.outside = at > grid_max || (negative && at > 0);
  placed.moved = rest != Number(0);
  if (placed.outside) return placed;
  placed.at = static_cast<std::int32_t>(at);
  if (placed.moved) placed.move = move_length(rest, std::min(cell.two, base), fives_up, least_move);
  return placed;
}

int cell_magnitude(const Cell& cell) {
  return bit_length(cell.units) + cell.two + cell.five * 2321928 / 1000000 + 1;  // log2(5) = 2.3219281
}

/// Chooses the number type.
template <class Number>
Placed place_with_exit(bool negative, const Number& distance, int base, const Cell& cell, double least_move) {
  const int bits = bit_length(distance);
  if (bits == 0) return {};
  if (bits - 1 + base >= cell_magnitude(cell) + 32) {
    Placed placed;
    placed.outside = placed.moved = true;
    return placed;
  }
  const int above = bits + 3 * std::max(0, -cell.five) + std::max(0, base - cell.two);
  const int below = bit_length(cell.units) + 3 * std::max(0, cell.five) + std::max(0, cell.two - base);
  if constexpr (std::is_same_v<Number, UWide>)
    if (above <= 126 && below <= 126) return place_distance<UWide>(negative, distance, base, cell, least_move);
  return place_distance<Natural>(negative, Natural(distance), base, cell, least_move);
}

std::string describe(std::size_t vertex, std::size_t axis, const char* what) {
  return std::string(axis ? "y" : "x") + " of vertex " + std::to_string(vertex) + " " + what;
}

/// False if a double is no decimal of so many digits, or if the difference is not a grid coordinate.
bool place_decimal(double v, double origin, int decimals, std::int32_t& at) {
  const auto value = in_units(v, decimals), zero = in_units(origin, decimals);
  if (!value || !zero || *value < *zero || *value - *zero > static_cast<Wide>(grid_max)) return false;
  at = static_cast<std::int32_t>(*value - *zero);
  return true;
}

std::string place_vertex(Points points, std::size_t vertex, std::size_t axis, const Grid& grid, std::int32_t& at) {
  const double v = points.coordinate(vertex, axis);
  if (!is_finite(v)) return describe(vertex, axis, "is not finite");
  if (grid.kind == Grid::Kind::decimal) {
    if (place_decimal(v, grid.origin[axis], grid.cell_decimals, at)) return {};
    return describe(vertex, axis, "is not on the decimal grid");
  }
  const Placed placed = place(v, grid.origin[axis], cell_of(grid), HUGE_VAL);
  if (placed.outside) return describe(vertex, axis, "is outside the grid");
  if (placed.moved && grid.kind == Grid::Kind::binary) return describe(vertex, axis, "is not on the binary grid");
  at = placed.at;
  return {};
}

}  // namespace

Placed place(double v, double origin, const Cell& cell, double least_move) {
  Dyadic a = dyadic(v), b = dyadic(origin);
  if (a.mantissa == 0) a.exponent = b.exponent;
  if (b.mantissa == 0) b.exponent = a.exponent;
  const int base = std::min(a.exponent, b.exponent), gap = std::max(a.exponent, b.exponent) - base;
  if (gap <= 64) {
    const auto left = static_cast<Wide>(UWide(a.mantissa) << (a.exponent - base));
    const auto right = static_cast<Wide>(UWide(b.mantissa) << (b.exponent - base));
    const Wide difference = (a.negative ? -left : left) - (b.negative ? -right : right);
    const bool negative = difference < 0;
    return place_with_exit(negative, static_cast<UWide>(negative ? -difference : difference), base, cell, least_move);
  }
  const Integer difference = a.in_units(base) - b.in_units(base);
  return place_with_exit(difference.sign() < 0, difference.size(), base, cell, least_move);
}

std::string grid_defect(const Grid& grid) {
  if (!is_finite(grid.origin[0]) || !is_finite(grid.origin[1])) return "the grid's origin is not finite";
  if (grid.cell_units > 0 && (grid.cell_decimals < -max_decimals || grid.cell_decimals > max_decimals))
    return "the grid's cell has too many decimals";
  if (grid.cell_units == 0 && (grid.cell_exponent < -1200 || grid.cell_exponent > 1100))
    return "the grid's cell is too small or too large";
  if (grid.kind == Grid::Kind::decimal && (grid.cell_units != 1 || grid.cell_decimals < 0))
    return "the cell of a decimal grid is not a power of ten";
  if ((grid.kind == Grid::Kind::binary || grid.kind == Grid::Kind::rounded) && grid.cell_units != 0)
    return "the cell of a binary or rounded grid is not a power of two";
  return {};
}

double coordinate_at(const Grid& grid, std::size_t axis, std::int32_t at) {
  if (grid.kind == Grid::Kind::decimal) {
    const Wide units = in_units(grid.origin[axis], grid.cell_decimals).value_or(0) + at;
    const bool negative = units < 0;
    const Natural n(static_cast<UWide>(negative ? -units : units));
    const int d = grid.cell_decimals;
    const double v = d == 0 || units == 0 ? nearest_double(n, -d) : nearest_double(n, -d, d);
    return negative ? -v : v;
  }
  // origin + at * units * 2^two * 5^five, over 5^down and in units of 2^base
  const Cell cell = cell_of(grid);
  const Dyadic origin = dyadic(grid.origin[axis]);
  const int up = std::max(0, cell.five), down = std::max(0, -cell.five);
  if (at == 0) return grid.origin[axis];
  const int base = origin.mantissa == 0 ? cell.two : std::min(origin.exponent, cell.two);
  const Integer way(false, Natural(static_cast<std::uint32_t>(at)) * cell.units * power_of_five(up));
  const Integer sum = origin.in_units(base) * Integer(false, power_of_five(down)) + (way << (cell.two - base));
  if (sum.sign() == 0) return 0;
  const double v = down == 0 ? nearest_double(sum.size(), base) : nearest_double(sum.size(), base, down);
  return sum.sign() < 0 ? -v : v;
}

// A double has 53 bits. IEEE 754 has quotients and sums rounded to the nearest double, ties to even, as
// nearest_double() does: of two exact doubles, which integers below 2^53, powers of ten up to 10^22 and products by a
// power of two are.
Coordinates::Coordinates(const Grid& grid) : grid_(grid) {
  constexpr int bits = 53, most_decimals = 22, most_exponent = 900;
  if (grid.kind == Grid::Kind::decimal) {
    if (grid.cell_decimals > most_decimals) return;
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (const auto units = in_units(grid.origin[axis], grid.cell_decimals))
        if (const Wide most = Wide{1} << (bits - 1); *units > -most && *units < most)
          first_[axis] = static_cast<std::int64_t>(*units);
    ten_ = 1;
    for (int i = 0; i < grid.cell_decimals; ++i) ten_ *= 10;
    return;
  }
  const Cell cell = cell_of(grid);
  const bool is_small = std::fabs(grid.origin[0]) < 1e300 && std::fabs(grid.origin[1]) < 1e300;
  if (cell.five == 0 && bit_length(cell.units) + 31 <= bits && std::abs(cell.two) < most_exponent && is_small)
    cell_ = std::ldexp(static_cast<double>(cell.units), cell.two);
}

double Coordinates::at(std::size_t axis, std::int32_t at) const {
  if (grid_.kind != Grid::Kind::decimal)
    return cell_ > 0 ? grid_.origin[axis] + at * cell_ : coordinate_at(grid_, axis, at);
  const auto& first = first_[axis];
  if (!first) return coordinate_at(grid_, axis, at);
  return static_cast<double>(*first + at) / ten_;
}

std::optional<std::int32_t> nearest_at(const Grid& grid, std::size_t axis, double v) {
  std::int32_t at = 0;
  if (grid.kind == Grid::Kind::decimal && place_decimal(v, grid.origin[axis], grid.cell_decimals, at)) return at;
  const Placed placed = place(v, grid.origin[axis], cell_of(grid), HUGE_VAL);
  if (placed.outside) return std::nullopt;
  return placed.at;
}

std::vector<Vertex> quantise(Points points, const Grid& grid, std::string& reason) {
  reason = grid_defect(grid);
  std::vector<Vertex> vertices(reason.empty() ? points.size() : 0);
  for (std::size_t i = 0; i < vertices.size() && reason.empty(); ++i) {
    reason = place_vertex(points, i, 0, grid, vertices[i].x);
    if (reason.empty()) reason = place_vertex(points, i, 1, grid, vertices[i].y);
  }
  if (!reason.empty()) vertices.clear();
  return vertices;
}

bool place_seed(const std::array<double, 2>& point, const Grid& grid, Vertex& at) {
  std::int32_t* to[2] = {&at.x, &at.y};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!is_finite(point[axis])) return false;
    const auto found = nearest_at(grid, axis, point[axis]);
    if (!found) return false;
    *to[axis] = *found;
  }
  return true;
}

}  // namespace gcdt::proof
