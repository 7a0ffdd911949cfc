// SPDX-License-Identifier: Apache-2.0
// Pictures (.svg): triangles thin, constraints bold, y up.
#pragma once

#include "triangle_files.hpp"

namespace gcdt::io {

/// Draws every edge once, on a canvas whose longer side is 10^5 units; coordinates are rounded to a unit.
/// Without triangles it draws the constraints and the vertices as dots.
void write_svg(OutputFile& file, const Result& result);

}  // namespace gcdt::io
