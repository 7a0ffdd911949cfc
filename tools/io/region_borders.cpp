// SPDX-License-Identifier: Apache-2.0
#include "region_borders.hpp"

#include <algorithm>

namespace gcdt::io {

std::vector<std::uint8_t> colours_of_regions(const Triangulation& mesh) {
  std::uint32_t count = 0;
  for (const std::uint32_t region : mesh.region) count = std::max(count, region + 1);
  std::vector<std::array<std::uint32_t, 2>> pairs;  // a region, and a lesser one across an edge
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t across : mesh.neighbours[t])
      if (across >= 0 && mesh.region[static_cast<std::size_t>(across)] < mesh.region[t])
        pairs.push_back({mesh.region[t], mesh.region[static_cast<std::size_t>(across)]});
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::uint8_t> chosen(count);
  auto pair = pairs.begin();
  for (std::uint32_t region = 0; region < count; ++region) {
    std::array<bool, region_colours.size()> taken{};
    for (; pair != pairs.end() && (*pair)[0] == region; ++pair) taken[chosen[(*pair)[1]]] = true;
    const auto free = std::find(taken.begin(), taken.end(), false);
    chosen[region] =
        static_cast<std::uint8_t>(free == taken.end() ? region % region_colours.size() : free - taken.begin());
  }
  return chosen;
}

Borders borders_of(const Canvas& canvas, const Triangulation& mesh, const std::vector<std::uint8_t>& colours,
                   std::size_t c) {
  Borders borders(canvas);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (colours[mesh.region[t]] != c) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t across = mesh.neighbours[t][k];
      if (across < 0 || colours[mesh.region[static_cast<std::size_t>(across)]] != c)
        borders.add(mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]);
    }
  }
  return borders;
}

}  // namespace gcdt::io
