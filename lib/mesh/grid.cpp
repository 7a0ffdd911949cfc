// SPDX-License-Identifier: Apache-2.0
#include "mesh/grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <sstream>

namespace gcdt {

namespace {

double from_bits(std::uint64_t bits) {
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::uint64_t to_bits(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return device::gcdt_without_negative_zero(bits);
}

// The double nearest to a decimal number, whatever the program's locale; NaN if there is none.
double nearest_double(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value;
  return stream >> value ? value : std::numeric_limits<double>::quiet_NaN();
}

device::Scale make_scale(const std::array<std::uint64_t, 2>& origin, std::uint64_t five, std::uint64_t units_low,
                         std::uint64_t units_high, int k) {
  device::Scale scale = {};
  device::gcdt_make_scale(&scale, origin.data(), five, units_low, units_high, k);
  return scale;
}

// A decimal number: digits * 10^exponent, without zeros at either end of the digits.
struct DecimalText {
  std::string digits;
  long exponent = 0;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// [+] digits [. digits] [e [+-] digits], with a digit before the e; none if `text` is not that.
std::optional<DecimalText> parse_decimal(const std::string& text) {
  DecimalText result;
  std::size_t at = !text.empty() && text[0] == '+' ? 1 : 0;
  bool point = false, digit = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !point)); ++at) {
    if (text[at] == '.') {
      point = true;
      continue;
    }
    digit = true;
    result.digits += text[at];
    if (point) --result.exponent;
  }
  if (!digit) return std::nullopt;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    ++at;
    const bool negative = at < text.size() && text[at] == '-';
    if (at < text.size() && (text[at] == '-' || text[at] == '+')) ++at;
    long exponent = 0;
    const std::size_t first = at;
    for (; at < text.size() && is_digit(text[at]); ++at)
      exponent = std::min(exponent * 10 + (text[at] - '0'), 1000000l);
    if (at == first) return std::nullopt;
    result.exponent += negative ? -exponent : exponent;
  }
  if (at != text.size()) return std::nullopt;
  result.digits.erase(0, std::min(result.digits.find_first_not_of('0'), result.digits.size()));
  while (!result.digits.empty() && result.digits.back() == '0') {
    result.digits.pop_back();
    ++result.exponent;
  }
  return result;
}

[[noreturn]] void bad_cell(const std::string& text, const char* why) {
  throw Error(Status::invalid_argument, "the grid's cell \"" + text.substr(0, 60) + "\" " + why);
}

}  // namespace

Survey survey_of(const std::uint64_t* maxima) {
  Survey result;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    result.least[axis] = device::gcdt_from_ordered(~maxima[2 * axis]);
    result.most[axis] = device::gcdt_from_ordered(maxima[2 * axis + 1]);
  }
  const std::uint64_t trailing = maxima[GCDT_SURVEY_TRAILING];
  if (trailing != 0) result.trailing_exponent = static_cast<int>(~trailing) + GCDT_LEAST_EXPONENT;
  return result;
}

double cell_edge(std::uint64_t units, int decimals, int exponent) {
  if (units == 0) return std::ldexp(1.0, exponent);
  return nearest_double(std::to_string(units) + "e" + std::to_string(-decimals));
}

GridChoice choose_grid(const Survey& survey) {
  GridChoice choice;
  choice.survey = survey;
  ChosenGrid& chosen = choice.grid;
  const device::Cell cell = device::gcdt_choose_cell(survey.least.data(), survey.most.data(),
                                                     survey.trailing_exponent.value_or(0), &chosen.scale);
  chosen.grid.kind = cell.moves ? Grid::Kind::rounded : Grid::Kind::binary;
  chosen.grid.origin = {from_bits(survey.least[0]), from_bits(survey.least[1])};
  chosen.grid.cell_exponent = cell.exponent;
  choice.decimals_limit = cell.decimals_limit;
  return choice;
}

ChosenGrid GridChoice::with_decimals(int digits) const {
  device::Decimals decimals = {};
  if (digits > decimals_limit ||
      !device::gcdt_make_decimals(survey.least.data(), survey.most.data(), digits, &decimals))
    return grid;
  int cell_decimals = digits;
  for (std::uint64_t step = decimals.step; step > 1; step /= 10) ++cell_decimals;
  ChosenGrid chosen;
  chosen.decimals = decimals;
  chosen.grid.kind = Grid::Kind::decimal;
  chosen.grid.origin = {from_bits(survey.least[0]), from_bits(survey.least[1])};
  chosen.grid.cell_units = 1;
  chosen.grid.cell_decimals = cell_decimals;
  return chosen;
}

ChosenGrid fixed_grid(const FixedGrid& given) {
  const std::array<std::uint64_t, 2> origin{to_bits(given.x), to_bits(given.y)};
  for (const std::uint64_t bits : origin)
    if (!device::gcdt_is_finite(bits)) throw Error(Status::invalid_argument, "the grid's origin is not finite");
  const std::optional<DecimalText> text = parse_decimal(given.cell);
  if (!text) bad_cell(given.cell, "is not a positive decimal number");
  if (text->digits.empty()) bad_cell(given.cell, "is zero");
  ChosenGrid chosen;
  chosen.grid.kind = Grid::Kind::fixed;
  chosen.grid.origin = {from_bits(origin[0]), from_bits(origin[1])};
  // Where the double is a power of two, that is meant: outputs write such a cell with 17 digits.
  const std::uint64_t nearest = to_bits(nearest_double(text->digits + "e" + std::to_string(text->exponent)));
  const std::uint64_t m = device::gcdt_mantissa(nearest);
  if (device::gcdt_is_finite(nearest) && m != 0 && (m & (m - 1)) == 0) {
    chosen.grid.cell_exponent = device::gcdt_trailing_exponent(nearest);
    chosen.scale = scale_of(chosen.grid);
    return chosen;
  }
  if (text->digits.size() > 19) bad_cell(given.cell, "has more than 19 significant digits");
  if (text->exponent < -GCDT_MAX_DECIMALS || text->exponent > GCDT_MAX_DECIMALS)
    bad_cell(given.cell, "is not a whole number of 10^-22 to 10^22");
  std::uint64_t& units = chosen.grid.cell_units = std::stoull(text->digits);
  int& decimals = chosen.grid.cell_decimals = -static_cast<int>(text->exponent);
  chosen.scale = scale_of(chosen.grid);
  // The largest product units * 10^-decimals with decimals >= 0 that fits, so that whole cells read as such.
  for (; decimals < 0 && units <= std::numeric_limits<std::uint64_t>::max() / 10; ++decimals) units *= 10;
  return chosen;
}

device::Scale scale_of(const Grid& grid) {
  const std::array<std::uint64_t, 2> origin{to_bits(grid.origin[0]), to_bits(grid.origin[1])};
  if (grid.cell_units == 0) return make_scale(origin, 1, 1, 0, grid.cell_exponent);
  // units 10^-decimals = 2^-decimals (units 5^-decimals), or over 5^decimals.
  const std::uint64_t five = device::gcdt_powers_of_five[std::abs(grid.cell_decimals)];
  if (grid.cell_decimals >= 0) return make_scale(origin, five, grid.cell_units, 0, -grid.cell_decimals);
  return make_scale(origin, 1, grid.cell_units * five, device::gcdt_mul_high(grid.cell_units, five),
                    -grid.cell_decimals);
}

device::Decimals query_decimals(const Grid& grid, const std::optional<device::Decimals>& of_vertices) {
  if (!of_vertices) return {};
  device::Decimals fine = *of_vertices;
  fine.digits = grid.cell_decimals;
  fine.step = 1;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    fine.least[axis] = device::gcdt_decimal_numerator(to_bits(grid.origin[axis]), fine.digits);
    if (fine.least[axis] == static_cast<device::i64>(GCDT_NUMERATOR_OVERFLOW)) return *of_vertices;
  }
  return fine;
}

// The key's number R, in units of the window, is R 2^-offset / five of length.
double move_length(std::uint64_t key, const device::Scale& scale) {
  const int length = static_cast<int>(key >> 56);
  std::uint64_t leading = key & ((1ull << 56) - 1);
  const int shift = length - 56 - scale.offset;
  // A double has 53 digits: of all 56 the last one tells on which side of its middle the number is.
  if (scale.five == 1) return std::ldexp(static_cast<double>(leading), shift);
  const auto five = static_cast<double>(scale.five);
  if (length <= 53) return std::ldexp(static_cast<double>(leading) / five, shift);
  leading = (leading + (leading & 1) + 7) / 8 * 8;  // not below the number, and a double
  const auto above = static_cast<double>(leading);
  const double quotient = above / five;
  return std::ldexp(std::fma(quotient, five, -above) < 0 ? std::nextafter(quotient, above) : quotient, shift);
}

}  // namespace gcdt
