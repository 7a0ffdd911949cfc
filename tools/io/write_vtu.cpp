// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <type_traits>

#include "base64.hpp"
#include "binary_file.hpp"
#include "vtu.hpp"

namespace gcdt::io {

namespace {

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

template <class T>
void write_field(OutputFile& file, const char* name, std::initializer_list<T> values) {
  write_array<T>(file, fmt::format("Name=\"{}\" NumberOfTuples=\"{}\"", name, values.size()), values.size(),
                 [&](std::uint64_t i) { return values.begin()[i]; });
}

void write_grid(OutputFile& file, const Grid& grid) {
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

void write_regions(OutputFile& file, const Result& result) {
  const Triangulation& mesh = result.mesh;
  const std::uint64_t count = mesh.triangles.size();
  write_array<std::uint32_t>(file, "Name=\"region\"", count, [&](std::uint64_t i) { return mesh.region[i]; });
  write_array<std::uint32_t>(file, "Name=\"depth\"", count, [&](std::uint64_t i) { return mesh.depth[i]; });
  write_array<std::int32_t>(file, "Name=\"winding\"", count, [&](std::uint64_t i) { return mesh.winding[i]; });
  if (result.input.regions.empty() || mesh.region_seed.empty()) return;  // batches have no seeds
  write_array<double>(file, "Name=\"region_attribute\"", count, [&](std::uint64_t i) {
    return mesh.region_seed[i] < 0 ? 0.0 : result.input.regions[mesh.region_seed[i]].attribute;
  });
}

/// Attributes and markers of the vertices.
void write_point_data(OutputFile& file, const Result& result) {
  const Input& input = result.input;
  if (input.attribute_count == 0 && input.vertex_markers.empty()) return;
  file.print("<PointData>\n");
  for (std::uint64_t k = 0; k < input.attribute_count; ++k)
    write_array<double>(file, fmt::format("Name=\"attribute_{}\"", k), result.vertex_count(),
                        [&](std::uint64_t i) { return result.attribute(i, k); });
  if (!input.vertex_markers.empty())
    write_array<std::int32_t>(file, "Name=\"marker\"", result.vertex_count(),
                              [&](std::uint64_t i) { return result.vertex_marker(i); });
  file.print("</PointData>\n");
}

}  // namespace

void write_vtu(OutputFile& file, const Result& result) {
  const std::uint64_t vertices = result.vertex_count();
  const Triangulation& mesh = result.mesh;
  const std::uint64_t triangles = mesh.triangles.size();
  constexpr int vtk_triangle = 5;
  file.print(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n",
      little_endian() ? "LittleEndian" : "BigEndian");
  write_grid(file, mesh.statistics.grid);
  file.print("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n", vertices, triangles);
  write_array<double>(file, "Name=\"Points\" NumberOfComponents=\"3\"", 3 * vertices,
                      [&](std::uint64_t i) { return i % 3 < 2 ? result.vertex(i / 3)[i % 3] : 0.0; });
  file.print("</Points>\n");
  write_point_data(file, result);
  file.print("<Cells>\n");
  write_array<std::int32_t>(file, "Name=\"connectivity\"", 3 * triangles,
                            [&](std::uint64_t i) { return mesh.triangles[i / 3][i % 3]; });
  write_array<std::int64_t>(file, "Name=\"offsets\"", triangles, [](std::uint64_t i) { return 3 * (i + 1); });
  write_array<std::uint8_t>(file, "Name=\"types\"", triangles, [](std::uint64_t) { return vtk_triangle; });
  file.print("</Cells>\n<CellData>\n");
  write_array<std::uint8_t>(file, "Name=\"constrained\"", triangles,
                            [&](std::uint64_t i) { return mesh.constrained[i]; });
  write_array<std::int32_t>(file, "Name=\"neighbours\" NumberOfComponents=\"3\"", 3 * triangles,
                            [&](std::uint64_t i) { return mesh.neighbours[i / 3][i % 3]; });
  if (!mesh.region.empty()) write_regions(file, result);
  file.print("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
}

}  // namespace gcdt::io
