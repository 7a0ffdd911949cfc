// SPDX-License-Identifier: Apache-2.0
#include <tuple>

#include "grid_text.hpp"
#include "markers.hpp"
#include "triangle_files.hpp"

namespace gcdt::io {

namespace {

void write_grid(OutputFile& file, const Result& result) {
  file.print("# gcdt grid {}\n", to_text(result.mesh.statistics.grid));
}

void write_vertices(OutputFile& file, const Result& result) {
  const Input& input = result.input;
  file.print("{} 2 {} {}\n", result.vertex_count(), input.attribute_count, input.vertex_markers.empty() ? 0 : 1);
  std::uint64_t number = input.first;
  for (std::size_t v = 0; v < result.vertex_count(); ++v) {
    file.print("{} {} {}", number++, result.vertex(v)[0], result.vertex(v)[1]);
    for (std::size_t k = 0; k < input.attribute_count; ++k) file.print(" {}", result.attribute(v, k));
    if (!input.vertex_markers.empty()) file.print(" {}", result.vertex_marker(v));
    file.write("\n");
  }
}

}  // namespace

std::vector<double> attribute_of(const Input& input, std::uint32_t k) {
  std::vector<double> values(input.vertices.size());
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = input.attributes[v * input.attribute_count + k];
  return values;
}

Result::Result(const Input& of, const MeshArrays& made) : input(of), mesh(made) {
  added_attributes.resize(mesh.added.size() * input.attribute_count);
  if (added_attributes.empty()) return;
  for (std::uint32_t k = 0; k < input.attribute_count; ++k) {
    const auto values = added_values(input.vertices, input.constraints, mesh.added, mesh.added_crossing,
                                     mesh.added_origin, attribute_of(input, k));
    for (std::size_t i = 0; i < values.size(); ++i) added_attributes[i * input.attribute_count + k] = values[i];
  }
}

void write_ele(OutputFile& file, const Result& result) {
  const std::uint32_t first = result.input.first;
  const bool attributes = !result.mesh.region_seed.empty() && !result.input.regions.empty();
  file.print("{} 3 {}\n", result.mesh.triangles.size(), attributes ? 1 : 0);
  std::uint64_t number = first;
  for (std::size_t t = 0; t < result.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = result.mesh.triangles[t];
    file.print("{} {} {} {}", number++, a + first, b + first, c + first);
    if (attributes) file.print(" {}", region_attribute(result, t));
    file.write("\n");
  }
  write_grid(file, result);
}

void write_node(OutputFile& file, const Result& result) {
  write_vertices(file, result);
  write_grid(file, result);
}

void write_neigh(OutputFile& file, const Result& result) {
  const std::int64_t first = result.input.first;
  auto numbered = [&](std::int32_t t) { return t < 0 ? std::int64_t{-1} : t + first; };
  file.print("{} 3\n", result.mesh.neighbours.size());
  std::int64_t number = first;
  for (const auto& [a, b, c] : result.mesh.neighbours)
    file.print("{} {} {} {}\n", number++, numbered(a), numbered(b), numbered(c));
  write_grid(file, result);
}

void write_edge(OutputFile& file, const Result& result) {
  const std::uint32_t first = result.input.first;
  std::uint64_t count = 0;
  for_each_edge(result.mesh, [&](auto, auto, auto) { ++count; });
  file.print("{} 1\n", count);
  std::uint64_t number = first;
  const PieceMarkers markers(result);
  for_each_edge(result.mesh, [&](std::uint32_t a, std::uint32_t b, bool constrained) {
    file.print("{} {} {} {}\n", number++, a + first, b + first, constrained ? markers.of_edge(a, b) : 0);
  });
  write_grid(file, result);
}

void write_poly(OutputFile& file, const Result& result) {
  const std::uint32_t first = result.input.first;
  write_vertices(file, result);
  file.print("{} 1\n", result.mesh.pieces.size());
  std::uint64_t number = first;
  const PieceMarkers markers(result);
  for (std::size_t i = 0; i < result.mesh.pieces.size(); ++i) {
    const auto& [a, b] = result.mesh.pieces[i];
    file.print("{} {} {} {}\n", number++, a + first, b + first, markers.of_piece(i));
  }
  const auto& [holes, regions] = std::tie(result.input.holes, result.input.regions);
  file.print("{}\n", holes.size());
  for (std::size_t i = 0; i < holes.size(); ++i) file.print("{} {} {}\n", i + first, holes[i][0], holes[i][1]);
  if (!regions.empty()) file.print("{}\n", regions.size());
  for (std::size_t i = 0; i < regions.size(); ++i)
    file.print("{} {} {} {} {}\n", i + first, regions[i].point[0], regions[i].point[1], regions[i].attribute,
               regions[i].largest_area);
  write_grid(file, result);
}

}  // namespace gcdt::io
