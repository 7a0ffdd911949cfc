// SPDX-License-Identifier: Apache-2.0
#include "tiles/placed.hpp"

#include <cstring>

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

/// The columns of kernel `survey`.
Maxima survey(const Points& points) {
  return maxima_of(points.size(), GCDT_SURVEY_COLUMNS, [&](std::size_t first, std::size_t end, Maxima& most) {
    const auto raise = [&](std::size_t column, std::uint64_t value) { most[column] = std::max(most[column], value); };
    for (std::size_t v = first; v < end; ++v)
      for (int axis = 0; axis < 2; ++axis) {
        const std::uint64_t bits = bits_of(points, v, axis);
        if (!device::gcdt_is_finite(bits)) {
          raise(GCDT_SURVEY_BAD, ~(2 * std::uint64_t{v} + static_cast<unsigned>(axis)));
          continue;
        }
        const std::uint64_t key = device::gcdt_ordered(bits);
        raise(2 * static_cast<std::size_t>(axis), ~key);
        raise(2 * static_cast<std::size_t>(axis) + 1, key);
        if (bits != 0)
          raise(GCDT_SURVEY_TRAILING,
                ~static_cast<std::uint64_t>(device::gcdt_trailing_exponent(bits) - GCDT_LEAST_EXPONENT));
      }
  });
}

ChosenGrid choose(const Points& points, const std::optional<FixedGrid>& fixed) {
  std::optional<ChosenGrid> given;
  if (fixed) given = fixed_grid(*fixed);
  const Maxima found = survey(points);
  if (found[GCDT_SURVEY_BAD] != 0) throw survey_error(coordinates_type(points.type()), ~found[GCDT_SURVEY_BAD]);
  if (given) return *given;
  const GridChoice choice = choose_grid(survey_of(found.data()));
  const int limit = choice.decimals_limit;
  if (limit < 0) return choice.grid;
  const Maxima digits = maxima_of(points.size(), 1, [&](std::size_t first, std::size_t end, Maxima& most) {
    int needed = 0;
    for (std::size_t v = first; v < end && needed <= limit; ++v)
      for (int axis = 0; axis < 2; ++axis)
        needed = device::gcdt_decimals_needed(bits_of(points, v, axis), needed, limit);
    most[0] = static_cast<std::uint64_t>(needed);
  });
  return choice.with_decimals(static_cast<int>(digits[0]));
}

void place_decimals(const Points& points, const device::Decimals& decimals, std::vector<GridPoint>& placed) {
  for_each_in_threads(points.size(), [&](std::size_t v) {
    for (int axis = 0; axis < 2; ++axis) {
      const auto numerator =
          static_cast<std::uint64_t>(device::gcdt_decimal_numerator(bits_of(points, v, axis), decimals.digits));
      placed[v][axis] =
          static_cast<std::int32_t>((numerator - static_cast<std::uint64_t>(decimals.least[axis])) * decimals.step);
    }
  });
}

/// The columns of kernel `quantise`.
Maxima place_scaled(const Points& points, const device::Scale& scale, std::vector<GridPoint>& placed) {
  return maxima_of(points.size(), GCDT_QUANTISE_COLUMNS, [&](std::size_t first, std::size_t end, Maxima& most) {
    for (std::size_t v = first; v < end; ++v)
      for (int axis = 0; axis < 2; ++axis) {
        const device::Quantised at = device::gcdt_quantise(bits_of(points, v, axis), &scale, axis);
        most[GCDT_QUANTISE_MOVE] = std::max(most[GCDT_QUANTISE_MOVE], at.move);
        if (at.outside)
          most[GCDT_QUANTISE_OUTSIDE] =
              std::max(most[GCDT_QUANTISE_OUTSIDE], ~(2 * std::uint64_t{v} + static_cast<unsigned>(axis)));
        placed[v][axis] = static_cast<std::int32_t>(at.value);
      }
  });
}

}  // namespace

Placed place(Points points, const std::optional<FixedGrid>& fixed) {
  check_vertex_count(points.size());
  Placed placed;
  if (points.size() == 0) {
    if (fixed) placed.chosen = fixed_grid(*fixed);
    return placed;
  }
  placed.chosen = choose(points, fixed);
  const ChosenGrid& chosen = placed.chosen;
  placed.points.resize(points.size());
  if (chosen.decimals) {
    place_decimals(points, *chosen.decimals, placed.points);
    return placed;
  }
  const Maxima found = place_scaled(points, chosen.scale, placed.points);
  if (found[GCDT_QUANTISE_OUTSIDE] != 0)
    throw coordinate_error(Status::coordinate_outside_grid, " is outside the grid", ~found[GCDT_QUANTISE_OUTSIDE]);
  placed.chosen.grid.largest_move = largest_move(
      points.size(), [&](std::size_t i) { return bits_of(points, i / 2, static_cast<int>(i % 2)); },
      found[GCDT_QUANTISE_MOVE], chosen.scale);
  return placed;
}

}  // namespace gcdt::tiles
