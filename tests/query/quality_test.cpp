// SPDX-License-Identifier: Apache-2.0
// Areas and angles measured on the device against sums in exact arithmetic on the host.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "polygons.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Grid32 = std::vector<std::array<std::int32_t, 2>>;
__extension__ typedef __int128 Wide;

/// The angle at a corner by its cotangent, a fraction of integers.
struct Angle {
  std::int64_t dot, area;
  bool operator<(const Angle& other) const { return Wide(dot) * other.area > Wide(other.dot) * area; }
};

struct Measured {
  Angle angle;
  std::size_t triangle;
};

std::array<Angle, 3> angles(const Grid32& points, const std::array<std::uint32_t, 3>& t) {
  std::array<Angle, 3> all{};
  for (int k = 0; k < 3; ++k) {
    const auto &a = points[t[k]], &b = points[t[(k + 1) % 3]], &c = points[t[(k + 2) % 3]];
    const std::int64_t bx = std::int64_t{b[0]} - a[0], by = std::int64_t{b[1]} - a[1];
    const std::int64_t cx = std::int64_t{c[0]} - a[0], cy = std::int64_t{c[1]} - a[1];
    all[k] = {bx * cx + by * cy, bx * cy - by * cx};
  }
  return all;
}

}  // namespace

TEST_CASE("least and largest angles and areas are those of the triangles, whichever domain they are of") {
  for (const Domain domain : {Domain::hull, Domain::even_odd})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      Random random(seed);
      const std::int64_t side = seed % 2 ? 12 : 2147483648;
      Grid32 points;
      for (int i = 0; i < 400; ++i)
        points.push_back(
            {static_cast<std::int32_t>(random.below(side)), static_cast<std::int32_t>(random.below(side))});
      Options options;
      options.domain = domain;
      options.grid = FixedGrid{};
      options.crossing = Crossing::drop;
      std::vector<Constraint> constraints;
      for (std::uint32_t i = 0; i + 2 < 60; i += 3)
        constraints.insert(constraints.end(), {{i, i + 1}, {i + 1, i + 2}, {i + 2, i}});
      const Result result = solver().solve(points, constraints, options);
      const Triangulation mesh = result.download();
      REQUIRE(!mesh.triangles.empty());
      const Quality quality = result.quality();
      std::uint64_t least = ~0ull, most = 0;
      Wide sum = 0;
      Measured sharpest{{1, 0}, 0}, widest{{-1, 0}, 0};
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const Angle& angle : angles(points, mesh.triangles[t])) {
          const auto area = static_cast<std::uint64_t>(angle.area);
          least = std::min(least, area), most = std::max(most, area), sum += area;
          if (sharpest.angle.area == 0 || angle < sharpest.angle) sharpest = {angle, t};
          if (widest.angle.area == 0 || widest.angle < angle) widest = {angle, t};
        }
      CHECK(quality.triangles == mesh.triangles.size());
      CHECK(quality.least_doubled == least);
      CHECK(quality.largest_doubled == most);
      CHECK(quality.doubled == static_cast<std::uint64_t>(sum / 3));  // each triangle was met at three corners
      CHECK(quality.area == static_cast<double>(sum / 3) / 2);
      CHECK(quality.least_angle_triangle == static_cast<std::int32_t>(sharpest.triangle));
      CHECK(quality.largest_angle_triangle == static_cast<std::int32_t>(widest.triangle));
      const double pi = std::acos(-1.0);
      auto degrees = [&](const Angle& a) { return std::atan2(double(a.area), double(a.dot)) * (180 / pi); };
      CHECK(quality.least_angle == degrees(sharpest.angle));
      CHECK(quality.largest_angle == degrees(widest.angle));
    }
}

TEST_CASE("the area of polygons is their shoelace area, and of nothing it is zero") {
  const Polygons p = make_polygons(20, 20, 4, 0.3, false, false, 7);
  Options options;
  options.domain = Domain::nonzero;
  options.grid = FixedGrid{0, 0, "1"};
  std::int64_t shoelace = 0;
  for (const std::int64_t area : p.shoelace) shoelace += area;
  CHECK(solver().solve(p.points, p.constraints, options).quality().doubled == static_cast<std::uint64_t>(shoelace));
  const Quality none = solver().solve(Grid32{{0, 0}, {1, 1}}).quality();
  CHECK(none.triangles == 0);
  CHECK(none.area == 0);
  CHECK(none.least_angle_triangle == -1);
}
