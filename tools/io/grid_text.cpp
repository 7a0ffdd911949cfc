// SPDX-License-Identifier: Apache-2.0
#include "grid_text.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <charconv>
#include <sstream>
#include <string_view>

namespace gcdt::io {

namespace {

/// No cell of a grid of doubles lies beyond: 2^-1074 to 2^1023, 10^-324 to 10^308.
constexpr int widest_exponent = 1100;

template <class T>
bool read_whole(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool read_finite(std::string_view text, double& value) {
  const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value - value == 0;
}

bool read_kind(std::string_view text, Grid& grid) {
  for (auto kind : {Grid::Kind::binary, Grid::Kind::decimal, Grid::Kind::rounded, Grid::Kind::fixed})
    if (text == kind_name(kind)) {
      grid.kind = kind;
      return true;
    }
  return false;
}

bool read_origin(std::string_view text, Grid& grid) {
  const std::size_t comma = text.find(',');
  return comma != std::string_view::npos && read_finite(text.substr(0, comma), grid.origin[0]) &&
         read_finite(text.substr(comma + 1), grid.origin[1]);
}

bool read_cell(std::string_view text, Grid& grid) {
  auto in_range = [](int exponent) { return exponent >= -widest_exponent && exponent <= widest_exponent; };
  if (text.substr(0, 2) == "2^") {
    grid.cell_units = 0;
    return read_whole(text.substr(2), grid.cell_exponent) && in_range(grid.cell_exponent);
  }
  const std::size_t e = text.find('e');
  int exponent = 0;
  if (e == std::string_view::npos || !read_whole(text.substr(0, e), grid.cell_units) ||
      !read_whole(text.substr(e + 1), exponent))
    return false;
  grid.cell_decimals = -exponent;
  return grid.cell_units > 0 && in_range(exponent);
}

}  // namespace

const char* kind_name(Grid::Kind kind) {
  switch (kind) {
    case Grid::Kind::binary: return "binary";
    case Grid::Kind::decimal: return "decimal";
    case Grid::Kind::rounded: return "rounded";
    default: return "fixed";
  }
}

std::string cell_text(const Grid& grid) {
  return grid.cell_units > 0 ? fmt::format("{}e{}", grid.cell_units, -grid.cell_decimals)
                             : fmt::format("2^{}", grid.cell_exponent);
}

std::string to_text(const Grid& grid) {
  return fmt::format("kind={} origin={},{} cell={} largest_move={}", kind_name(grid.kind), grid.origin[0],
                     grid.origin[1], cell_text(grid), grid.largest_move);
}

std::optional<Grid> grid_from_text(const std::string& text) {
  Grid grid;
  bool kind = false, origin = false, cell = false;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) return std::nullopt;
    const std::string_view name = std::string_view(word).substr(0, equals),
                           value = std::string_view(word).substr(equals + 1);
    if (name == "kind" && !(kind = read_kind(value, grid))) return std::nullopt;
    if (name == "origin" && !(origin = read_origin(value, grid))) return std::nullopt;
    if (name == "cell" && !(cell = read_cell(value, grid))) return std::nullopt;
    if (name == "largest_move" && !read_finite(value, grid.largest_move)) return std::nullopt;
  }
  if (!kind || !origin || !cell) return std::nullopt;
  return grid;
}

}  // namespace gcdt::io
