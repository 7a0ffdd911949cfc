// SPDX-License-Identifier: Apache-2.0
// GeoJSON (RFC 7946) as a planar straight-line graph.
#pragma once

#include "triangle_files.hpp"

namespace gcdt::io {

/// Reads all geometries of a .geojson or .json file: positions become vertices, their third numbers (heights) an
/// attribute, if all have one; lines and rings become constraints. A ring's last position, which repeats its first, is
/// left out. Outer rings are directed counter-clockwise and holes clockwise, whatever the file does.
/// Throws Failure (Exit::input).
Input read_geojson(const std::string& path);

}  // namespace gcdt::io
