// SPDX-License-Identifier: Apache-2.0
// The input formats by extension.
#pragma once

#include <string>
#include <vector>

#include "triangle_files.hpp"

namespace gcdt::io {

struct InputFormat {
  const char* extension;  ///< in lower case, with its dot
  Input (*read)(const std::string& path);
  bool in_folders;  ///< `gcdt batch FOLDER` takes files of this kind; of one name the first kind in the table
};

/// All formats that read_input() takes.
const std::vector<InputFormat>& input_formats();

/// Their extensions, separated by blanks.
std::string input_extensions();

/// An input of one file, with nothing in it yet.
inline Input input_of(const std::string& path) {
  Input input;
  input.files = {path};
  input.vertex_file = input.constraint_file = path;
  return input;
}

// All of these throw Failure (Exit::input) with FILE:LINE or the byte.

/// .poly and .node; "-" is a .poly on standard input.
Input read_triangle_file(const std::string& path);
/// .pslg: vertices and segments, binary.
Input read_pslg(const std::string& path);
/// .npy: the vertices, an array of two columns; further columns are attributes.
Input read_npy(const std::string& path);
/// .npz: arrays by the names that the Python package `triangle` has for them.
Input read_npz(const std::string& path);
/// .wkt: geometries as text, as many as there are.
Input read_wkt(const std::string& path);
/// .wkb: geometries in binary, as many as there are, or these in hexadecimal digits.
Input read_wkb(const std::string& path);
/// .csv: a point in each line.
Input read_csv(const std::string& path);
/// .txt: what artem-ogre/CDT reads: two counts, the vertices, the edges.
Input read_cdt_text(const std::string& path);
/// .obj and .off: the edges of faces, and lines.
Input read_obj(const std::string& path);
Input read_off(const std::string& path);
/// .ply: the edges of faces, and edges; ascii or binary.
Input read_ply(const std::string& path);
/// What GDAL's vector drivers open (docs/command.md). Without GDAL: throws Failure (Exit::usage), which says so.
Input read_with_gdal(const std::string& path);

}  // namespace gcdt::io
