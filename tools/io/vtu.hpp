// SPDX-License-Identifier: Apache-2.0
// VTK's unstructured grids (.vtu), as ParaView reads them.
#pragma once

#include <string>

#include "triangle_files.hpp"

namespace gcdt::io {

/// Points (z = 0; all input vertices, numbered from 0) and triangles, with the cell arrays
/// `constrained` (bit k: the edge across from corner k) and `neighbours` (-1: none), with regions also `region`,
/// `depth`, `winding` and `region_attribute`; the input's attributes and markers as point arrays; the grid as
/// field arrays `gcdt_grid_*`. Inline base64, headers of 64 bits, not compressed.
void write_vtu(OutputFile& file, const Result& result);

/// Reads a mesh of triangles back: inline arrays, base64 or ascii, not compressed.
/// Throws Failure: Exit::input, or Exit::check for a vertex or neighbour that does not exist.
MeshFile read_vtu(const std::string& path);

}  // namespace gcdt::io
