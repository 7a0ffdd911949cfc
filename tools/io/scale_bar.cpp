// SPDX-License-Identifier: Apache-2.0
#include "scale_bar.hpp"

#include <cairo.h>
#include <fmt/format.h>

namespace gcdt::io {

namespace {

constexpr double largest_share = 0.25;  // of the longer side, that the bar takes at most

/// A character as strokes between points of a field 4 wide and 6 high: pairs of digits, x and y from the upper left,
/// and a blank between strokes.
std::string_view strokes_of(char c) {
  switch (c) {
    case '0': return "0040460600";
    case '1': return "112026";
    case '2': return "004043030646";
    case '3': return "00404606 0343";
    case '4': return "000343 4046";
    case '5': return "400003434606";
    case '6': return "400006464303";
    case '7': return "004016";
    case '8': return "0040460600 0343";
    case '9': return "434000034346";
    case '.': return "1616";
    case 'e': return "034342020646";
    case '+': return "1353 3215";
    default: return "0343";  // -
  }
}

}  // namespace

void draw_text(cairo_t* pen, std::string_view text, double x, double y, double height) {
  const double unit = height / 6;
  for (const char c : text) {
    bool begin = true;
    const std::string_view strokes = strokes_of(c);
    for (std::size_t i = 0; i < strokes.size();) {
      if (strokes[i] == ' ') {
        begin = true;
        ++i;
        continue;
      }
      const double px = x + unit * (strokes[i] - '0'), py = y + unit * (strokes[i + 1] - '0');
      begin ? cairo_move_to(pen, px, py) : cairo_line_to(pen, px, py);
      begin = false;
      i += 2;
    }
    x += (c == '.' ? 3 : 6) * unit;
  }
  cairo_set_line_width(pen, unit * 0.8);
  cairo_stroke(pen);
}

std::optional<ScaleBar> ScaleBar::of(const Canvas& canvas) {
  const double room = largest_share * std::max(canvas.width, Canvas::longer_side / 4) * canvas.unit;
  if (!(room > 0) || !std::isfinite(room) || !std::isnormal(room)) return std::nullopt;
  double length = std::pow(10, std::floor(std::log10(room)));
  for (const double factor : {5., 2.})
    if (length * factor <= room) {
      length *= factor;
      break;
    }
  return ScaleBar{length / canvas.unit, fmt::format("{:.3g}", length)};
}

void draw_scale(cairo_t* pen, const Canvas& canvas, double y, double height) {
  const std::optional<ScaleBar> bar = ScaleBar::of(canvas);
  if (!bar) return;
  const double across = bar->across, tick = height / 3, middle = y + height / 2;
  cairo_set_source_rgb(pen, 0, 0, 0);
  cairo_set_line_width(pen, height / 16);
  cairo_move_to(pen, 0, middle - tick / 2);
  cairo_line_to(pen, 0, middle + tick / 2);
  cairo_move_to(pen, 0, middle);
  cairo_line_to(pen, across, middle);
  cairo_move_to(pen, across, middle - tick / 2);
  cairo_line_to(pen, across, middle + tick / 2);
  cairo_stroke(pen);
  draw_text(pen, bar->length, across + height / 2, middle - height / 4, height / 2);
}

}  // namespace gcdt::io
