// SPDX-License-Identifier: Apache-2.0
// The exact arithmetic of kernels/order/quantise.h and the choice of fixed grids, on the host, against
// rational arithmetic.
#include "mesh/grid.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "coordinate_families.hpp"
#include "grid_oracle.hpp"

using namespace gcdt;
using namespace families;
using oracle::Integer;
using oracle::Rational;

namespace {

std::uint64_t bits_of(double v) {
  std::uint64_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
}

double next(double v, int steps) {
  for (; steps > 0; --steps) v = std::nextafter(v, std::numeric_limits<double>::infinity());
  for (; steps < 0; ++steps) v = std::nextafter(v, -std::numeric_limits<double>::infinity());
  return v;
}

// One coordinate on a fixed grid against the oracle; returns whether it is inside.
bool check_one(double x, const FixedGrid& fixed, const ChosenGrid& chosen, const Rational& cell) {
  CAPTURE(x);
  CAPTURE(fixed.x);
  CAPTURE(fixed.cell);
  const Rational distance = oracle::exact(x) - oracle::exact(fixed.x);
  const Integer expected = oracle::round_half_even(distance / cell);
  const bool inside = expected >= 0 && expected <= oracle::last;
  const device::Quantised got = device::gcdt_quantise(device::gcdt_without_negative_zero(bits_of(x)), &chosen.scale, 0);
  CHECK((got.outside == 0) == inside);
  device::Scale wide = chosen.scale;  // without the shorter way for cells that are powers of two
  wide.fixed_point[0] = 0;
  const device::Quantised again = device::gcdt_quantise(device::gcdt_without_negative_zero(bits_of(x)), &wide, 0);
  const bool same = got.value == again.value && got.outside == again.outside && got.move == again.move;
  CHECK(same);
  if (!inside || got.outside) return false;
  CHECK(Integer(got.value) == expected);
  const Rational move = abs(distance - Rational(expected) * cell),
                 reported = oracle::exact(move_length(got.move, chosen.scale));
  CHECK((got.move == 0) == (move == 0));
  const Rational slack = std::max<Rational>(move * oracle::power_of_two(-51), cell * oracle::power_of_two(-106));
  CHECK(abs(reported - move) <= std::max<Rational>(slack, oracle::power_of_two(-1074)));
  return true;
}

std::string random_cell(Engine& e) {
  switch (integer(e, 0, 5)) {
    case 0: return "1e" + std::to_string(integer(e, -22, 22));
    case 1: return std::to_string(integer(e, 1, 999)) + "e" + std::to_string(integer(e, -22, 20));
    case 2:
      return std::to_string(integer(e, 1, std::numeric_limits<std::int64_t>::max() / 100) * 10 + 1) + "e" +
             std::to_string(integer(e, -22, 22));
    case 3: return "9223372036854775807e22";
    case 4: return std::to_string(integer(e, 1, 99999)) + "." + std::to_string(integer(e, 0, 99999));
    default: {
      char text[64];
      std::snprintf(text, sizeof text, "%.17g", std::ldexp(1.0, int(integer(e, -1074, 1023))));
      return text;
    }
  }
}

}  // namespace

TEST_CASE("floats and integers become the bits of the doubles that they are") {
  Engine e(1);
  for (int i = 0; i < 200000; ++i) {
    const std::uint32_t word = i < 64    ? 1u << (i % 32)
                               : i < 128 ? 0xFFFFFFFFu << (i % 32)
                                         : std::uint32_t(e()) >> (e() % 32);
    float f;
    std::memcpy(&f, &word, sizeof f);
    if (!std::isnan(f)) REQUIRE(device::gcdt_double_of_float(word) == bits_of(double(f)));
    if (std::isnan(f)) REQUIRE(!device::gcdt_is_finite(device::gcdt_double_of_float(word)));
    REQUIRE(device::gcdt_double_of_int(word) == bits_of(double(std::int32_t(word))));
    const std::uint64_t whole = e() >> (e() % 64), most = std::uint64_t(1) << 53;
    for (const std::uint64_t v : {whole, ~whole, most, ~most + 1, most + 1, ~most})
      if (const auto number = std::int64_t(v); number <= std::int64_t(most) && number >= -std::int64_t(most))
        REQUIRE(device::gcdt_double_of_long(v) == bits_of(double(number)));
      else
        REQUIRE(!device::gcdt_is_finite(device::gcdt_double_of_long(v)));
  }
}

TEST_CASE("mantissa, exponents and the ordered key are those of the double") {
  Engine e(2);
  double before = 0;
  for (int i = 0; i < 100000; ++i) {
    const double v = all.at(i % 3 == 0 ? "far powers of two" : i % 3 == 1 ? "denormals" : "any bits")(e);
    const std::uint64_t bits = bits_of(v);
    REQUIRE(std::ldexp(double(device::gcdt_mantissa(bits)), device::gcdt_exponent(bits)) == std::fabs(v));
    REQUIRE(device::gcdt_from_ordered(device::gcdt_ordered(bits)) == bits);
    REQUIRE((device::gcdt_ordered(bits) < device::gcdt_ordered(bits_of(before))) == (v < before));
    if (v != 0) {
      const int t = device::gcdt_trailing_exponent(bits);
      REQUIRE(std::fmod(std::fabs(v), std::ldexp(1.0, t)) == 0);
      if (t < 1023) REQUIRE(std::fmod(std::fabs(v), std::ldexp(1.0, t + 1)) != 0);
    }
    before = v;
  }
}

TEST_CASE("a double's shortest decimal is found, and one more decimal always does as well") {
  Engine e(3);
  for (const auto& [name, family] : all) {
    CAPTURE(name);
    for (int i = 0; i < 150; ++i) {
      const double v = family(e);
      CAPTURE(v);
      const std::uint64_t bits = bits_of(v);
      const oracle::Decimal expected = oracle::shortest_decimal(v);
      const int d = device::gcdt_decimals_needed(bits, 0, GCDT_MAX_DECIMALS);
      if (d > GCDT_MAX_DECIMALS) {
        REQUIRE(expected.d == 23);
        continue;
      }
      const auto n = device::gcdt_decimal_numerator(bits, d);
      REQUIRE((n == std::numeric_limits<std::int64_t>::min()) == (expected.d == 23));
      if (expected.d == 23) continue;
      REQUIRE(d == expected.d);
      REQUIRE(Integer(n) == expected.n);
      std::uint64_t numerator;
      for (int more = d; more <= GCDT_MAX_DECIMALS; ++more) REQUIRE(device::gcdt_decimal(bits, more, &numerator));
    }
  }
}

TEST_CASE("a double below a binade boundary is not taken for the boundary's decimal, nor the other way round") {
  for (int exponent = -70; exponent <= 60; ++exponent)
    for (int steps = -3; steps <= 3; ++steps) {
      const double v = next(std::ldexp(1.0, exponent), steps);
      const oracle::Decimal expected = oracle::shortest_decimal(v);
      const int d = device::gcdt_decimals_needed(bits_of(v), 0, GCDT_MAX_DECIMALS);
      CAPTURE(v);
      if (expected.d <= 22) {
        CHECK(d == expected.d);
        CHECK(Integer(device::gcdt_decimal_numerator(bits_of(v), d)) == expected.n);
      }
      // Whether it can be written at all, without the limit of 63 bits.
      for (int digits = 0; digits <= GCDT_MAX_DECIMALS; ++digits) {
        const Integer below = oracle::floor_of(oracle::exact(v) * oracle::power_of_ten(digits));
        std::uint64_t numerator;
        CHECK((device::gcdt_decimal(bits_of(v), digits, &numerator) != 0) ==
              (oracle::reads_as(below, digits, v) || oracle::reads_as(below + 1, digits, v)));
      }
    }
}

TEST_CASE("coordinates of every family on any fixed grid are rounded half to even, exactly") {
  Engine e(4);
  int inside = 0;
  for (const auto& [name, family] : all)
    for (int i = 0; i < 300; ++i) {
      CAPTURE(name);
      const FixedGrid fixed{i % 3 == 0 ? 0.0 : family(e), 0, random_cell(e)};
      const ChosenGrid chosen = fixed_grid(fixed);
      const Rational cell = chosen.grid.cell_units == 0 ? oracle::power_of_two(chosen.grid.cell_exponent)
                                                        : oracle::decimal_number(fixed.cell);
      inside += check_one(family(e), fixed, chosen, cell);
      inside += check_one(fixed.x, fixed, chosen, cell);
      // Near a grid point or a tie, wherever a double is near one.
      const Integer at = Integer(e() % (i % 2 ? 20 : 4294967299ull)) - 4;
      const Rational tie = oracle::exact(fixed.x) + Rational(at, 2) * cell;
      const double x = tie.convert_to<double>();
      if (!std::isfinite(x)) continue;
      for (int steps = -2; steps <= 2; ++steps)
        if (std::isfinite(next(x, steps))) inside += check_one(next(x, steps), fixed, chosen, cell);
    }
  CHECK(inside > 10000);
}

TEST_CASE("an origin far finer than the cell decides ties") {
  for (const char* cell : {"2", "0.5", "10", "1e-3", "3", "1e22", "1e-22", "9999999999999999999e10"})
    for (double hair : {5e-324, 1e-300, 1e-200, 1e-60, 1e-40, 1e-35, 1e-30, 0.0}) {
      const Rational edge = oracle::decimal_number(cell);
      for (int sign : {-1, 1}) {
        const FixedGrid fixed{sign * hair, 0, cell};
        const ChosenGrid chosen = fixed_grid(fixed);
        for (int i = -3; i < 200; ++i) {
          const double x = Rational(Rational(i, 2) * edge).convert_to<double>();
          for (int steps = -1; steps <= 1; ++steps) check_one(next(x, steps), fixed, chosen, edge);
        }
      }
    }
}

TEST_CASE("a cell is read exactly, and a power of two is meant where it is the nearest double") {
  struct Case {
    const char* text;
    std::uint64_t units;
    int decimals, exponent;
  };
  for (const Case& c :
       {Case{"0.001", 1, 3, 0}, Case{"1e-3", 1, 3, 0}, Case{"+010.0e-04", 1, 3, 0}, Case{"1", 0, 0, 0},
        Case{"0.5", 0, 0, -1}, Case{"1024", 0, 0, 10}, Case{"5e-324", 0, 0, -1074},
        Case{"9.094947017729282e-13", 0, 0, -40}, Case{"3", 3, 0, 0}, Case{"300", 300, 0, 0},
        Case{"1e22", 10000000000000000000u, -3, 0}, Case{"1234567890123456789", 1234567890123456789u, 0, 0},
        Case{".1", 1, 1, 0}, Case{"7.", 7, 0, 0}, Case{"2.5E+1", 25, 0, 0}}) {
    const Grid grid = fixed_grid({0, 0, c.text}).grid;
    CAPTURE(c.text);
    CHECK(grid.cell_units == c.units);
    CHECK(grid.cell_decimals == c.decimals);
    CHECK(grid.cell_exponent == c.exponent);
    CHECK(grid.cell() == std::strtod(c.text, nullptr));
  }
}

TEST_CASE("a cell or an origin that makes no sense is an invalid argument") {
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<FixedGrid> bad{
      {infinite, 0, "1"}, {0, -infinite, "1"}, {std::numeric_limits<double>::quiet_NaN(), 0, "1"}};
  for (const char* cell : {"",
                           "0",
                           "-1",
                           "0.0",
                           "0e5",
                           "nan",
                           "inf",
                           "1e400",
                           "1e-400",
                           "1,5",
                           "1 ",
                           " 1",
                           "1e",
                           "1e+",
                           "e5",
                           ".",
                           "+",
                           "0x10",
                           "1.2.3",
                           "12345678901234567890123",
                           "1e-23",
                           "3e23",
                           "1e99999999999999999999",
                           "1e-99999999999999999999",
                           "--1",
                           "1f"})
    bad.push_back({0, 0, cell});
  for (const FixedGrid& fixed : bad) {
    CAPTURE(fixed.cell);
    try {
      fixed_grid(fixed);
      FAIL("no error");
    } catch (const Error& error) {
      CHECK(error.status() == Status::invalid_argument);
    }
  }
}

TEST_CASE("a cell's double is the nearest one") {
  Grid grid;
  grid.cell_units = 1;
  for (grid.cell_decimals = 0; grid.cell_decimals <= 22; ++grid.cell_decimals)
    CHECK(grid.cell() == std::strtod(("1e-" + std::to_string(grid.cell_decimals)).c_str(), nullptr));
  grid = Grid{};
  grid.cell_exponent = -1074;
  CHECK(grid.cell() == 5e-324);
}
