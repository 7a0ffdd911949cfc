// SPDX-License-Identifier: Apache-2.0
// The bar that says how long things in a picture are.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "canvas.hpp"

typedef struct _cairo cairo_t;

namespace gcdt::io {

/// The bar of a canvas: its length in the input's units is 1, 2 or 5 times a power of ten, and stands beside it.
struct ScaleBar {
  static constexpr double high = 0.03 * Canvas::longer_side;  ///< of all that is drawn for it

  double across = 0;  ///< in units of the canvas
  std::string length;

  /// None where the canvas has no unit.
  static std::optional<ScaleBar> of(const Canvas& canvas);
};

/// Draws it from the left, `y` units down, within `height`. Digits are lines: pictures need no fonts.
void draw_scale(cairo_t* pen, const Canvas& canvas, double y, double height);

/// Draws digits and the like, so high, with their upper left corner there.
void draw_text(cairo_t* pen, std::string_view text, double x, double y, double height);
/// How wide digits are then.
inline double text_width(std::string_view digits, double height) {
  return (static_cast<double>(digits.size()) - 1.0 / 3) * height;
}

}  // namespace gcdt::io
