// SPDX-License-Identifier: Apache-2.0
// The shortest decimals that doubles stand for, and the cell of a fixed grid read from its text.
#include <algorithm>
#include <limits>
#include <locale>
#include <sstream>

#include "proof/grid.hpp"

namespace gcdt::proof {

namespace {

/// A positive decimal number without leading or trailing zeros: digits * 10^exponent.
struct Spelled {
  std::string digits;
  int exponent = 0;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The part after 'e': an optional sign and digits, up to the end of the text; at most a million in size.
std::optional<int> read_exponent(const std::string& text, std::size_t i) {
  const bool negative = i < text.size() && text[i] == '-';
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
  if (i == text.size()) return std::nullopt;
  int value = 0;
  for (; i < text.size(); ++i) {
    if (!is_digit(text[i])) return std::nullopt;
    value = std::min(10 * value + (text[i] - '0'), 1000000);
  }
  return negative ? -value : value;
}

std::optional<Spelled> read_decimal(const std::string& text) {
  Spelled number;
  std::size_t i = !text.empty() && text[0] == '+' ? 1 : 0;
  bool point = false, any = false;
  for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !point)); ++i) {
    if (text[i] == '.') {
      point = true;
      continue;
    }
    any = true;
    number.exponent -= point;
    if (!number.digits.empty() || text[i] != '0') number.digits += text[i];
  }
  if (!any) return std::nullopt;
  if (i < text.size()) {
    if (text[i] != 'e' && text[i] != 'E') return std::nullopt;
    const auto exponent = read_exponent(text, i + 1);
    if (!exponent) return std::nullopt;
    number.exponent += *exponent;
  }
  while (!number.digits.empty() && number.digits.back() == '0') {
    number.digits.pop_back();
    ++number.exponent;
  }
  if (number.digits.empty()) return std::nullopt;
  return number;
}

/// The k for which 2^k is the double nearest to the number that `text` spells, if there is one.
std::optional<int> nearest_power_of_two(const std::string& text) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0;
  if (!(in >> value) || !is_finite(value)) return std::nullopt;
  const Dyadic d = dyadic(value);
  if (d.mantissa == 0 || (d.mantissa & (d.mantissa - 1)) != 0) return std::nullopt;
  return d.exponent + bit_length(d.mantissa) - 1;
}

}  // namespace

bool is_finite(double v) { return v - v == 0; }

std::uint64_t power_of_five(int exponent) {
  std::uint64_t power = 1;
  for (int i = 0; i < exponent; ++i) power *= 5;
  return power;
}

// With v = m 2^e, e < 0, and s = -(e + d): v 10^d = m 5^d / 2^s. The doubles nearest to which is v are those
// within half a unit 2^e of m, so N / 10^d is one iff |N 2^s - m 5^d| < 5^d / 2 (which is not an integer: no ties).
// Below a power of two (m = 2^52) the unit is half as large; there the nearest N is still the only one that
// needs a test: for another to do, 10^-d would have to be below 2^-52 v, but 2^-k is itself a decimal with k
// digits, which leaves d < k, and d > 15.6 + 0.3 k then contradicts d <= 22.
std::optional<Decimal> shortest_decimal(double v) {
  const Dyadic x = dyadic(v);
  if (x.mantissa == 0) return Decimal{};
  auto result = [&](UWide units, int decimals) -> std::optional<Decimal> {
    if (bit_length(units) > 63) return std::nullopt;
    const auto magnitude = static_cast<std::int64_t>(units);
    return Decimal{x.negative ? -magnitude : magnitude, decimals};
  };
  if (x.exponent >= 0) return x.exponent > 63 ? std::nullopt : result(UWide(x.mantissa) << x.exponent, 0);
  std::uint64_t five = 1;
  for (int d = 0; d <= max_decimals; ++d, five *= 5) {
    const UWide product = UWide(x.mantissa) * five;  // < 2^105
    const int s = -(x.exponent + d);
    if (s <= 0) return result(product << -s, d);
    if (s >= 107) continue;  // v 10^d < 1/4: the nearest integer is 0, and v is not
    const UWide below = product & ((UWide(1) << s) - 1), half = UWide(1) << (s - 1);
    UWide nearest = product >> s;
    const bool up = below > half || (below == half && (nearest & 1));
    nearest += up;
    if (bit_length(nearest) > 63) return std::nullopt;  // and more so with more digits
    UWide twice = 2 * (up ? (UWide(1) << s) - below : below);
    if (!up && x.mantissa == 1ull << 52) twice *= 2;
    if (twice < five) return result(nearest, d);
  }
  return std::nullopt;
}

std::optional<Wide> in_units(double v, int decimals) {
  const auto number = shortest_decimal(v);
  if (!number || number->decimals > decimals) return std::nullopt;
  const int zeros = decimals - number->decimals;
  const auto magnitude = static_cast<std::uint64_t>(number->units < 0 ? -number->units : number->units);
  const UWide scaled = UWide(magnitude) * power_of_five(zeros);  // < 2^115
  if (bit_length(scaled) + zeros > 126) return std::nullopt;     // on a decimal grid it is below 2^95
  const auto value = static_cast<Wide>(scaled << zeros);
  return number->units < 0 ? -value : value;
}

void read_cell(const std::string& text, Grid& grid) {
  auto reject = [&](const char* why) {
    throw Error(Status::invalid_argument, "the grid's cell '" + text + "' " + why);
  };
  const auto number = read_decimal(text);
  if (!number) reject("is not a positive decimal number");
  grid.cell_units = 0;
  grid.cell_decimals = grid.cell_exponent = 0;
  if (const auto power = nearest_power_of_two(text)) {
    grid.cell_exponent = *power;
    return;
  }
  if (number->digits.size() > 19) reject("has more than 19 significant digits");
  if (number->exponent < -max_decimals || number->exponent > max_decimals) reject("is too small or too large");
  for (char digit : number->digits) grid.cell_units = 10 * grid.cell_units + static_cast<std::uint64_t>(digit - '0');
  grid.cell_decimals = -number->exponent;
  while (grid.cell_decimals < 0 && grid.cell_units <= std::numeric_limits<std::uint64_t>::max() / 10) {
    grid.cell_units *= 10;
    ++grid.cell_decimals;
  }
}

Cell cell_of(const Grid& grid) {
  if (grid.cell_units == 0) return {1, grid.cell_exponent, 0};
  return {grid.cell_units, -grid.cell_decimals, -grid.cell_decimals};
}

}  // namespace gcdt::proof
