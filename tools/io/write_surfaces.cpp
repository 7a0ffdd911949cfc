// SPDX-License-Identifier: Apache-2.0
// Results as surfaces (.ply, .obj, .off), as meshes of gmsh (.msh) and as polygons (.geojson).
#include "binary_file.hpp"
#include "markers.hpp"
#include "outputs.hpp"

namespace gcdt::io {

void write_ply(OutputFile& file, const Result& result) {
  const MeshArrays& mesh = result.mesh;
  file.print("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", result.vertex_count());
  file.print("property double x\nproperty double y\nproperty double z\n");
  file.print("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.size());
  const auto put = [&](auto number) { put_little(number, [&](std::string_view bytes) { file.write(bytes); }); };
  for (std::size_t v = 0; v < result.vertex_count(); ++v) {
    for (const double c : result.vertex(v)) put(c);
    put(height(result, v));
  }
  for (const auto& corners : mesh.triangles) {
    put(std::uint8_t{3});
    for (const std::uint32_t v : corners) put(static_cast<std::int32_t>(v));
  }
}

void write_obj(OutputFile& file, const Result& result) {
  for (std::size_t v = 0; v < result.vertex_count(); ++v)
    file.print("v {} {} {}\n", result.vertex(v)[0], result.vertex(v)[1], height(result, v));
  for (const auto& [a, b, c] : result.mesh.triangles) file.print("f {} {} {}\n", a + 1, b + 1, c + 1);
  for (const auto& [a, b] : result.mesh.pieces) file.print("l {} {}\n", a + 1, b + 1);
}

void write_off(OutputFile& file, const Result& result) {
  file.print("OFF\n{} {} 0\n", result.vertex_count(), result.mesh.triangles.size());
  for (std::size_t v = 0; v < result.vertex_count(); ++v)
    file.print("{} {} {}\n", result.vertex(v)[0], result.vertex(v)[1], height(result, v));
  for (const auto& [a, b, c] : result.mesh.triangles) file.print("3 {} {} {}\n", a, b, c);
}

void write_msh(OutputFile& file, const Result& result) {
  const MeshArrays& mesh = result.mesh;
  file.print("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", result.vertex_count());
  for (std::size_t v = 0; v < result.vertex_count(); ++v)
    file.print("{} {} {} {}\n", v + 1, result.vertex(v)[0], result.vertex(v)[1], height(result, v));
  file.print("$EndNodes\n$Elements\n{}\n", mesh.pieces.size() + mesh.triangles.size());
  constexpr int line = 1, triangle = 2, tags = 2;  // kinds of elements; a physical and an elementary tag each
  std::uint64_t number = 0;
  const PieceMarkers markers(result);
  for (std::size_t i = 0; i < mesh.pieces.size(); ++i) {
    const auto& [a, b] = mesh.pieces[i];
    const std::int32_t marker = markers.of_piece(i);
    file.print("{} {} {} {} {} {} {}\n", ++number, line, tags, marker, marker, a + 1, b + 1);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const std::uint32_t region = mesh.region.empty() ? 1 : mesh.region[t] + 1;
    file.print("{} {} {} {} {} {} {} {}\n", ++number, triangle, tags, region, region, a + 1, b + 1, c + 1);
  }
  file.print("$EndElements\n");
}

void write_geojson(OutputFile& file, const Result& result) {
  const MeshArrays& mesh = result.mesh;
  file.write("{\"type\": \"FeatureCollection\", \"features\": [");
  const auto position = [&](std::uint32_t v) {
    file.print("[{}, {}", result.vertex(v)[0], result.vertex(v)[1]);
    if (result.input.heights) file.print(", {}", height(result, v));
    file.write("]");
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    file.print("{}\n{{\"type\": \"Feature\", \"properties\": {{\"triangle\": {}, \"constrained\": {}", t > 0 ? "," : "",
               t, mesh.constrained[t]);
    if (!mesh.region.empty())
      file.print(", \"region\": {}, \"depth\": {}, \"winding\": {}", mesh.region[t], mesh.depth[t], mesh.winding[t]);
    file.write("}, \"geometry\": {\"type\": \"Polygon\", \"coordinates\": [[");
    for (const std::uint32_t v : {a, b, c}) {
      position(v);
      file.write(", ");
    }
    position(a);
    file.write("]]}}");
  }
  file.write("\n]}\n");
}

}  // namespace gcdt::io
