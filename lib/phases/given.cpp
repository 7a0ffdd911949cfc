// SPDX-License-Identifier: Apache-2.0
#include "phases/given.hpp"

#include <cstring>

#include "exact/doubles.hpp"
#include "phases/order.hpp"

namespace gcdt {

using exact::Integer;
using exact::Natural;
using runtime::over;

namespace {

/// An integer times 2^unit.
struct Scaled {
  Integer number;
  int unit = 0;

  Integer in_units(int finer) const { return number << (unit - finer); }
};

Scaled operator-(const Scaled& a, const Scaled& b) {
  const int unit = std::min(a.unit, b.unit);
  return {a.in_units(unit) - b.in_units(unit), unit};
}

Scaled scaled(std::uint64_t bits) {
  return {Integer((bits & GCDT_SIGN_BIT) != 0, device::gcdt_mantissa(bits)), device::gcdt_exponent(bits)};
}

/// scale.five times how far a coordinate was moved: |(v - origin) five - X T 2^-offset|, see quantise.h.
Scaled move_of(std::uint64_t bits, std::uint32_t at, const device::Scale& scale, int axis) {
  Scaled way = scaled(bits) - scaled(scale.origin[axis]);
  way.number = way.number * Integer(false, scale.five);
  const Natural cell = (Natural(scale.cell_high) << 64) + Natural(scale.cell_low);
  const Scaled move = way - Scaled{Integer(false, Natural(at) * cell), -scale.offset};
  return {Integer(false, move.number.size()), move.unit};
}

/// Vertices first to end - 1, two coordinates each, as the bits of doubles.
std::vector<std::uint64_t> read_coordinates(runtime::Runtime& runtime, const InputPoints& points, cl_uint first,
                                            cl_uint end) {
  const std::size_t words = points.type == GCDT_COORDINATES_FLOAT64 || points.type == GCDT_COORDINATES_INT64 ? 2 : 1;
  std::vector<cl_ulong> given((end - first) * words);
  runtime.read(points.coordinates, given.data(), given.size(), first * words);
  std::vector<std::uint64_t> bits(2 * std::size_t{end - first});
  const std::vector<std::uint64_t> staged(given.begin(), given.end());
  for (std::uint32_t i = 0; i < bits.size(); ++i) bits[i] = device::gcdt_coordinate(staged.data(), points.type, i);
  return bits;
}

/// Whether the lowest bit of the key's number stands for what is below it, so that it is off by up to 3 units: there
/// are at most 55 bits, and it is odd. (Of more bits 56 and whether there are others are in the key; that is enough
/// where scale.five is 1, since an odd difference of two odd numbers has at most 54.)
bool is_cut(std::uint64_t key) {
  const auto length = static_cast<int>(key >> 56);
  return length > 0 && length <= 55 && (key >> (56 - length) & 1) != 0;
}

}  // namespace

std::vector<RoundedTogether> rounded_together(runtime::Runtime& runtime, const InputPoints& points,
                                              const Vertices& vertices, const std::vector<cl_uint>& first_input) {
  const auto problems = static_cast<cl_uint>(first_input.size() - 1);
  std::vector<cl_uint> found(std::size_t{GCDT_TOGETHER_WORDS} * problems, 0);
  for (cl_uint p = 0; p < problems; ++p) found[GCDT_TOGETHER_WORDS * p + 1] = GCDT_NONE;
  const auto firsts = runtime.upload("first inputs", first_input);
  const auto buffer = runtime.upload("vertices rounded together", found);
  runtime.launch("given", "count_together", over(points.n), points.n, problems, firsts, points.type, points.coordinates,
                 vertices.vertex_input, vertices.input_vertex, buffer);
  runtime.launch("given", "name_together", over(problems), problems, vertices.vertex_input, vertices.input_vertex,
                 buffer);
  runtime.read(buffer, found.data(), found.size());
  std::vector<RoundedTogether> together(problems);
  for (cl_uint p = 0; p < problems; ++p) {
    const cl_uint* own = &found[GCDT_TOGETHER_WORDS * p];
    if (own[0] != 0) together[p] = {own[0], {own[2] - first_input[p], own[1] - first_input[p]}};
  }
  return together;
}

Error together_error(const RoundedTogether& together) {
  const auto& [a, b] = together.first;
  return Error(Status::vertices_coincide,
               "vertices " + std::to_string(a) + " and " + std::to_string(b) +
                   " differ, but are one on the grid; so are " + std::to_string(together.count) +
                   " in all with a lesser one",
               {a, b});
}

double largest_move(std::size_t vertices, const std::function<std::uint64_t(std::size_t)>& bits_at, std::uint64_t key,
                    const device::Scale& scale) {
  if (!is_cut(key)) return move_length(key, scale);
  Scaled most;
  for (std::size_t i = 0; i < 2 * vertices; ++i) {
    const auto axis = static_cast<int>(i % 2);
    const std::uint64_t bits = bits_at(i);
    const device::Quantised placed = device::gcdt_quantise(bits, &scale, axis);
    if (placed.move == 0) continue;
    const Scaled move = move_of(bits, placed.value, scale, axis);
    if ((move - most).number.sign() > 0) most = move;
  }
  return exact::nearest_double(most.number.size(), most.unit, scale.five);
}

double largest_move(runtime::Runtime& runtime, const InputPoints& points, cl_uint first, cl_uint end, std::uint64_t key,
                    const device::Scale& scale) {
  if (!is_cut(key)) return move_length(key, scale);
  const std::vector<std::uint64_t> bits = read_coordinates(runtime, points, first, end);
  return largest_move(
      end - first, [&](std::size_t i) { return bits[i]; }, key, scale);
}

bool given_on_one_line(runtime::Runtime& runtime, const InputPoints& points) {
  const std::vector<std::uint64_t> bits = read_coordinates(runtime, points, 0, points.n);
  std::vector<exact::Point> given(points.n);
  std::memcpy(given.data(), bits.data(), bits.size() * sizeof bits[0]);
  std::size_t other = 1;
  while (other < given.size() && given[other] == given[0]) ++other;
  for (std::size_t i = other + 1; i < given.size(); ++i)
    if (exact::orient2d(given[0], given[other], given[i]) != 0) return false;
  return true;
}

}  // namespace gcdt
