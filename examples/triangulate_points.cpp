// SPDX-License-Identifier: Apache-2.0
// The Delaunay triangulation of points: seeds placed as in a sunflower.
#include <cmath>
#include <cstdio>

#include <gcdt/gcdt.hpp>

int main() {
  const double golden_angle = 2.399963229728653;
  std::vector<std::array<double, 2>> seeds;
  for (int i = 0; i < 2000; ++i) {
    const double radius = std::sqrt(i), angle = golden_angle * i;
    seeds.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }

  try {
    const gcdt::Triangulation mesh = gcdt::triangulate(seeds);

    std::size_t hull_edges = 0;
    for (const auto& across : mesh.neighbours)
      for (std::int32_t neighbour : across) hull_edges += neighbour == -1;

    std::printf("%zu seeds, %zu triangles, %zu edges on the hull\n", seeds.size(), mesh.triangles.size(), hull_edges);
    std::printf("on %s in %.1f ms\n", mesh.statistics.device.c_str(), mesh.statistics.ms.call);

    // Euler: n vertices, h of them on the hull, give 2n - 2 - h triangles.
    return mesh.triangles.size() == 2 * seeds.size() - 2 - hull_edges ? 0 : 1;
  } catch (const gcdt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
