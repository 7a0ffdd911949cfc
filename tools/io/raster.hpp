// SPDX-License-Identifier: Apache-2.0
// Rasters: grids of numbers with a place on the ground, as text (.asc), binary (.flt) and picture (.png).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "output_files.hpp"

namespace gcdt::io {

/// Rows from north to south, square cells; the value of a cell is that at its middle.
struct Raster {
  std::uint64_t columns = 0, rows = 0;
  double west = 0, south = 0, cell = 1;  ///< the outer corner of the first cell of the last row; the edge of a cell
  double no_data = -9999;                ///< the value of cells without one
  std::vector<float> values;             ///< rows * columns
};

/// The middle of a cell; rows count from the north.
inline double middle_x(const Raster& raster, std::uint64_t column) {
  return raster.west + (static_cast<double>(column) + 0.5) * raster.cell;
}
inline double middle_y(const Raster& raster, std::uint64_t row) {
  return raster.south + (static_cast<double>(raster.rows - row) - 0.5) * raster.cell;
}

/// Writes `path` by its extension and the files that belong to it: .asc (Arc/Info ASCII grid) and .flt (float32, little
/// endian, with a .hdr); .png (8 bits of grey from the least value, black, to the largest, white, and transparent where
/// there is none); each with a world file beside it (.acw, .ftw, .pgw). Throws Failure (Exit::output).
void write_raster(OutputFiles& files, const std::string& path, const Raster& raster);

/// The paths that write_raster() writes; none for an unknown extension.
std::vector<std::string> raster_paths(const std::string& path);

}  // namespace gcdt::io
