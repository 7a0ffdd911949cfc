// SPDX-License-Identifier: Apache-2.0
// gcdt raster: an attribute of the vertices on a grid of square cells.
#include "io/raster.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/paths.hpp"
#include "progress.hpp"
#include "solved.hpp"

namespace gcdt::command {

namespace {

using io::Exit;
using io::Failure;

constexpr std::uint64_t default_side = 1024;                  // cells of the longer side
constexpr std::uint64_t most_cells = std::uint64_t{1} << 31;  // 8 GiB of values
constexpr std::uint64_t most_columns = 1000000;               // what libpng takes by default
constexpr std::uint64_t points_at_once = 1 << 20;

/// All paths that will be written.
std::vector<std::string> written_paths(const RasterArguments& arguments) {
  std::vector<std::string> all;
  for (const std::string& path : arguments.outputs) {
    const auto paths = io::raster_paths(path);
    if (paths.empty())
      throw Failure(Exit::usage, fmt::format("{}: unknown raster format; there are .asc .flt .png", path));
    all.insert(all.end(), paths.begin(), paths.end());
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (io::same_file(all[i], all[j])) throw Failure(Exit::usage, fmt::format("{}: would be written twice", all[i]));
  return all;
}

void check_overwrites(const std::vector<std::string>& paths, const std::vector<std::string>& inputs) {
  for (const std::string& path : paths)
    for (const std::string& input : inputs)
      if (input != "-" && io::same_file(path, input))
        throw Failure(Exit::usage, fmt::format("{}: is an input, and cannot be an output", path));
}

void check_numbers(const RasterArguments& arguments) {
  if (arguments.cell && !(*arguments.cell > 0 && std::isfinite(*arguments.cell)))
    throw Failure(Exit::usage, fmt::format("--cell {}: must be positive and finite", *arguments.cell));
  // Files say once what stands for no value: it must be what the cells have.
  const double no_data = arguments.no_data;
  if (!std::isnan(no_data) && static_cast<double>(static_cast<float>(no_data)) != no_data)
    throw Failure(Exit::usage, fmt::format("--no-data {}: not a number of float32", no_data));
}

/// The cells that cover all vertices, from their least corner on.
io::Raster frame(const io::Input& input, const std::optional<double>& cell) {
  if (input.vertices.empty()) throw Failure(Exit::input, fmt::format("{}: no vertices, no raster", input.vertex_file));
  std::array<double, 2> least = input.vertices[0], most = least;
  for (const auto& v : input.vertices)
    for (int axis = 0; axis < 2; ++axis) {
      least[axis] = std::min(least[axis], v[axis]);
      most[axis] = std::max(most[axis], v[axis]);
    }
  const double width = most[0] - least[0], height = most[1] - least[1];
  if (!std::isfinite(width) || !std::isfinite(height))
    throw Failure(Exit::input, fmt::format("{}: the extent is no finite double, no raster", input.vertex_file));
  io::Raster raster;
  raster.west = least[0];
  raster.south = least[1];
  raster.cell = cell ? *cell : std::max(width, height) / default_side;
  if (!(raster.cell > 0)) raster.cell = 1;
  const double columns = std::max(1.0, std::ceil(width / raster.cell)),
               rows = std::max(1.0, std::ceil(height / raster.cell));
  if (!(columns <= most_columns && rows <= most_columns && columns * rows <= static_cast<double>(most_cells)))
    throw Failure(Exit::usage, fmt::format("--cell {}: {} x {} cells are too many", raster.cell, columns, rows));
  raster.columns = static_cast<std::uint64_t>(columns);
  raster.rows = static_cast<std::uint64_t>(rows);
  return raster;
}

/// A value as it is written. Throws Failure (Exit::input) for a finite one that is none there.
float narrowed(double value) {
  const auto narrow = static_cast<float>(value);
  if (std::isinf(narrow) && std::isfinite(value))
    throw Failure(Exit::input, fmt::format("a value of the attribute is too large for float32: {}", value));
  return narrow;
}

void fill(io::Raster& raster, const Solved& mesh, const std::vector<double>& values) {
  raster.values.resize(raster.columns * raster.rows);
  const std::uint64_t rows_at_once = std::max<std::uint64_t>(1, points_at_once / raster.columns);
  std::vector<std::array<double, 2>> points;
  for (std::uint64_t first = 0; first < raster.rows; first += rows_at_once) {
    stop_if_interrupted();
    points.clear();
    for (std::uint64_t row = first; row < std::min(first + rows_at_once, raster.rows); ++row)
      for (std::uint64_t column = 0; column < raster.columns; ++column)
        points.push_back({io::middle_x(raster, column), io::middle_y(raster, row)});
    const auto found = mesh.result->interpolate(points, values, raster.no_data);
    std::transform(found.begin(), found.end(),
                   raster.values.begin() + static_cast<std::ptrdiff_t>(first * raster.columns), narrowed);
  }
}

}  // namespace

void raster(const RasterArguments& arguments) {
  const auto paths = written_paths(arguments);
  check_overwrites(paths, {arguments.mesh.input});
  check_numbers(arguments);
  const Solved mesh = solved(arguments.mesh);
  check_overwrites(paths, mesh.input.files);
  const std::uint32_t count = mesh.input.attribute_count;
  if (arguments.attribute < 1 || arguments.attribute > count)
    throw Failure(Exit::usage, fmt::format("--attribute {}: {} has {} attributes a vertex", arguments.attribute,
                                           mesh.input.vertex_file, count));
  io::Raster raster = frame(mesh.input, arguments.cell);
  raster.no_data = arguments.no_data;
  fill(raster, mesh, mesh.attribute(arguments.attribute - 1));
  io::OutputFiles files(stop_if_interrupted);
  for (const std::string& path : arguments.outputs) io::write_raster(files, path, raster);
  stop_if_interrupted();
  files.commit();
}

}  // namespace gcdt::command
