// SPDX-License-Identifier: Apache-2.0
// The bar that says how long things in a picture are.
#pragma once

#include "canvas.hpp"

typedef struct _cairo cairo_t;

namespace gcdt::io {

/// Draws a bar from the left, `y` units down, within `height`; nothing where the canvas has no unit. Its length in the
/// input's units is 1, 2 or 5 times a power of ten, and stands beside it. Digits are lines: pictures need no fonts.
void draw_scale(cairo_t* pen, const Canvas& canvas, double y, double height);

}  // namespace gcdt::io
