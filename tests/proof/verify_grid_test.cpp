// SPDX-License-Identifier: Apache-2.0
// The host's grid against the words of docs/contract.md, 1, computed here with exact rationals.
#include "proof/grid.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "gcdt/verify.hpp"

using namespace gcdt;

namespace {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;
using Doubles = std::vector<std::array<double, 2>>;
using Random = std::mt19937_64;

constexpr std::int64_t largest = 0x7fffffff;

Rational power(int base, int exponent) {
  Rational result = 1;
  Rational factor = exponent < 0 ? Rational(1, base) : Rational(base);
  for (int i = std::abs(exponent); i > 0; i /= 2, factor *= factor)
    if (i % 2) result *= factor;
  return result;
}

Rational exact(double v) {
  int exponent = 0;
  const double fraction = std::frexp(v, &exponent);
  return Rational(static_cast<std::int64_t>(std::ldexp(fraction, 53))) * power(2, exponent - 53);
}

Integer floor_of(const Rational& r) {
  Integer quotient = numerator(r) / denominator(r);
  return r < 0 && Rational(quotient) != r ? quotient - 1 : quotient;
}

Integer round_half_even(const Rational& r) {
  const Integer below = floor_of(r);
  const Rational rest = r - below;
  if (rest == Rational(1, 2)) return below % 2 == 0 ? below : below + 1;
  return rest > Rational(1, 2) ? below + 1 : below;
}

/// The nearest double, ties to even, from the definition: round to a multiple of the unit of the binade.
double nearest_double(const Rational& r) {
  if (r == 0) return 0;
  const Rational size = abs(r);
  int exponent = static_cast<int>(msb(numerator(size))) - static_cast<int>(msb(denominator(size)));
  if (size < power(2, exponent)) --exponent;
  const int unit = std::max(exponent - 52, -1074);
  const double magnitude = std::ldexp(round_half_even(size / power(2, unit)).convert_to<double>(), unit);
  return r < 0 ? -magnitude : magnitude;
}

struct Digits {
  Integer units;
  int decimals;
};

std::optional<Digits> shortest(double v) {
  for (int d = 0; d <= 22; ++d) {
    const Rational scaled = exact(v) * power(10, d);
    const Integer nearest = round_half_even(scaled), other = nearest + (nearest > scaled ? -1 : 1);
    for (const Integer& units : {nearest, other})
      if (abs(units) < Integer(1) << 63 && nearest_double(Rational(units) * power(10, -d)) == v)
        return Digits{units, d};
  }
  return std::nullopt;
}

Rational cell_value(const Grid& grid) {
  if (grid.cell_units == 0) return power(2, grid.cell_exponent);
  return Rational(grid.cell_units) * power(10, -grid.cell_decimals);
}

struct Expected {
  Grid::Kind kind = Grid::Kind::binary;
  Rational cell = 1;
  std::array<double, 2> origin{0, 0};
};

std::optional<int> expected_decimals(const Doubles& points) {
  int d0 = 0;
  for (auto& p : points)
    for (double v : p) {
      const auto digits = shortest(v);
      if (!digits) return std::nullopt;
      d0 = std::max(d0, digits->decimals);
    }
  Integer extent = 0;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<Integer> values;
    for (auto& p : points) {
      const auto digits = *shortest(p[axis]);
      values.push_back(numerator(Rational(digits.units) * power(10, d0 - digits.decimals)));
      if (values.back() > std::numeric_limits<std::int64_t>::max()) return std::nullopt;
      if (values.back() < std::numeric_limits<std::int64_t>::min()) return std::nullopt;
    }
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    extent = std::max(extent, Integer(*most - *least));
  }
  for (int decimals = 22; decimals >= d0; --decimals)
    if (Rational(extent) * power(10, decimals - d0) <= largest) return decimals;
  return std::nullopt;
}

Expected expected_grid(const Doubles& points) {
  Expected expected;
  Rational extent = 0;
  for (int axis = 0; axis < 2; ++axis) {
    double least = points[0][axis], most = least;
    for (auto& p : points) least = std::min(least, p[axis]), most = std::max(most, p[axis]);
    expected.origin[axis] = least + 0.0;
    extent = std::max(extent, Rational(exact(most) - exact(least)));
  }
  if (extent == 0) return expected;
  int k = static_cast<int>(msb(numerator(extent))) - static_cast<int>(msb(denominator(extent))) - 40;
  k = std::max(k, -1074);
  while (round_half_even(extent / power(2, k)) > largest) ++k;
  expected.cell = power(2, k);
  auto multiple = [&](double v) { return denominator(Rational(exact(v) / expected.cell)) == 1; };
  if (std::all_of(points.begin(), points.end(), [&](auto& p) { return multiple(p[0]) && multiple(p[1]); }))
    return expected;
  expected.kind = Grid::Kind::rounded;
  if (const auto decimals = expected_decimals(points)) {
    expected.kind = Grid::Kind::decimal;
    expected.cell = power(10, -*decimals);
  }
  return expected;
}

/// Where `grid` puts a coordinate; on a decimal grid it is what was written that counts.
Integer expected_place(double v, const Grid& grid, int axis) {
  if (grid.kind != Grid::Kind::decimal)
    return round_half_even((exact(v) - exact(grid.origin[axis])) / cell_value(grid));
  const auto a = *shortest(v), b = *shortest(grid.origin[axis]);
  const Rational offset = Rational(a.units) * power(10, -a.decimals) - Rational(b.units) * power(10, -b.decimals);
  return numerator(Rational(offset / cell_value(grid)));
}

void check_places(const Doubles& points, const Grid& grid) {
  std::string reason;
  const auto vertices = proof::quantise(points, grid, reason);
  CHECK(reason == "");
  REQUIRE(vertices.size() == points.size());
  Rational move = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 2; ++axis) {
      const Integer place = expected_place(points[i][axis], grid, axis);
      CHECK(place == Integer(axis ? vertices[i].y : vertices[i].x));
      move = std::max(
          move, Rational(abs(Rational(exact(points[i][axis]) - exact(grid.origin[axis]) - place * cell_value(grid)))));
    }
  const bool moves = grid.kind == Grid::Kind::rounded || grid.kind == Grid::Kind::fixed;
  CHECK(grid.largest_move == (moves ? nearest_double(move) : 0));
}

Grid::Kind check_choice(const Doubles& points) {
  const Grid grid = choose_grid(points);
  const Expected expected = expected_grid(points);
  CHECK(grid.kind == expected.kind);
  CHECK(cell_value(grid) == expected.cell);
  CHECK(grid.origin == expected.origin);
  for (double v : grid.origin) CHECK_FALSE((v == 0 && std::signbit(v)));
  check_places(points, grid);
  return grid.kind;
}

std::int64_t below(Random& random, std::int64_t limit) {
  return std::uniform_int_distribution<std::int64_t>(0, limit - 1)(random);
}

double any_finite(Random& random) {
  for (;;) {
    const std::uint64_t bits = random();
    double v;
    std::memcpy(&v, &bits, sizeof v);
    if (std::isfinite(v)) return v;
  }
}

double decimal(std::int64_t units, int decimals) { return nearest_double(Rational(units) * power(10, -decimals)); }

/// One coordinate of the family; all coordinates of one input share `shape`.
double draw(Random& random, int family, std::int64_t shape) {
  switch (family) {
    case 0: return double(below(random, shape % 5000 + 1));                               // integers
    case 1: return std::ldexp(double(below(random, largest)), int(shape % 2000) - 1070);  // one power of two
    case 2: return decimal(below(random, 100000) + shape, int(shape % 9));                // few decimals
    case 3: return decimal(below(random, largest) + shape % 7 * 1000000000000, 7);        // many decimals
    case 4: return decimal(below(random, 1000), int(shape % 23));                         // tiny decimals
    case 5: return std::uniform_real_distribution<>(-1, 1)(random);                       // general doubles
    case 6: return std::ldexp(std::uniform_real_distribution<>(-1, 1)(random), int(shape % 2090) - 1066);
    case 7: return any_finite(random);                                                       // all magnitudes
    case 8: return std::ldexp(double(below(random, 8)), -1074);                              // denormals
    case 9: return std::ldexp(1.0, 51) + double(below(random, 9)) / 4;                       // halves of decimals
    case 10: return float(std::uniform_real_distribution<>(0, 1)(random));                   // floats
    case 11: return std::ldexp(double(below(random, 2 * largest + 2)), -1);                  // half a cell
    default: return std::nextafter(double(shape), below(random, 2) ? HUGE_VAL : -HUGE_VAL);  // neighbours
  }
}

constexpr int families = 13;

Doubles draw_points(Random& random) {
  const int family_x = int(below(random, families));
  const int family_y = below(random, 3) ? family_x : int(below(random, families));
  const std::int64_t shape = below(random, 1 << 20);
  Doubles points(static_cast<std::size_t>(1 + below(random, 12)));
  for (auto& p : points) p = {draw(random, family_x, shape), draw(random, family_y, shape)};
  if (below(random, 4) == 0)
    for (auto& p : points) p[0] = p[0] == 0 ? 0 : -p[0];
  return points;
}

std::vector<std::uint64_t> indices_of(const std::function<void()>& call, Status status) {
  try {
    call();
  } catch (const Error& error) {
    CHECK(error.status() == status);
    return error.indices();
  }
  FAIL("nothing was thrown");
  return {};
}

}  // namespace

TEST_CASE("the shortest decimal of a double is the one that exact rationals find") {
  Random random(1);
  for (int i = 0; i < 4000; ++i) {
    double v = draw(random, int(below(random, families)), below(random, 1 << 20));
    if (std::abs(v) < 1e-30 || std::abs(v) > 1e25) v = std::ldexp(1.0, int(below(random, 130)) - 65);
    const auto found = proof::shortest_decimal(v);
    const auto expected = shortest(v);
    CAPTURE(v);
    REQUIRE(bool(found) == bool(expected));
    if (!found) continue;
    CHECK(Integer(found->units) == expected->units);
    CHECK(found->decimals == expected->decimals);
  }
}

TEST_CASE("the grid is the one that exact rationals choose, and vertices stand where they say") {
  Random random(2);
  int count[4] = {};
  for (int i = 0; i < 800; ++i) ++count[int(check_choice(draw_points(random)))];
  CHECK(count[int(Grid::Kind::binary)] > 50);
  CHECK(count[int(Grid::Kind::decimal)] > 50);
  CHECK(count[int(Grid::Kind::rounded)] > 50);
}

TEST_CASE("named inputs get the kinds that docs/contract.md gives them") {
  using Kind = Grid::Kind;
  const double most = std::numeric_limits<double>::max(), denormal = std::numeric_limits<double>::denorm_min();
  CHECK(check_choice({{0, 0}}) == Kind::binary);
  CHECK(check_choice({{-0.0, 5}, {-0.0, 5}}) == Kind::binary);
  CHECK(check_choice({{0, 0}, {double(largest), 0}}) == Kind::binary);
  CHECK(check_choice({{0, 0}, {double(largest) + 1, 0}}) == Kind::binary);
  CHECK(check_choice({{0, 0}, {double(largest) + 1, 1}}) == Kind::rounded);
  CHECK(check_choice({{0, 0}, {double(largest) + 0.5, 0}}) == Kind::rounded);
  CHECK(check_choice({{0, 0}, {double(largest) - 0.5, 0}}) == Kind::rounded);
  CHECK(check_choice({{0.1, 0.2}, {0.3, 0.7}}) == Kind::decimal);
  CHECK(check_choice({{0.1, 0}, {214748364.8, 0}}) == Kind::decimal);
  CHECK(check_choice({{0.1, 0}, {214748364.9, 0}}) == Kind::rounded);
  CHECK(check_choice({{-124.1234567, 37.7654321}, {-66.9499999, 49.3844999}}) == Kind::decimal);
  CHECK(check_choice({{1e-22, 0}, {3e-22, 0}}) == Kind::decimal);
  CHECK(check_choice({{1e-23, 0}, {3e-23, 0}}) == Kind::rounded);
  CHECK(check_choice({{-most, -most}, {most, most}}) == Kind::rounded);
  CHECK(check_choice({{-most, 0}, {most, denormal}}) == Kind::rounded);
  CHECK(check_choice({{denormal, -denormal}, {2 * denormal, 0}}) == Kind::binary);
  CHECK(check_choice({{std::ldexp(1.0, 51) + 0.25, 0.1}, {std::ldexp(1.0, 51) + 0.75, 0.2}}) == Kind::decimal);
  CHECK(choose_grid(Points()).origin == std::array<double, 2>{0, 0});
}

TEST_CASE("coordinates of many grid lines are those that one by one get by exact integers") {
  Random random(77031);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  std::size_t grids = 0;
  for (int i = 0; i < 4000; ++i) {
    Grid grid;
    grid.kind = std::array{Grid::Kind::decimal, Grid::Kind::binary, Grid::Kind::rounded, Grid::Kind::fixed}[i % 4];
    if (grid.kind == Grid::Kind::decimal) {
      grid.cell_units = 1, grid.cell_decimals = static_cast<int>(below(26));
      for (double& v : grid.origin)
        v = std::ldexp(static_cast<double>(random() >> 11), -static_cast<int>(below(70))) * (below(2) ? 1 : -1);
    } else {
      grid.cell_units = grid.kind == Grid::Kind::fixed && below(2) ? 1 + below(std::uint64_t{1} << below(40)) : 0;
      grid.cell_decimals = grid.cell_units > 0 ? static_cast<int>(below(8)) - 2 : 0;
      grid.cell_exponent = grid.cell_units > 0 ? 0 : static_cast<int>(below(2200)) - 1150;
      for (double& v : grid.origin)
        v = below(4) == 0 ? 0
                          : std::ldexp(static_cast<double>(random() >> 11),
                                       grid.cell_exponent + static_cast<int>(below(90)) - 60);
    }
    if (!std::isfinite(grid.origin[0]) || !std::isfinite(grid.origin[1]) || !proof::grid_defect(grid).empty()) continue;
    ++grids;
    const proof::Coordinates many(grid);
    for (const std::int64_t line :
         std::array<std::int64_t, 5>{0, 1, 2, static_cast<std::int64_t>(below(std::uint64_t{1} << 31)), 0x7fffffff})
      for (int axis = 0; axis < 2; ++axis) {
        const auto at = static_cast<std::int32_t>(line);
        const double fast = many.at(axis, at), exact = proof::coordinate_at(grid, axis, at);
        if (fast == exact) continue;
        CAPTURE(i);
        CAPTURE(at);
        CHECK(fast == exact);
      }
  }
  CHECK(grids > 3000);
}

TEST_CASE("points of every number type get the grid of the doubles they equal") {
  const std::vector<std::array<float, 2>> floats = {{0.1f, 0.5f}, {3.25f, -7.5f}};
  const std::vector<std::array<std::int32_t, 2>> integers = {{-2147483647 - 1, 5}, {2147483647, 6}};
  for (const Points& points : {Points(floats), Points(integers)}) {
    Doubles doubles;
    for (std::size_t i = 0; i < points.size(); ++i)
      doubles.push_back({points.coordinate(i, 0), points.coordinate(i, 1)});
    const Grid a = choose_grid(points), b = choose_grid(doubles);
    CHECK(a.kind == b.kind);
    CHECK(a.origin == b.origin);
    CHECK(cell_value(a) == cell_value(b));
    check_choice(doubles);
  }
}

TEST_CASE("a fixed grid's cell is the decimal that its text spells, or the power of two nearest to it") {
  const std::pair<const char*, Rational> good[] = {
      {"1", 1},
      {"0.5", Rational(1, 2)},
      {"0.001", Rational(1, 1000)},
      {"+00.00100", Rational(1, 1000)},
      {"1e-22", power(10, -22)},
      {"1e22", power(10, 22)},
      {"9999999999999999999", Rational(Integer("9999999999999999999"))},
      {"1234567890.123456789", Rational(Integer("1234567890123456789")) * power(10, -9)},
      {"30", 30},
      {"3.E1", 30},
      {".3", Rational(3, 10)},
      {"1024.0", 1024},
      {"9.0949470177292824e-13", power(2, -40)},
      {"1e-0000000003", Rational(1, 1000)},
      {"4.9406564584124654e-324", power(2, -1074)},
      {"8.9884656743115795e307", power(2, 1023)},
      {"1.00000000000000000001", 1},
  };
  for (const auto& entry : good) {
    const auto [text, value] = entry;
    INFO(entry.first);
    const Grid grid = choose_grid(Points(), FixedGrid{3, -0.0, text});
    CHECK(grid.kind == Grid::Kind::fixed);
    CHECK(cell_value(grid) == value);
    CHECK(grid.origin == std::array<double, 2>{3, 0});
  }
  for (const char* text :
       {"",        ".",        "0",     "0.000", "-1",  "1e",  "1e+",  "e5",    "1 ",
        " 1",      "1x",       "0x10",  "1,5",   "nan", "inf", "1e23", "1e-23", "12345678901234567891",
        "1.5e-22", "1e999999", "1.2.3", "--1"}) {
    CAPTURE(text);
    CHECK(indices_of([&] { choose_grid(Points(), FixedGrid{0, 0, text}); }, Status::invalid_argument).empty());
  }
  indices_of([] { choose_grid(Points(), FixedGrid{HUGE_VAL, 0, "1"}); }, Status::invalid_argument);
}

TEST_CASE("on a fixed grid vertices are rounded half to even, or refused if they do not fit") {
  Random random(3);
  int fitting = 0;
  for (int i = 0; i < 3000; ++i) {
    const char* cells[] = {"1", "0.5", "0.001", "3", "0.7", "1e22", "1e-22", "9999999999999999999", "0.000125"};
    Doubles points = draw_points(random);
    FixedGrid fixed{points[0][0], points[0][1], cells[below(random, 9)]};
    if (below(random, 2)) {  // near the grid
      const double cell = std::stod(fixed.cell);
      for (auto& p : points)
        for (int axis = 0; axis < 2; ++axis)
          p[axis] = (axis ? fixed.y : fixed.x) + cell * 0.5 * double(below(random, 40) - 1);
    }
    if (!std::isfinite(points[0][0])) continue;
    Grid grid;
    grid.kind = Grid::Kind::fixed;
    grid.origin = {fixed.x, fixed.y};
    proof::read_cell(fixed.cell, grid);
    std::vector<std::uint64_t> first;
    for (std::size_t v = 0; v < points.size() && first.empty(); ++v)
      for (int axis = 0; axis < 2 && first.empty(); ++axis) {
        const Integer place = expected_place(points[v][axis], grid, axis);
        if (place < 0 || place > largest) first = {v, std::uint64_t(axis)};
      }
    if (first.empty()) {
      ++fitting;
      check_places(points, choose_grid(points, fixed));
    } else {
      CHECK(indices_of([&] { choose_grid(points, fixed); }, Status::coordinate_outside_grid) == first);
    }
  }
  CHECK(fitting > 500);
}

TEST_CASE("a coordinate that is not finite is named, the least vertex first") {
  for (double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const Doubles points = {{0, 1}, {2, bad}, {bad, 0}};
    const std::vector<std::uint64_t> where = {1, 1};
    CHECK(indices_of([&] { choose_grid(points); }, Status::coordinate_not_finite) == where);
    CHECK(indices_of([&] { choose_grid(points, FixedGrid{}); }, Status::coordinate_not_finite) == where);
  }
}
