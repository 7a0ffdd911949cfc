// SPDX-License-Identifier: Apache-2.0
// The grid rules once more, on the host in rational arithmetic and with strtod as the reader of
// decimals: the oracle for the order phase.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>

#include <array>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

namespace oracle {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;
using Doubles = std::vector<std::array<double, 2>>;

Rational power_of_two(int k);
Rational power_of_ten(int d);

Rational exact(double v);
Integer floor_of(const Rational& r);
Integer round_half_even(const Rational& r);

extern const Integer last;  // the grid's last coordinate

/// The number that a decimal text such as 1.5e-3 means.
Rational decimal_number(const std::string& text);

struct Choice {
  gcdt::Grid::Kind kind = gcdt::Grid::Kind::binary;
  bool decimal_cell = false;
  int cell_exponent = 0, cell_decimals = 0;
  std::array<Rational, 2> origin;
  std::vector<std::array<Integer, 2>> grid;
  Rational largest_move;
};

Rational cell_of(const Choice& c);

/// Points on the grid of that origin and cell, and the largest move.
void place(Choice& c, const Doubles& points, const Rational& cell);

/// The decimal N / 10^d with the least d that reads as v; d = 23 if there is none.
struct Decimal {
  int d = 23;
  Integer n;
};

bool reads_as(const Integer& n, int d, double v);
Decimal shortest_decimal(double v);

Choice choose(const Doubles& points);

}  // namespace oracle
