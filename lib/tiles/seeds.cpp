// SPDX-License-Identifier: Apache-2.0
#include "tiles/seeds.hpp"

#include <algorithm>
#include <numeric>

namespace gcdt::tiles {

namespace {

constexpr std::uint32_t most_of_leaf = 8;

/// Whether the line from a to b has all of the box on its right.
bool is_right_of(const GridPoint& a, const GridPoint& b, const Box& box) {
  const std::int64_t x = b[1] > a[1] ? box.least[0] : box.most[0], y = b[0] > a[0] ? box.most[1] : box.least[1];
  return orient2d(a, b, {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}) < 0;
}

Box box_around(const std::array<GridPoint, 3>& corners) {
  Box box{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    box.least[axis] = std::min({corners[0][axis], corners[1][axis], corners[2][axis]});
    box.most[axis] = std::max({corners[0][axis], corners[1][axis], corners[2][axis]});
  }
  return box;
}

bool meet(const Box& a, const Box& b) {
  return a.least[0] <= b.most[0] && b.least[0] <= a.most[0] && a.least[1] <= b.most[1] && b.least[1] <= a.most[1];
}

}  // namespace

SeedTree::SeedTree(const std::vector<GridPoint>& points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.push_back({{}, 0, static_cast<std::uint32_t>(points.size()), 0});
  // Ends: a node of more than one point is divided into smaller ones.
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) divide(node);
}

void SeedTree::divide(std::uint32_t node) {
  Node made = nodes_[node];
  const GridPoint& some = points_[order_[made.first]];
  made.box = {{some[0], some[1]}, {some[0], some[1]}};
  for (std::uint32_t i = made.first; i < made.end; ++i)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::int64_t at = points_[order_[i]][axis];
      made.box.least[axis] = std::min(made.box.least[axis], at);
      made.box.most[axis] = std::max(made.box.most[axis], at);
    }
  if (made.end - made.first > most_of_leaf) {
    const std::size_t axis = made.box.most[0] - made.box.least[0] < made.box.most[1] - made.box.least[1];
    const std::uint32_t middle = made.first + (made.end - made.first) / 2;
    std::nth_element(order_.begin() + made.first, order_.begin() + middle, order_.begin() + made.end,
                     [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    made.more = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({{}, made.first, middle, 0});
    nodes_.push_back({{}, middle, made.end, 0});
  }
  nodes_[node] = made;
}

void SeedTree::find(const std::array<GridPoint, 3>& corners, std::vector<std::uint32_t>& found) const {
  const auto& [a, b, c] = corners;
  const Box around = box_around(corners);
  std::array<std::uint32_t, 64> open{};  // each level but the last leaves one node behind, and each halves the points
  std::size_t count = 1;
  while (count > 0) {
    const Node& node = nodes_[open[--count]];
    if (!meet(around, node.box) || is_right_of(a, b, node.box) || is_right_of(b, c, node.box) ||
        is_right_of(c, a, node.box))
      continue;
    if (node.more != 0) {
      open[count++] = node.more, open[count++] = node.more + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.end; ++i) {
      const GridPoint& p = points_[order_[i]];
      if (orient2d(a, b, p) >= 0 && orient2d(b, c, p) >= 0 && orient2d(c, a, p) >= 0) found.push_back(order_[i]);
    }
  }
}

}  // namespace gcdt::tiles
