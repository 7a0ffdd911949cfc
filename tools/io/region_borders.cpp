// SPDX-License-Identifier: Apache-2.0
#include "region_borders.hpp"

#include <algorithm>
#include <cmath>

namespace gcdt::io {

namespace {

std::vector<std::uint8_t> colours_of_regions(const MeshArrays& mesh) {
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

/// In degrees. Sides are scaled to 1, so that their squares neither overflow nor vanish.
double least_angle(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c) {
  constexpr double degrees = 57.29577951308232;
  const std::array<std::array<double, 2>, 3> sides = {
      {{b[0] - a[0], b[1] - a[1]}, {c[0] - b[0], c[1] - b[1]}, {a[0] - c[0], a[1] - c[1]}}};
  double longest = 0, least = 180;
  for (const auto& [x, y] : sides) longest = std::max({longest, std::abs(x), std::abs(y)});
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &p = sides[k], &q = sides[(k + 1) % 3];
    const double px = p[0] / longest, py = p[1] / longest, qx = -q[0] / longest, qy = -q[1] / longest;
    least = std::min(least, degrees * std::atan2(std::abs(px * qy - py * qx), px * qx + py * qy));
  }
  return least;
}

}  // namespace

Fill fill_by_region(const MeshArrays& mesh) {
  Fill fill;
  if (mesh.region.empty()) return fill;
  fill.colours.assign(region_colours.begin(), region_colours.end());
  const std::vector<std::uint8_t> of_region = colours_of_regions(mesh);
  for (const std::uint32_t region : mesh.region) fill.colour.push_back(of_region[region]);
  return fill;
}

Fill fill_by_angle(const MeshArrays& mesh, const std::vector<std::array<double, 2>>& vertices) {
  Fill fill;
  fill.colours.assign(angle_colours.begin(), angle_colours.end());
  fill.histogram.resize(60);
  for (const auto& [a, b, c] : mesh.triangles) {
    const double angle = std::min(least_angle(vertices[a], vertices[b], vertices[c]), 59.999);
    fill.colour.push_back(static_cast<std::uint8_t>(angle / degrees_of_colour));
    ++fill.histogram[static_cast<std::size_t>(angle)];
  }
  return fill;
}

Borders borders_of(const Canvas& canvas, const MeshArrays& mesh, const Fill& fill, std::size_t c) {
  const std::vector<std::uint8_t>& colour = fill.colour;
  Borders borders(canvas);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (colour[t] != c) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t across = mesh.neighbours[t][k];
      if (across < 0 || colour[static_cast<std::size_t>(across)] != c)
        borders.add(mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]);
    }
  }
  return borders;
}

}  // namespace gcdt::io
