// SPDX-License-Identifier: Apache-2.0
#include "vtu.hpp"

#include "vtu_arrays.hpp"

namespace gcdt::io {

namespace {

void write_regions(OutputFile& file, const Result& result) {
  const MeshArrays& mesh = result.mesh;
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
  const MeshArrays& mesh = result.mesh;
  const std::uint64_t triangles = mesh.triangles.size();
  file.print("{}<UnstructuredGrid>\n", vtk_head("UnstructuredGrid"));
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
