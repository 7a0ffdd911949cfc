// SPDX-License-Identifier: Apache-2.0
#include "proof/pixels.hpp"

#include <algorithm>
#include <array>

namespace gcdt::proof {

namespace {

constexpr std::uint32_t leaf_size = 8;

/// Position number / whole on a segment; `in`: the position belongs to the interval that it bounds.
struct Bound {
  Wide number, whole;
  bool in;
};

/// Keeps the interval [from, to] of positions on one axis at which a coordinate is in [2 low - 1, 2 high + 1), in
/// halves of cells. False if that is nowhere. Numbers are below 2^33, products below 2^66.
bool clip(std::int64_t a, std::int64_t b, std::int64_t low, std::int64_t high, Bound& from, Bound& to) {
  const std::int64_t length = 2 * (b - a), first = 2 * (low - a) - 1, last = 2 * (high - a) + 1;
  if (length == 0) return first <= 0 && 0 < last;
  const bool up = length > 0;
  const Wide whole = up ? length : -length;
  const Bound enter = {up ? first : -last, whole, up}, leave = {up ? last : -first, whole, !up};
  const Wide later = enter.number * from.whole - from.number * enter.whole;
  if (later > 0 || (later == 0 && !enter.in)) from = enter;
  const Wide earlier = to.number * leave.whole - leave.number * to.whole;
  if (earlier > 0 || (earlier == 0 && !leave.in)) to = leave;
  return true;
}

std::int64_t floor_divide(Wide a, Wide b) {  // b > 0
  const Wide q = a / b;
  return static_cast<std::int64_t>(q * b > a ? q - 1 : q);
}

}  // namespace

bool meets_pixels(Vertex a, Vertex b, Vertex low, Vertex high) {
  Bound from = {0, 1, true}, to = {1, 1, true};
  if (!clip(a.x, b.x, low.x, high.x, from, to) || !clip(a.y, b.y, low.y, high.y, from, to)) return false;
  const Wide room = to.number * from.whole - from.number * to.whole;
  return room > 0 || (room == 0 && from.in && to.in);
}

std::optional<Vertex> pixel_of_crossing(Vertex a, Vertex b, Vertex c, Vertex d) {
  const std::int64_t at_a = orient(c, d, a), at_b = orient(c, d, b), at_c = orient(a, b, c), at_d = orient(a, b, d);
  auto apart = [](std::int64_t p, std::int64_t q) { return (p < 0 && q > 0) || (p > 0 && q < 0); };
  if (!apart(at_a, at_b) || !apart(at_c, at_d)) return std::nullopt;
  // The crossing is a + (b - a) at_a / (at_a - at_b).
  const Wide sign = at_a > 0 ? 1 : -1, number = sign * at_a, whole = sign * (Wide(at_a) - at_b);
  auto rounded = [&](std::int64_t p, std::int64_t q) {
    return static_cast<std::int32_t>(p + floor_divide(2 * Wide(q - p) * number + whole, 2 * whole));
  };
  return Vertex{rounded(a.x, b.x), rounded(a.y, b.y)};
}

PixelTree::PixelTree(const Sites& sites) : sites_(sites) {
  for (std::uint32_t v = 0; v < sites.at.size(); ++v)
    if (sites.is_representative(v)) order_.push_back(v);
  build(0, 0, static_cast<std::uint32_t>(order_.size()));
}

void PixelTree::build(std::size_t number, std::uint32_t begin, std::uint32_t end) {
  if (nodes_.size() <= number) nodes_.resize(number + 1);
  Node node = {sites_.at[order_[begin]], sites_.at[order_[begin]], begin, end};
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vertex p = sites_.at[order_[i]];
    node.low = {std::min(node.low.x, p.x), std::min(node.low.y, p.y)};
    node.high = {std::max(node.high.x, p.x), std::max(node.high.y, p.y)};
  }
  nodes_[number] = node;
  if (end - begin <= leaf_size) return;
  const bool by_x = std::int64_t(node.high.x) - node.low.x >= std::int64_t(node.high.y) - node.low.y;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t u, std::uint32_t v) {
                     return by_x ? sites_.at[u].x < sites_.at[v].x : sites_.at[u].y < sites_.at[v].y;
                   });
  build(2 * number + 1, begin, middle);
  build(2 * number + 2, middle, end);
}

void PixelTree::visit(std::size_t number, Vertex a, Vertex b, std::vector<std::uint32_t>& found) const {
  const Node& node = nodes_[number];
  if (!meets_pixels(a, b, node.low, node.high)) return;
  if (node.end - node.begin > leaf_size) {
    visit(2 * number + 1, a, b, found);
    visit(2 * number + 2, a, b, found);
    return;
  }
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const Vertex p = sites_.at[order_[i]];
    if (meets_pixels(a, b, p, p)) found.push_back(order_[i]);
  }
}

std::vector<std::uint32_t> PixelTree::along(std::uint32_t a, std::uint32_t b) const {
  std::vector<std::uint32_t> found;
  const Vertex from = sites_.at[a], to = sites_.at[b];
  visit(0, from, to, found);
  // Both coordinates are monotone along the segment, and pixels are apart.
  const std::int64_t right = to.x < from.x ? -1 : 1, up = to.y < from.y ? -1 : 1;
  std::sort(found.begin(), found.end(), [&](std::uint32_t u, std::uint32_t v) {
    const Vertex p = sites_.at[u], q = sites_.at[v];
    return p.x != q.x ? right * p.x < right * q.x : up * p.y < up * q.y;
  });
  return found;
}

}  // namespace gcdt::proof
