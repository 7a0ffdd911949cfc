// SPDX-License-Identifier: Apache-2.0
// The regions of a picture, filled.
#pragma once

#include "output_files.hpp"
#include "svg_canvas.hpp"

#include <gcdt/gcdt.hpp>

namespace gcdt::io {

/// Fills the triangles of `mesh`, which has regions: regions that share an edge in different colours, as long as those
/// suffice; one path a colour, along the borders of its regions only.
void fill_regions(OutputFile& file, const Canvas& canvas, const Triangulation& mesh);

}  // namespace gcdt::io
