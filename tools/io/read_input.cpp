// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "geojson.hpp"
#include "inputs.hpp"
#include "paths.hpp"

namespace gcdt::io {

const std::vector<InputFormat>& input_formats() {
  static const std::vector<InputFormat> formats = {
      {".poly", read_triangle_file, true},
      {".node", read_triangle_file, true},
      {".geojson", read_geojson, true},
      {".json", read_geojson, false},
      {".pslg", read_pslg, true},
      {".npz", read_npz, false},
      {".npy", read_npy, false},
      {".wkt", read_wkt, true},
      {".wkb", read_wkb, true},
      {".csv", read_csv, false},
      {".txt", read_cdt_text, false},
      {".obj", read_obj, false},
      {".off", read_off, false},
      {".ply", read_ply, false},
      {".shp", read_with_gdal, false},
      {".gpkg", read_with_gdal, false},
      {".fgb", read_with_gdal, false},
      {".dxf", read_with_gdal, false},
  };
  return formats;
}

std::string input_extensions() {
  std::string all;
  for (const InputFormat& format : input_formats()) all += (all.empty() ? "" : " ") + std::string(format.extension);
  return all;
}

Input read_input(const std::string& path) {
  if (path == "-") return read_triangle_file(path);
  const std::string extension = lower_extension(path);
  for (const InputFormat& format : input_formats())
    if (extension == format.extension) return format.read(path);
  throw Failure(Exit::usage, fmt::format("{}: unknown input format; there are {}, and - for a .poly on standard input",
                                         path, input_extensions()));
}

}  // namespace gcdt::io
