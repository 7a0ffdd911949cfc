// SPDX-License-Identifier: Apache-2.0
// GeoJSON (RFC 7946) as a planar straight-line graph.
#pragma once

#include "triangle_files.hpp"

namespace gcdt::io {

/// Reads all geometries of a .geojson or .json file: positions become vertices, their third numbers (heights) an
/// attribute, if all have one; lines and rings become constraints. A ring's last position, which repeats its first, is
/// left out. Outer rings are directed counter-clockwise and holes clockwise, whatever the file does. A file that is an
/// array holds positions, which are a ring, or such rings, which are a polygon, or such polygons.
/// Throws Failure (Exit::input).
Input read_geojson(const std::string& path);

/// Whether the extension is that of a file with a GeoJSON text in each line: .geojsonl, .ndjson, or .geojsons
/// (RFC 8142, texts of one line each).
bool is_line_file(const std::string& path);

struct TextLine {
  std::size_t number;  ///< in the file, from 1
  std::string text;    ///< without a leading record separator
};
/// The lines that are not blank. Throws Failure (Exit::input).
std::vector<TextLine> lines_of(const std::string& path);

/// Reads a line as read_geojson reads a file; messages name PATH:LINE.
Input read_geojson_line(const std::string& path, const TextLine& line);

}  // namespace gcdt::io
