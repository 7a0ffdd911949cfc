// SPDX-License-Identifier: Apache-2.0
#include "tiles/placed.hpp"

#include <cstring>
#include <tuple>

#include "phases/given.hpp"
#include "phases/order.hpp"
#include "tiles/parts.hpp"

namespace gcdt::tiles {

namespace {

using Maxima = std::vector<std::uint64_t>;

template <class T>
T read_number(const void* data, std::size_t index) {
  T value;
  std::memcpy(&value, static_cast<const unsigned char*>(data) + index * sizeof(T), sizeof(T));
  return value;
}

/// A coordinate as the bits of a double, -0 made 0: gcdt_coordinate of what need not lie on words of 8 bytes.
std::uint64_t bits_of(const Points& points, std::size_t vertex, int axis) {
  const std::size_t index = 2 * vertex + static_cast<std::size_t>(axis);
  switch (points.type()) {
    case Points::Type::float32:
      return device::gcdt_without_negative_zero(
          device::gcdt_double_of_float(read_number<std::uint32_t>(points.data(), index)));
    case Points::Type::int32: return device::gcdt_double_of_int(read_number<std::uint32_t>(points.data(), index));
    case Points::Type::int64: return device::gcdt_double_of_long(read_number<std::uint64_t>(points.data(), index));
    default: return device::gcdt_without_negative_zero(read_number<std::uint64_t>(points.data(), index));
  }
}

/// The maximum of each column over all parts; `fill(first, end, columns)` makes those of a part.
template <class Fill>
Maxima maxima_of(std::size_t count, std::size_t columns, Fill&& fill) {
  const Parts parts(count);
  std::vector<Maxima> tables(parts.size(), Maxima(columns, 0));
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) { fill(first, end, tables[part]); });
  Maxima most(columns, 0);
  for (const Maxima& table : tables)
    for (std::size_t k = 0; k < columns; ++k) most[k] = std::max(most[k], table[k]);
  return most;
}

/// The columns of kernel `survey`, of the vertices first to end - 1. `read(index)`: a coordinate as the bits of a double.
template <class Read>
void survey_part(std::size_t first, std::size_t end, Maxima& most, Read&& read) {
  std::uint64_t below[2] = {0, 0}, above[2] = {0, 0}, trailing = 0, bad = 0;
  for (std::size_t v = first; v < end; ++v)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::uint64_t bits = read(2 * v + axis);
      if (!device::gcdt_is_finite(bits)) {
        bad = std::max(bad, ~(2 * std::uint64_t{v} + axis));
        continue;
      }
      const std::uint64_t key = device::gcdt_ordered(bits);
      below[axis] = std::max(below[axis], ~key);
      above[axis] = std::max(above[axis], key);
      const auto exponent_key = [](std::int32_t e) {
        return ~static_cast<std::uint64_t>(e - GCDT_LEAST_EXPONENT);
      };
      // The last bit that is set is worth as much as the mantissa's last or more, so few have to be looked for.
      if (bits != 0 && exponent_key(device::gcdt_exponent(bits)) > trailing)
        trailing = std::max(trailing, exponent_key(device::gcdt_trailing_exponent(bits)));
    }
  for (std::size_t axis = 0; axis < 2; ++axis) most[2 * axis] = below[axis], most[2 * axis + 1] = above[axis];
  most[GCDT_SURVEY_TRAILING] = trailing, most[GCDT_SURVEY_BAD] = bad;
}

Maxima survey(const Points& points) {
  return maxima_of(points.size(), GCDT_SURVEY_COLUMNS, [&](std::size_t first, std::size_t end, Maxima& most) {
    if (points.type() == Points::Type::float64)
      return survey_part(first, end, most, [&](std::size_t index) {
        return device::gcdt_without_negative_zero(read_number<std::uint64_t>(points.data(), index));
      });
    survey_part(first, end, most,
                [&](std::size_t index) { return bits_of(points, index / 2, static_cast<int>(index % 2)); });
  });
}

/// The grid, and the survey by which it was chosen.
std::pair<ChosenGrid, Survey> choose(const Points& points, const std::optional<FixedGrid>& fixed) {
  std::optional<ChosenGrid> given;
  if (fixed) given = fixed_grid(*fixed);
  const Maxima found = survey(points);
  if (found[GCDT_SURVEY_BAD] != 0) throw survey_error(coordinates_type(points.type()), ~found[GCDT_SURVEY_BAD]);
  const Survey surveyed = survey_of(found.data());
  if (given) return {*given, surveyed};
  const GridChoice choice = choose_grid(surveyed);
  const int limit = choice.decimals_limit;
  if (limit < 0) return {choice.grid, surveyed};
  const Maxima digits = maxima_of(points.size(), 1, [&](std::size_t first, std::size_t end, Maxima& most) {
    int needed = 0;
    for (std::size_t v = first; v < end && needed <= limit; ++v)
      for (int axis = 0; axis < 2; ++axis)
        needed = device::gcdt_decimals_needed(bits_of(points, v, axis), needed, limit);
    most[0] = static_cast<std::uint64_t>(needed);
  });
  return {choice.with_decimals(static_cast<int>(digits[0])), surveyed};
}

/// A coordinate on the grid.
std::int32_t placed(const ChosenGrid& chosen, std::uint64_t bits, int axis) {
  if (!chosen.decimals) return static_cast<std::int32_t>(device::gcdt_quantise(bits, &chosen.scale, axis).value);
  const auto numerator = static_cast<std::uint64_t>(device::gcdt_decimal_numerator(bits, chosen.decimals->digits));
  return static_cast<std::int32_t>((numerator - static_cast<std::uint64_t>(chosen.decimals->least[axis])) *
                                   chosen.decimals->step);
}

}  // namespace

GridPoint GridInput::at(std::size_t vertex) const {
  if (vertex >= given.size()) return added[vertex - given.size()];
  return {placed(chosen, bits_of(given, vertex, 0), 0), placed(chosen, bits_of(given, vertex, 1), 1)};
}

GridInput place(Points points, Constraints constraints, const std::optional<FixedGrid>& fixed) {
  check_vertex_count(points.size());
  GridInput input{points, {}, {}, constraints, {}};
  if (points.size() == 0) {
    if (fixed) input.chosen = fixed_grid(*fixed);
    return input;
  }
  Survey surveyed;
  std::tie(input.chosen, surveyed) = choose(points, fixed);
  for (int axis = 0; axis < 2; ++axis) {  // a coordinate on the grid grows with the one that was given
    const auto k = static_cast<std::size_t>(axis);
    input.box.least[k] = placed(input.chosen, surveyed.least[k], axis);
    input.box.most[k] = placed(input.chosen, surveyed.most[k], axis);
  }
  return input;
}

void check_inside(const GridInput& input) {
  if (input.chosen.decimals) return;
  check_outside(maxima_of(input.given.size(), 1, [&](std::size_t first, std::size_t end, Maxima& most) {
    for (std::size_t v = first; v < end && most[0] == 0; ++v)
      for (int axis = 0; axis < 2 && most[0] == 0; ++axis)
        if (device::gcdt_quantise(bits_of(input.given, v, axis), &input.chosen.scale, axis).outside)
          most[0] = ~(2 * std::uint64_t{v} + static_cast<unsigned>(axis));
  })[0]);
}

double move_of(const GridInput& input, std::uint64_t key) {
  if (input.chosen.decimals || key == 0) return 0;
  return largest_move(
      input.given.size(), [&](std::size_t i) { return bits_of(input.given, i / 2, static_cast<int>(i % 2)); }, key,
      input.chosen.scale);
}

}  // namespace gcdt::tiles
