// SPDX-License-Identifier: Apache-2.0
// A map filled by even-odd: two countries with a common border, a lake in one of them, an island in the lake.
#include <cstdio>

#include <gcdt/gcdt.hpp>

int main() {
  // Rings in any direction, each closed from its last point to its first; the border 1-2 is in two of them.
  const std::vector<std::array<std::int32_t, 2>> points = {
      {0, 0},   {50, 5},  {45, 60}, {-5, 55},  // the western country
      {95, 0},  {99, 58},                      // the eastern one goes on from 1 and 2
      {10, 15}, {35, 15}, {32, 45}, {8, 40},   // the lake
      {18, 25}, {26, 27}, {20, 35}};           // the island
  const std::vector<std::vector<std::uint32_t>> rings = {{0, 1, 2, 3}, {1, 4, 5, 2}, {9, 8, 7, 6}, {10, 11, 12}};
  std::vector<gcdt::Constraint> borders;
  long long expected = 0;  // twice the area: countries less lake plus island
  for (std::size_t r = 0; r < rings.size(); ++r) {
    long long area = 0;
    for (std::size_t i = 0; i < rings[r].size(); ++i) {
      const std::uint32_t a = rings[r][i], b = rings[r][(i + 1) % rings[r].size()];
      borders.push_back({a, b});
      area += 1ll * points[a][0] * points[b][1] - 1ll * points[b][0] * points[a][1];
    }
    expected += (r == 2 ? -1 : 1) * (area < 0 ? -area : area);
  }
  try {
    gcdt::Options options;
    options.domain = gcdt::Domain::even_odd;
    const gcdt::Triangulation map = gcdt::triangulate(points, borders, options);
    long long area = 0;
    for (std::size_t t = 0; t < map.triangles.size(); ++t) {
      const auto& [a, b, c] = map.triangles[t];
      area += 1ll * (points[b][0] - points[a][0]) * (points[c][1] - points[a][1]) -
              1ll * (points[b][1] - points[a][1]) * (points[c][0] - points[a][0]);
      std::printf("%u %u %u in region %u, %u borders from the sea\n", a, b, c, map.region[t], map.depth[t]);
    }
    std::printf("twice the area: %lld\n", area);
    return area == expected && map.statistics.open_parity == 0 ? 0 : 1;
  } catch (const gcdt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
