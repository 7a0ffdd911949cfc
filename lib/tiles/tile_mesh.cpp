// SPDX-License-Identifier: Apache-2.0
#include "tiles/tile_mesh.hpp"

#include <cmath>

#include "tiles/parts.hpp"
#include "tiles/passages.hpp"

namespace gcdt::tiles {

namespace {

template <class T>
Span<T> view_of(const PoolResult& made, std::size_t problem, std::int32_t array) {
  const auto [result, at] = made.at(problem);
  const auto slot = static_cast<std::size_t>(array);
  if (result->begins[slot].empty()) return {};
  const std::uint64_t begin = result->begins[slot][at], end = result->begins[slot][at + 1];
  return {reinterpret_cast<const T*>(result->arrays[slot].bytes.get()) + begin, static_cast<std::size_t>(end - begin)};
}

/// The box around a circle, cut to another: what of the circle is in the other lies in it. All of it is computed in
/// doubles and rounded outwards. Bounds: differences of coordinates are exact, squares and products off by 2^-52 of
/// themselves; so with h, the larger part of a numerator, the centre is off by less than 2^-48 h / |2 D|.
class CircleBox {
 public:
  CircleBox(const GridPoint& a, const GridPoint& b, const GridPoint& c) : corner_(a) {
    const double bx = double(b[0]) - a[0], by = double(b[1]) - a[1], cx = double(c[0]) - a[0], cy = double(c[1]) - a[1];
    const double doubled_area = static_cast<double>(orient2d(a, b, c));
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy, scale = 1 / (2 * doubled_area);
    centre_[0] = (b2 * cy - c2 * by) * scale;
    centre_[1] = (c2 * bx - b2 * cx) * scale;
    slack_[0] = (std::abs(b2 * cy) + std::abs(c2 * by)) * scale * tiny;
    slack_[1] = (std::abs(c2 * bx) + std::abs(b2 * cx)) * scale * tiny;
    radius_ = std::sqrt(centre_[0] * centre_[0] + centre_[1] * centre_[1]) * (1 + tiny) + slack_[0] + slack_[1];
  }

  Box within(const Box& all) const {
    Box box{};
    for (int axis = 0; axis < 2; ++axis) {
      const double half = half_width(all, 1 - axis) + slack_[axis] + 1;
      const double middle = corner_[axis] + centre_[axis], most = static_cast<double>(all.most[axis]),
                   least = static_cast<double>(all.least[axis]);
      // Not below 0, so cutting the digits off rounds down.
      box.least[axis] = static_cast<std::int64_t>(std::clamp(middle - half, least, most));
      box.most[axis] = std::min(static_cast<std::int64_t>(std::clamp(middle + half, least, most)) + 1, all.most[axis]);
    }
    return box;
  }

 private:
  /// Half of what the circle measures along one axis where its other coordinate is in the box: less than its radius if
  /// the centre is d beyond the box there.
  double half_width(const Box& all, int other) const {
    const double middle = corner_[other] + centre_[other];
    double d = std::max(middle - static_cast<double>(all.most[other]), static_cast<double>(all.least[other]) - middle);
    d -= slack_[other] + std::abs(middle) * tiny + 1;
    return d <= 0 ? radius_ : std::sqrt(std::max(0.0, (radius_ - d) * (radius_ + d))) * (1 + tiny);
  }

  static constexpr double tiny = 0x1p-48;
  const GridPoint& corner_;
  double centre_[2], slack_[2], radius_;  // the centre from the corner
};

}  // namespace

ProblemMesh::ProblemMesh(const PoolResult& made, std::size_t problem)
    : triangles(view_of<Triangle>(made, problem, GCDT_TRIANGLES)),
      neighbours(view_of<Neighbours>(made, problem, GCDT_NEIGHBOURS)),
      constrained(view_of<std::uint8_t>(made, problem, GCDT_CONSTRAINED)),
      representative(view_of<std::uint32_t>(made, problem, GCDT_REPRESENTATIVES)),
      pieces(view_of<Constraint>(made, problem, GCDT_PIECES)),
      source_offsets(view_of<std::uint32_t>(made, problem, GCDT_SOURCE_OFFSETS)),
      sources(view_of<std::uint32_t>(made, problem, GCDT_SOURCES)),
      dropped(view_of<std::uint32_t>(made, problem, GCDT_DROPPED)) {
  statistics = made.at(problem).first->statistics;
}

std::uint32_t piece_between(Span<Constraint> pieces, const GridPoints& points, std::uint32_t u, std::uint32_t v) {
  const auto key = [&](const Constraint& ends) {
    return std::make_pair(code_of(points[ends[0]]), code_of(points[ends[1]]));
  };
  const bool forward = code_of(points[u]) < code_of(points[v]);
  const Constraint wanted = forward ? Constraint{u, v} : Constraint{v, u};
  const auto found = std::lower_bound(pieces.begin(), pieces.end(), wanted,
                                      [&](const Constraint& a, const Constraint& b) { return key(a) < key(b); });
  if (found == pieces.end() || *found != wanted)
    throw Error(Status::check_failed, "tiles: a constrained edge is no piece");
  return static_cast<std::uint32_t>(found - pieces.begin());
}

Array<std::uint8_t> final_triangles(const ProblemMesh& mesh, const Partition& all, std::size_t tile, const Cuts& cuts) {
  const Tile& given = all.tiles[tile];
  Array<std::uint8_t> final(mesh.triangles.size());
  for_each_in_threads(final.size(), [&](std::size_t i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const Box box = CircleBox(given.points[a], given.points[b], given.points[c]).within(all.box);
    const auto [first, last] = cuts.tiles_of(box);
    final[i] = first == tile && last == tile;
  });
  std::vector<Passage> passages = given.passages;
  for (const std::uint32_t c : mesh.dropped)
    passages.push_back({given.constraints[c][0], given.constraints[c][1], false});
  for_passed_triangles(mesh, given.points, passages, [&](std::uint32_t triangle) { final[triangle] = 0; });
  return final;
}

}  // namespace gcdt::tiles
