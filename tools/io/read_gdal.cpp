// SPDX-License-Identifier: Apache-2.0
// What GDAL's vector drivers open. Without GDAL: that it is not there.
#include <fmt/format.h>

#include "geometries.hpp"
#include "inputs.hpp"
#include "paths.hpp"

namespace gcdt::io {

Input read_with_gdal(const std::string& path) {
  throw Failure(Exit::usage, fmt::format("{}: {} files are read by GDAL, which this gcdt is built without (CMake: "
                                         "-DGCDT_GDAL=ON, package libgdal-dev)",
                                         path, lower_extension(path)));
}

}  // namespace gcdt::io
