// SPDX-License-Identifier: Apache-2.0
// What VTK's XML files of unstructured grids are made of.
#pragma once

#include <cstdint>
#include <type_traits>

#include "base64.hpp"
#include "binary_file.hpp"
#include "output_files.hpp"

#include <gcdt/types.hpp>

namespace gcdt::io {

/// The cell type of a triangle.
constexpr int vtk_triangle = 5;

/// The first lines of a file.
inline std::string vtk_head(const char* type) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n", type,
      little_endian() ? "LittleEndian" : "BigEndian");
}

/// VTK's name of a type of numbers.
template <class T>
const char* type_name() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "UInt8";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "UInt32";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "UInt64";
}

/// An array of `count` numbers of type T, number i being value(i).
template <class T, class Value>
void write_array(OutputFile& file, const std::string& attributes, std::uint64_t count, Value&& value) {
  file.print("<DataArray type=\"{}\" {} format=\"binary\">\n", type_name<T>(), attributes);
  Base64Writer<OutputFile> base64(file);
  const std::uint64_t bytes = count * sizeof(T);
  base64.put(&bytes, sizeof bytes);
  for (std::uint64_t i = 0; i < count; ++i) {
    const T number = static_cast<T>(value(i));
    base64.put(&number, sizeof number);
  }
  base64.finish();
  file.print("\n</DataArray>\n");
}

/// A named array of so few numbers.
template <class T>
void write_field(OutputFile& file, const char* name, std::initializer_list<T> values) {
  write_array<T>(file, fmt::format("Name=\"{}\" NumberOfTuples=\"{}\"", name, values.size()), values.size(),
                 [&](std::uint64_t i) { return values.begin()[i]; });
}

/// The grid as field arrays, so that the file says on which grid it is exact.
inline void write_grid(OutputFile& file, const Grid& grid) {
  file.print("<FieldData>\n");
  write_field<std::int32_t>(file, "gcdt_grid_kind", {static_cast<std::int32_t>(grid.kind)});
  write_field<double>(file, "gcdt_grid_origin", {grid.origin[0], grid.origin[1]});
  write_field<double>(file, "gcdt_grid_cell", {grid.cell()});
  write_field<std::uint64_t>(file, "gcdt_grid_cell_units", {grid.cell_units});
  write_field<std::int32_t>(file, "gcdt_grid_cell_decimals", {grid.cell_decimals});
  write_field<std::int32_t>(file, "gcdt_grid_cell_exponent", {grid.cell_exponent});
  write_field<double>(file, "gcdt_grid_largest_move", {grid.largest_move});
  file.print("</FieldData>\n");
}

}  // namespace gcdt::io
