// SPDX-License-Identifier: Apache-2.0
#include "grid_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace oracle {

namespace {

Integer power(int base, int exponent) { return boost::multiprecision::pow(Integer(base), unsigned(exponent)); }

}  // namespace

const Integer last = power(2, 31) - 1;

Rational power_of_two(int k) { return k >= 0 ? Rational(power(2, k)) : Rational(Integer(1), power(2, -k)); }

Rational power_of_ten(int d) { return d >= 0 ? Rational(power(10, d)) : Rational(Integer(1), power(10, -d)); }

Rational exact(double v) {
  int exponent;
  const double fraction = std::frexp(v, &exponent);
  return Rational(Integer(static_cast<long long>(std::ldexp(fraction, 53)))) * power_of_two(exponent - 53);
}

Integer floor_of(const Rational& r) {
  const Integer a = numerator(r), b = denominator(r);
  Integer q = a / b;
  if (a < 0 && q * b != a) --q;
  return q;
}

Integer round_half_even(const Rational& r) {
  const Integer below = floor_of(r);
  const Rational rest = r - Rational(below), half(1, 2);
  if (rest > half || (rest == half && below % 2 != 0)) return below + 1;
  return below;
}

Rational decimal_number(const std::string& text) {
  const std::size_t e = text.find('e');
  std::string digits = text.substr(0, e);
  int exponent = e == std::string::npos ? 0 : std::stoi(text.substr(e + 1));
  const std::size_t point = digits.find('.');
  if (point != std::string::npos) {
    exponent -= int(digits.size() - point - 1);
    digits.erase(point, 1);
  }
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));  // a leading 0 would mean octal
  return Rational(Integer(digits)) * power_of_ten(exponent);
}

Rational cell_of(const Choice& c) {
  return c.decimal_cell ? power_of_ten(-c.cell_decimals) : power_of_two(c.cell_exponent);
}

void place(Choice& c, const Doubles& points, const Rational& cell) {
  for (const auto& p : points) {
    std::array<Integer, 2> g;
    for (int axis = 0; axis < 2; ++axis) {
      const Rational x = exact(p[axis]) - c.origin[axis];
      g[axis] = round_half_even(x / cell);
      const Rational move = abs(x - Rational(g[axis]) * cell);
      if (move > c.largest_move) c.largest_move = move;
    }
    c.grid.push_back(g);
  }
}

bool reads_as(const Integer& n, int d, double v) {
  return std::strtod((n.str() + "e-" + std::to_string(d)).c_str(), nullptr) == v;
}

Decimal shortest_decimal(double v) {
  const Integer limit = power(2, 63);
  for (int d = 0; d <= 22; ++d) {
    const Rational wanted = exact(v) * power_of_ten(d);
    Integer n = round_half_even(wanted);
    if (!reads_as(n, d, v)) n += Rational(n) > wanted ? -1 : 1;
    if (reads_as(n, d, v)) return abs(n) < limit ? Decimal{d, n} : Decimal{};
  }
  return {};
}

namespace {

bool choose_decimal(Choice& c, const Doubles& points) {
  std::vector<std::array<Decimal, 2>> decimals;
  int digits = 0;
  for (const auto& p : points) {
    decimals.push_back({shortest_decimal(p[0]), shortest_decimal(p[1])});
    digits = std::max({digits, decimals.back()[0].d, decimals.back()[1].d});
    if (digits > 22) return false;
  }
  std::array<Integer, 2> least, most;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 2; ++axis) {
      Integer& n = decimals[i][axis].n;
      n *= power(10, digits - decimals[i][axis].d);
      if (abs(n) >= power(2, 63)) return false;
      least[axis] = i == 0 ? n : std::min(least[axis], n);
      most[axis] = i == 0 ? n : std::max(most[axis], n);
    }
  const Integer extent = std::max<Integer>(most[0] - least[0], most[1] - least[1]);
  if (extent > last) return false;
  c.decimal_cell = true;
  for (c.cell_decimals = digits; c.cell_decimals < 22 && extent * power(10, c.cell_decimals + 1 - digits) <= last;)
    ++c.cell_decimals;
  for (const auto& pair : decimals) {
    std::array<Integer, 2> g;
    for (int axis = 0; axis < 2; ++axis) g[axis] = (pair[axis].n - least[axis]) * power(10, c.cell_decimals - digits);
    c.grid.push_back(g);
  }
  return true;
}

}  // namespace

Choice choose(const Doubles& points) {
  Choice c;
  std::array<Rational, 2> most;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 2; ++axis) {
      const Rational x = exact(points[i][axis]);
      c.origin[axis] = i == 0 ? x : std::min(c.origin[axis], x);
      most[axis] = i == 0 ? x : std::max(most[axis], x);
    }
  const Rational extent = std::max<Rational>(most[0] - c.origin[0], most[1] - c.origin[1]);
  if (extent == 0) {
    c.grid.assign(points.size(), {});
    return c;
  }
  int k = std::max(-1074, int(msb(numerator(extent))) - int(msb(denominator(extent))) - 33);
  while (round_half_even(extent / power_of_two(k)) > last) ++k;
  c.cell_exponent = k;
  bool binary = true;
  for (const auto& p : points)
    for (double v : p) binary = binary && denominator(Rational(exact(v) / power_of_two(k))) == 1;
  if (!binary) {
    c.kind = gcdt::Grid::Kind::decimal;
    if (choose_decimal(c, points)) return c;
    c.kind = gcdt::Grid::Kind::rounded;
  }
  place(c, points, power_of_two(k));
  return c;
}

}  // namespace oracle
