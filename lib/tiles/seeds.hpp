// SPDX-License-Identifier: Apache-2.0
// Hole and region points in a mesh that the host has.
#pragma once

#include "device/parts.hpp"
#include "tiles/placed.hpp"

namespace gcdt::tiles {

/// Distinct points in a tree of boxes, in which a triangle finds those that it holds. A triangle looks at about as many
/// boxes as its border meets, whatever its shape: no walk could do that in a mesh with constraints.
class SeedTree {
 public:
  /// In ascending order, none twice.
  explicit SeedTree(const std::vector<GridPoint>& points);

  /// Appends the numbers of the points in the triangle, its border included; corners counter-clockwise.
  void find(const std::array<GridPoint, 3>& corners, std::vector<std::uint32_t>& found) const;

 private:
  struct Node {
    Box box;
    std::uint32_t first, end;  ///< of points_
    std::uint32_t more;        ///< the first of its two nodes, which follow each other; 0: none
  };
  void divide(std::uint32_t node);

  const std::vector<GridPoint>& points_;
  std::vector<std::uint32_t> order_;  ///< of the points, node by node
  std::vector<Node> nodes_;
};

/// For each seed the least triangle that holds it, its border included; `none` without one. corners(t) are those of
/// triangle t.
template <class Corners>
std::vector<std::uint32_t> least_triangles(const std::vector<std::optional<GridPoint>>& seeds, std::size_t triangles,
                                           std::uint32_t none, Corners&& corners) {
  std::vector<GridPoint> points;
  for (const auto& seed : seeds)
    if (seed) points.push_back(*seed);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.empty()) return std::vector<std::uint32_t>(seeds.size(), none);
  const SeedTree tree(points);
  const Parts parts(triangles);
  using Held = std::array<std::uint32_t, 2>;  // a point, and a triangle that holds it
  std::vector<std::vector<Held>> held(parts.size());
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    std::vector<std::uint32_t> found;
    for (std::size_t t = first; t < end; ++t) {
      found.clear();
      tree.find(corners(t), found);
      for (const std::uint32_t point : found) held[part].push_back({point, static_cast<std::uint32_t>(t)});
    }
  });
  std::vector<std::uint32_t> least(points.size(), none), all;
  for (const auto& some : held)
    for (const auto& [point, t] : some) least[point] = std::min(least[point], t);
  for (const auto& seed : seeds) {
    const auto at = seed ? std::lower_bound(points.begin(), points.end(), *seed) - points.begin() : 0;
    all.push_back(seed ? least[static_cast<std::size_t>(at)] : none);
  }
  return all;
}

}  // namespace gcdt::tiles
