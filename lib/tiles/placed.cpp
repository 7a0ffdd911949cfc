// SPDX-License-Identifier: Apache-2.0
#include "tiles/placed.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "device/parts.hpp"
#include "exact/doubles.hpp"
#include "phases/given.hpp"
#include "phases/order.hpp"

namespace gcdt::tiles {

namespace {

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

/// A coordinate on the grid.
std::int32_t placed(const ChosenGrid& chosen, std::uint64_t bits, int axis) {
  if (!chosen.decimals) return static_cast<std::int32_t>(device::gcdt_quantise(bits, &chosen.scale, axis).value);
  return static_cast<std::int32_t>(
      device::gcdt_place_decimal(bits, static_cast<std::uint32_t>(axis), &*chosen.decimals));
}

/// Keys of the least double and of the greatest one that are finite.
constexpr std::uint64_t least_key = ~(GCDT_SIGN_BIT | (GCDT_INFINITE_BITS - 1)),
                        most_key = GCDT_SIGN_BIT | (GCDT_INFINITE_BITS - 1);

/// The least key of a double that is placed at `at` or beyond; most_key + 1 if there is none. Ends: the range halves.
std::uint64_t first_key_at(const device::Scale& scale, std::int64_t at, std::size_t axis) {
  std::uint64_t low = least_key, high = most_key + 1;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    const std::uint64_t bits = device::gcdt_without_negative_zero(device::gcdt_from_ordered(middle));
    const device::Quantised found = device::gcdt_quantise(bits, &scale, static_cast<int>(axis));
    const bool is_before = found.outside ? middle < device::gcdt_ordered(scale.origin[axis]) : found.value < at;
    if (is_before)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/// Keys of the doubles that the first and the last decimal placed from `first` to `last` read as: reading is monotone.
std::array<std::uint64_t, 2> decimal_keys(const device::Decimals& decimals, std::int64_t first, std::int64_t last,
                                          std::size_t axis) {
  const auto step = static_cast<std::int64_t>(decimals.step);
  const auto key_of = [&](std::int64_t steps) {
    const std::int64_t numerator = decimals.least[axis] + steps;
    const auto magnitude = static_cast<std::uint64_t>(std::abs(numerator));
    const double read = exact::nearest_double(exact::Natural(magnitude), -decimals.digits,
                                              device::gcdt_powers_of_five[decimals.digits]);
    std::uint64_t bits;
    std::memcpy(&bits, &read, sizeof bits);
    return device::gcdt_ordered(numerator < 0 ? bits | GCDT_SIGN_BIT : bits);
  };
  return {key_of((first + step - 1) / step), key_of(last / step)};
}

}  // namespace

void GivenVertices::throw_absent() {
  throw Error(Status::check_failed, "tiles: a vertex is asked for where it is not");
}

std::size_t GivenVertices::place_of(std::uint64_t vertex) const {
  if (numbers.empty()) {
    if (vertex - first >= points.size()) throw_absent();
    return static_cast<std::size_t>(vertex - first);
  }
  const auto found = std::lower_bound(numbers.begin(), numbers.end(), vertex);
  if (found == numbers.end() || *found != vertex) throw_absent();
  return static_cast<std::size_t>(found - numbers.begin());
}

GridPoint GridInput::at_place(std::size_t place) const {
  return {placed(chosen, bits_of(given.points, place, 0), 0), placed(chosen, bits_of(given.points, place, 1), 1)};
}

std::optional<GridPoint> place_query(const ChosenGrid& chosen, const std::array<double, 2>& point) {
  const device::Scale scale = scale_of(chosen.grid);
  const device::Decimals decimals = query_decimals(chosen.grid, chosen.decimals);
  const Points one = Points::pairs(point.data(), 1);
  GridPoint at{};
  for (std::uint32_t axis = 0; axis < 2; ++axis) {
    const device::Quantised placed = device::gcdt_place_query(bits_of(one, 0, static_cast<int>(axis)),
                                                              chosen.decimals.has_value(), &scale, &decimals, axis);
    if (placed.outside) return std::nullopt;
    at[axis] = static_cast<std::int32_t>(placed.value);
  }
  return at;
}

bool some_need_more(const Points& points, int decimals) {
  constexpr std::size_t few = 16;
  for (std::size_t i = 0; i < std::min(few, points.size()); ++i)
    for (int axis = 0; axis < 2; ++axis)
      if (device::gcdt_decimals_needed(bits_of(points, points.size() / few * i, axis), 0, decimals) > decimals)
        return true;
  return false;
}

KeyBox keys_of(const ChosenGrid& chosen, const Box& box) {
  KeyBox keys{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::array<std::uint64_t, 2> range =
        chosen.decimals ? decimal_keys(*chosen.decimals, box.least[axis], box.most[axis], axis)
                        : std::array<std::uint64_t, 2>{first_key_at(chosen.scale, box.least[axis], axis),
                                                       first_key_at(chosen.scale, box.most[axis] + 1, axis) - 1};
    keys.least[axis] = range[0], keys.most[axis] = range[1];
  }
  return keys;
}

bool some_outside(const ChosenGrid& chosen, const Survey& surveyed) {
  if (chosen.decimals) return false;
  for (std::size_t axis = 0; axis < 2; ++axis)  // what is placed grows with what was given
    for (const std::uint64_t bits : {surveyed.least[axis], surveyed.most[axis]})
      if (device::gcdt_quantise(bits, &chosen.scale, static_cast<int>(axis)).outside) return true;
  return false;
}

Box box_of(const ChosenGrid& chosen, const Survey& surveyed) {
  Box box{};
  for (std::size_t axis = 0; axis < 2; ++axis) {  // what is placed grows with what was given
    box.least[axis] = placed(chosen, surveyed.least[axis], static_cast<int>(axis));
    box.most[axis] = placed(chosen, surveyed.most[axis], static_cast<int>(axis));
  }
  return box;
}

std::uint64_t outside_of(const GridInput& input) {
  if (input.chosen.decimals) return 0;
  const Parts parts(input.given.points.size());
  std::vector<std::uint64_t> outside(parts.size(), 0);  // the complement of each part's least such coordinate
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    for (std::size_t i = 2 * first; i < 2 * end && outside[part] == 0; ++i) {
      const int axis = static_cast<int>(i % 2);
      if (device::gcdt_quantise(bits_of(input.given.points, i / 2, axis), &input.chosen.scale, axis).outside)
        outside[part] = ~(2 * input.given.first + i);
    }
  });
  return *std::max_element(outside.begin(), outside.end());
}

double move_of(const GridInput& input, std::uint64_t key) {
  if (input.chosen.decimals || key == 0) return 0;
  return largest_move(
      input.given.points.size(),
      [&](std::size_t i) { return bits_of(input.given.points, i / 2, static_cast<int>(i % 2)); }, key,
      input.chosen.scale);
}

}  // namespace gcdt::tiles
