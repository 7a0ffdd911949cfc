// SPDX-License-Identifier: Apache-2.0
// Shorelines of islands and lakes: outlines whose segments and whose sizes have many scales.
//
// A segment becomes four, as in Koch's curve, with a bump of random side and height; each of them becomes four again
// until it is short. No two segments cross, by induction: the curve from a to b stays in the rhombus over a b with
// angles of 60 degrees at a and b, which holds the rhombi of the four, and these meet in their common ends alone. For
// the length 1 of a b and the bump's height s sqrt(3) / 6, 0 < s < 1: the outer two rhombi lie in the corners of the
// whole; the inner ones are mirror images on either side of x = 1/2, from which they keep a distance of (1 - s) / 12.
// Their outermost corners (5/12 - s/12, s sqrt(3) / 12 + sqrt(3) / 36) lie below the border y = x / sqrt(3), since s
// < 1. At x = 1/3 an inner one takes directions up to 30 degrees from the bump's slope, which is below 60, an outer one
// up to 30 degrees from 180. Hexagons of such curves have rhombi that meet in their corners alone, lie within 1.16
// radii of the centre, and leave a disc of 0.57 radii free, in which a lake may lie, and an island in that.
#include "inputs.hpp"

#include <algorithm>
#include <cmath>

namespace gcdt::bench {

namespace {

constexpr std::uint64_t seed = 21000;
constexpr int deepest_cell = 7, deepest_ring = 3;
constexpr double sqrt3 = 1.7320508075688772;

// Each random number is drawn in a statement of its own: C++ leaves the order within an expression open.
/// Random numbers of a place in the tree of shapes: they do not depend on how finely others are drawn.
std::uint64_t child(std::uint64_t key, std::uint64_t number) { return test::Random(key + number).next(); }

/// Calls vertex(point, whether the next vertex of the ring is the first one again) for all rings in order.
template <class Vertex>
class Shores {
 public:
  Shores(double shortest, Vertex& vertex) : shortest_(shortest), vertex_(vertex) {}

  /// Islands of a square: one, none, or those of its quarters.
  void cell(double left, double bottom, double size, int depth, std::uint64_t key) {
    test::Random random(key);
    const std::uint64_t choice = random.below(10);
    if (depth > 0 && choice == 0) return;
    if (depth == deepest_cell || (depth > 1 && choice < 4)) {
      const double radius = size * random.between(0.12, 0.42), room = size / 2 - 1.16 * radius;
      const double x = left + size / 2 + room * random.between(-1, 1);
      const double y = bottom + size / 2 + room * random.between(-1, 1);
      ring({x, y}, radius, 0, random.next());
      return;
    }
    for (std::uint64_t k = 0; k < 4; ++k)
      cell(left + (k % 2 == 1 ? size / 2 : 0), bottom + (k / 2 == 1 ? size / 2 : 0), size / 2, depth + 1,
           child(key, k));
  }

 private:
  void ring(Point centre, double radius, int depth, std::uint64_t key) {
    test::Random random(key);
    const auto turn = static_cast<std::uint32_t>(random.next() >> 32);
    double detail = shortest_;  // segments of one shore are up to 16 times as long as of another
    for (std::uint64_t k = random.below(5); k > 0; --k) detail *= 2;
    const auto corner = [&](std::uint32_t k) {
      const Point d = test::direction(turn + static_cast<std::uint32_t>((std::uint64_t{k % 6} << 32) / 6));
      return Point{centre[0] + radius * d[0], centre[1] + radius * d[1]};
    };
    for (std::uint32_t k = 0; k < 6; ++k) {
      shore(corner(k), corner(k + 1), detail, k == 5, child(key, k));
    }
    if (depth == deepest_ring || random.below(2) == 0) return;
    const double inner = radius * random.between(0.2, 0.48);
    ring(centre, inner, depth + 1, random.next());
  }

  /// From a, which is told, to b, which is not. `last`: b is the first vertex of the ring.
  void shore(Point a, Point b, double detail, bool last, std::uint64_t key) {
    const double dx = b[0] - a[0], dy = b[1] - a[1], squared = dx * dx + dy * dy;
    test::Random random(key);
    const bool straight = random.below(24) == 0 && squared < 4096 * detail * detail;  // a stretch of beach
    if (squared < detail * detail || straight) {
      vertex_(a, last);
      return;
    }
    const double height = random.between(0.35, 0.85) * sqrt3 / 6, s = random.below(2) == 0 ? height : -height;
    const Point first = {a[0] + dx / 3, a[1] + dy / 3}, second = {a[0] + 2 * dx / 3, a[1] + 2 * dy / 3};
    const Point bump = {a[0] + dx / 2 - s * dy, a[1] + dy / 2 + s * dx};
    shore(a, first, detail, false, child(key, 0));
    shore(first, bump, detail, false, child(key, 1));
    shore(bump, second, detail, false, child(key, 2));
    shore(second, b, detail, last, child(key, 3));
  }

  double shortest_;
  Vertex& vertex_;
};

template <class Vertex>
void draw(double shortest, Vertex&& vertex) {
  Shores<std::remove_reference_t<Vertex>>(shortest, vertex).cell(0, 0, 1, 0, seed);
}

}  // namespace

Workload coasts(std::size_t n) {
  // As fine as gives about n vertices: there are fewer where the shortest segment is longer.
  double fine = 0x1p-26, coarse = 0.5;
  for (int i = 0; i < 20; ++i) {
    const double middle = std::sqrt(fine * coarse);
    std::size_t count = 0;
    draw(middle, [&](Point, bool) { ++count; });
    (count > n ? fine : coarse) = middle;
  }
  Workload scene;
  std::uint32_t first = 0;
  draw(coarse, [&](Point p, bool last) {
    const auto number = static_cast<std::uint32_t>(scene.points.size());
    scene.points.push_back({test::snapped(p[0]), test::snapped(p[1])});
    scene.constraints.push_back({number, last ? first : number + 1});
    if (last) first = number + 1;
  });
  test::Random random(seed + 1);
  return shuffled(scene, random);
}

}  // namespace gcdt::bench
