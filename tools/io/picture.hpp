// SPDX-License-Identifier: Apache-2.0
// Pictures by cairo (.png, .pdf): regions coloured, triangles thin, constraints bold, a bar for the scale.
#pragma once

#include "triangle_files.hpp"

namespace gcdt::io {

/// Draws what .svg shows, and below it a bar with its length in the input's units. Where edges are many, those of a few
/// pixels are not drawn one by one but as the shade that they give: ten million triangles take seconds. The same bytes
/// in each run with one version of cairo; the date of a .pdf is always the same.
void write_png(OutputFile& file, const Result& result);
void write_pdf(OutputFile& file, const Result& result);

}  // namespace gcdt::io
