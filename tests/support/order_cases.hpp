// SPDX-License-Identifier: Apache-2.0
// The order phase on every device, and all that it promises held against the oracle.
#pragma once

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <memory>

#include "coordinate_families.hpp"
#include "device_list.hpp"
#include "grid_oracle.hpp"
#include "phases/order.hpp"

namespace gcdt::order_cases {

using oracle::Doubles;

struct Device {
  runtime::Runtime runtime;
  Primitives primitives;
  explicit Device(const cl::Device& device, runtime::CallHook hook = {})
      : runtime(device, std::move(hook)), primitives(runtime) {}
};

/// Every device present, the software device of rusticl included; one that has a way of its own for few vertices also
/// without it. That way does not look for isolated vertices, so that none does here (isolation_test.cpp).
inline std::vector<std::unique_ptr<Device>>& devices_under_test() {
  static auto* made = [] {
    auto* list = new std::vector<std::unique_ptr<Device>>;
    for (const auto& device : test::every_device()) {
      runtime::CallHook hook;
      hook.tuning.least_row = std::numeric_limits<std::uint32_t>::max();
      list->push_back(std::make_unique<Device>(device, hook));
      hook.tuning.one_item_vertices = 0;
      if (list->back()->runtime.contiguous()) list->push_back(std::make_unique<Device>(device, hook));
    }
    return list;
  }();
  return *made;
}

constexpr std::uint32_t coarsest = 16;

inline Plan plan_for(const runtime::Runtime& runtime, const Points& points, std::uint32_t coarsest_level) {
  const auto n = static_cast<std::uint32_t>(points.size());
  Plan plan = make_plan(runtime, {1, n, n});
  plan.coarsest_level = coarsest_level;
  return plan;
}

/// What the order phase left on the device.
struct Read {
  Grid grid;
  std::vector<device::Levels> levels_and_table;
  std::uint64_t merged = 0;
  std::vector<cl_int2> points;
  std::vector<cl_uint> vertex_input, input_vertex;
  const device::Levels& levels() const { return levels_and_table[0]; }
};

inline Read run(runtime::Runtime& runtime, Primitives& primitives, Points points,
                const std::optional<FixedGrid>& fixed = {}) {
  const OrderResult result =
      order(runtime, primitives, plan_for(runtime, points, coarsest), stage(runtime, points), fixed);
  const Vertices& v = result.vertices;
  Read read{v.grid, {}, result.merged, {}, {}, {}};
  read.points.resize(v.n());
  read.vertex_input.resize(v.n());
  read.input_vertex.resize(points.size());
  runtime.read(v.points, read.points.data(), v.n());
  runtime.read(v.vertex_input, read.vertex_input.data(), v.n());
  runtime.read(v.input_vertex, read.input_vertex.data(), points.size());
  read.levels_and_table.resize(v.levels_buffer.size());
  runtime.read(v.levels_buffer, read.levels_and_table.data(), read.levels_and_table.size());
  CHECK(std::memcmp(&read.levels(), &v.levels, sizeof v.levels) == 0);
  CHECK(v.points.size() == v.n());
  CHECK(v.vertex_input.size() == v.n());
  CHECK(v.input_vertex.size() == points.size());
  return read;
}

inline Read run(Device& device, Points points, const std::optional<FixedGrid>& fixed = {}) {
  return run(device.runtime, device.primitives, points, fixed);
}

inline void check_same(const Read& a, const Read& b) {
  CHECK(a.grid.kind == b.grid.kind);
  CHECK(std::memcmp(a.grid.origin.data(), b.grid.origin.data(), sizeof a.grid.origin) == 0);
  CHECK(a.grid.cell_units == b.grid.cell_units);
  CHECK(a.grid.cell_decimals == b.grid.cell_decimals);
  CHECK(a.grid.cell_exponent == b.grid.cell_exponent);
  CHECK(a.grid.largest_move == b.grid.largest_move);
  CHECK(a.vertex_input == b.vertex_input);
  CHECK(a.input_vertex == b.input_vertex);
  CHECK(std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(cl_int2)) == 0);
}

/// Numbering: least input number, strictly ascending along the curve, ids as the levels say.
inline void check_numbering(const Read& read) {
  const auto n = static_cast<std::uint32_t>(read.points.size());
  CHECK(read.levels().n == n);
  CHECK(read.merged == read.input_vertex.size() - n);
  std::vector<cl_uint> least(n, std::numeric_limits<cl_uint>::max());
  for (cl_uint i = 0; i < read.input_vertex.size(); ++i) {
    REQUIRE(read.input_vertex[i] < n);
    cl_uint& l = least[read.input_vertex[i]];
    l = std::min(l, i);
  }
  CHECK(least == read.vertex_input);
  std::uint64_t before = 0;
  for (std::uint32_t rank = 0; rank < n; ++rank) {
    const std::uint32_t id = device::gcdt_vertex_of_rank(&read.levels(), read.levels().count - 1, rank);
    REQUIRE(id < n);
    const std::uint64_t code =
        device::gcdt_morton(static_cast<cl_uint>(read.points[id].s[0]), static_cast<cl_uint>(read.points[id].s[1]));
    if (rank > 0) CHECK(code > before);
    before = code;
  }
}

inline void check_grid_points(const Read& read, const std::vector<std::array<oracle::Integer, 2>>& expected) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const cl_int2 at = read.points[read.input_vertex[i]];
    CAPTURE(i);
    CHECK(oracle::Integer(at.s[0]) == expected[i][0]);
    CHECK(oracle::Integer(at.s[1]) == expected[i][1]);
  }
}

inline void check_move(double reported, const oracle::Rational& exact, const oracle::Rational& cell) {
  CHECK((reported == 0) == (exact == 0));
  const auto distance = [&](double v) { return oracle::Rational(abs(oracle::exact(v) - exact)); };
  const bool nearest = distance(reported) <= distance(std::nextafter(reported, HUGE_VAL)) &&
                       distance(reported) <= distance(std::nextafter(reported, 0));
  const bool decimal = boost::multiprecision::numerator(cell) != 1 || boost::multiprecision::denominator(cell) % 5 == 0;
  const oracle::Rational more = oracle::exact(reported) - exact;
  CHECK((nearest || (decimal && more >= 0 && more <= exact * oracle::power_of_two(-51))));
}

inline void check_against_oracle(const Read& read, const Doubles& points) {
  const oracle::Choice expected = oracle::choose(points);
  CHECK(read.grid.kind == expected.kind);
  for (int axis = 0; axis < 2 && !points.empty(); ++axis)
    CHECK(oracle::exact(read.grid.origin[axis]) == expected.origin[axis]);
  CHECK(read.grid.cell_units == (expected.decimal_cell ? 1u : 0u));
  if (expected.decimal_cell)
    CHECK(read.grid.cell_decimals == expected.cell_decimals);
  else
    CHECK(read.grid.cell_exponent == expected.cell_exponent);
  check_grid_points(read, expected.grid);
  check_move(read.grid.largest_move, expected.largest_move, oracle::cell_of(expected));
}

/// All that the phase promises (lib/phases/order.hpp) on all devices for one input.
inline Read check_all(const Doubles& points) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(points.size(), 8); ++i) {
    char line[80];
    std::snprintf(line, sizeof line, "(%a, %a) ", points[i][0], points[i][1]);
    text += line;
  }
  CAPTURE(text);
  std::optional<Read> first;
  for (auto& device : devices_under_test()) {
    CAPTURE(device->runtime.info().name);
    Read read = run(*device, points);
    check_numbering(read);
    if (first)
      check_same(*first, read);
    else
      check_against_oracle(read, points);
    if (!first) first = std::move(read);
  }
  return *first;
}

}  // namespace gcdt::order_cases
