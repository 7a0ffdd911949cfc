// SPDX-License-Identifier: Apache-2.0
#include "raster.hpp"

#include <png.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

#include "paths.hpp"

namespace gcdt::io {

namespace {

std::string beside(const std::string& path, const char* extension) {
  return std::filesystem::path(path).replace_extension(extension).string();
}

/// `.png` to `.pgw`: the first and last letter and a w.
std::string world_extension(const std::string& extension) {
  return std::string(".") + extension[1] + extension.back() + "w";
}

/// The affine map from column and row to the middles of cells.
void write_world(OutputFile& file, const Raster& raster) {
  file.print("{}\n0\n0\n{}\n{}\n{}\n", raster.cell, -raster.cell, middle_x(raster, 0), middle_y(raster, 0));
}

void write_header(OutputFile& file, const Raster& raster) {
  file.print("ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value {}\n", raster.columns,
             raster.rows, raster.west, raster.south, raster.cell, raster.no_data);
}

void write_asc(OutputFile& file, const Raster& raster) {
  write_header(file, raster);
  for (std::uint64_t i = 0; i < raster.values.size(); ++i)
    file.print("{}{}", raster.values[i], (i + 1) % raster.columns == 0 ? "\n" : " ");
}

void write_flt(OutputFile& file, const Raster& raster) {
  for (const float value : raster.values) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    char bytes[4];
    for (int i = 0; i < 4; ++i) bytes[i] = static_cast<char>(bits >> 8 * i & 0xff);
    file.write({bytes, 4});
  }
}

/// Grey and opacity of each cell.
std::vector<png_byte> grey_of(const Raster& raster) {
  const auto none = static_cast<float>(raster.no_data);
  float least = 0, most = 0;
  bool any = false;
  for (const float value : raster.values) {
    if (value == none) continue;
    least = any ? std::min(least, value) : value;
    most = any ? std::max(most, value) : value;
    any = true;
  }
  std::vector<png_byte> pixels(2 * raster.values.size());
  for (std::size_t i = 0; i < raster.values.size(); ++i) {
    const float value = raster.values[i];
    if (value == none) continue;
    const double share = most > least ? (double{value} - least) / (double{most} - least) : 0.5;
    pixels[2 * i] = static_cast<png_byte>(255 * share + 0.5);
    pixels[2 * i + 1] = 255;
  }
  return pixels;
}

/// By libpng's interface of one call, which neither throws nor leaves by longjmp.
void write_png(OutputFile& file, const Raster& raster) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(raster.columns);
  image.height = static_cast<png_uint_32>(raster.rows);
  image.format = PNG_FORMAT_GA;
  const std::vector<png_byte> pixels = grey_of(raster);
  std::string bytes;
  auto write = [&](void* to, png_alloc_size_t& size) {
    if (!png_image_write_to_memory(&image, to, &size, 0, pixels.data(), 0, nullptr))
      throw Failure(Exit::output, std::string("libpng: ") + image.message);
  };
  png_alloc_size_t size = 0;
  write(nullptr, size);
  bytes.resize(size);
  write(bytes.data(), size);
  file.write({bytes.data(), size});
}

}  // namespace

std::vector<std::string> raster_paths(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (extension != ".asc" && extension != ".flt" && extension != ".png") return {};
  std::vector<std::string> paths{path, beside(path, world_extension(extension).c_str())};
  if (extension == ".flt") paths.push_back(beside(path, ".hdr"));
  return paths;
}

void write_raster(OutputFiles& files, const std::string& path, const Raster& raster) {
  const std::string extension = lower_extension(path);
  OutputFile& file = files.add(path);
  if (extension == ".asc") write_asc(file, raster);
  if (extension == ".flt") write_flt(file, raster);
  if (extension == ".png") write_png(file, raster);
  const auto paths = raster_paths(path);
  write_world(files.add(paths.at(1)), raster);
  if (extension != ".flt") return;
  OutputFile& header = files.add(paths.at(2));
  write_header(header, raster);
  header.write("byteorder LSBFIRST\n");
}

}  // namespace gcdt::io
