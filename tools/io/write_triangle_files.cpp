// SPDX-License-Identifier: Apache-2.0
#include "grid_text.hpp"
#include "triangle_files.hpp"

namespace gcdt::io {

namespace {

void write_grid(OutputFile& file, const Result& result) {
  file.print("# gcdt grid {}\n", to_text(result.mesh.statistics.grid));
}

void write_vertices(OutputFile& file, const Result& result) {
  file.print("{} 2 0 0\n", result.vertex_count());
  for (std::size_t v = 0; v < result.vertex_count(); ++v)
    file.print("{} {} {}\n", v + result.input.first, result.vertex(v)[0], result.vertex(v)[1]);
}

}  // namespace

void write_ele(OutputFile& file, const Result& result) {
  const std::uint32_t first = result.input.first;
  file.print("{} 3 0\n", result.mesh.triangles.size());
  std::uint64_t number = first;
  for (const auto& [a, b, c] : result.mesh.triangles)
    file.print("{} {} {} {}\n", number++, a + first, b + first, c + first);
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
  for_each_edge(result.mesh, [&](std::uint32_t a, std::uint32_t b, bool constrained) {
    file.print("{} {} {} {}\n", number++, a + first, b + first, constrained ? 1 : 0);
  });
  write_grid(file, result);
}

void write_poly(OutputFile& file, const Result& result) {
  const std::uint32_t first = result.input.first;
  write_vertices(file, result);
  file.print("{} 1\n", result.mesh.pieces.size());
  std::uint64_t number = first;
  for (const auto& [a, b] : result.mesh.pieces) file.print("{} {} {} 1\n", number++, a + first, b + first);
  file.print("0\n");
  write_grid(file, result);
}

}  // namespace gcdt::io
