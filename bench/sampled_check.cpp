// SPDX-License-Identifier: Apache-2.0
#include "sampled_check.hpp"

#include <algorithm>
#include <cmath>

#include "workloads.hpp"

namespace gcdt::bench {

namespace {

using Corner = std::array<std::int64_t, 2>;

Corner on_grid(Points points, const Grid& grid, std::uint32_t vertex) {
  Corner at;
  // nearbyint rounds half to even; the difference and the product by a power of two are exact for the inputs used
  for (int axis = 0; axis < 2; ++axis)
    at[axis] = static_cast<std::int64_t>(
        std::nearbyint(std::ldexp(points.coordinate(vertex, axis) - grid.origin[axis], -grid.cell_exponent)));
  return at;
}

__int128 orientation(const Corner& a, const Corner& b, const Corner& c) {
  return static_cast<__int128>(b[0] - a[0]) * (c[1] - a[1]) - static_cast<__int128>(b[1] - a[1]) * (c[0] - a[0]);
}

/// Sign of the in-circle determinant of counter-clockwise a, b, c and d: positive inside. Differences have 32
/// bits, so squares summed (`lift`) 65 and minors 65; lift x minor would need 130. Each lift is cut into
/// high x 2^32 + low, and the two sums of three products (each below 2^101) are put together for the sign.
int in_circle(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  const Corner* three[3] = {&a, &b, &c};
  std::int64_t x[3], y[3];
  for (int i = 0; i < 3; ++i) x[i] = (*three[i])[0] - d[0], y[i] = (*three[i])[1] - d[1];
  __int128 high = 0, low = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const __int128 lift = static_cast<__int128>(x[i]) * x[i] + static_cast<__int128>(y[i]) * y[i];
    const __int128 minor = static_cast<__int128>(x[j]) * y[k] - static_cast<__int128>(x[k]) * y[j];
    high += (lift >> 32) * minor;
    low += (lift & 0xffffffffu) * minor;
  }
  high += low >> 32;
  low &= 0xffffffffu;
  if (high != 0) return high > 0 ? 1 : -1;
  return low != 0;
}

}  // namespace

std::string sampled_check(Points points, const Triangulation& mesh, std::size_t samples) {
  const Grid& grid = mesh.statistics.grid;
  if (grid.cell_units > 0) return "the sampled check needs a grid whose cell is a power of two";
  const std::size_t count = mesh.triangles.size();
  if (mesh.neighbours.size() != count || mesh.constrained.size() != count) return "arrays of different lengths";
  std::uint64_t open = 0;
  for (const auto& links : mesh.neighbours)
    for (const std::int32_t link : links) open += link < 0;
  const std::uint64_t n = points.size() - mesh.statistics.vertices_merged;
  if (count + 2 + open != 2 * n) return "the number of triangles is not 2 n - 2 - h";
  test::Random random(42);
  for (std::size_t s = 0; s < samples && count > 0; ++s) {
    const std::size_t t = random.below(count);
    const std::string name = "triangle " + std::to_string(t);
    Corner corner[3];
    for (int k = 0; k < 3; ++k) {
      if (mesh.triangles[t][k] >= points.size()) return name + " has a corner that does not exist";
      corner[k] = on_grid(points, grid, mesh.triangles[t][k]);
    }
    if (orientation(corner[0], corner[1], corner[2]) <= 0) return name + " is not counter-clockwise";
    for (int k = 0; k < 3; ++k) {
      const std::int32_t link = mesh.neighbours[t][k];
      if (link < 0) continue;
      if (static_cast<std::size_t>(link) >= count) return name + " has a neighbour that does not exist";
      const auto& back = mesh.neighbours[link];
      const int side =
          static_cast<int>(std::find(back.begin(), back.end(), static_cast<std::int32_t>(t)) - back.begin());
      if (side == 3) return name + " has a neighbour that does not link back";
      const auto& other = mesh.triangles[link];
      if (other[(side + 1) % 3] != mesh.triangles[t][(k + 2) % 3] ||
          other[(side + 2) % 3] != mesh.triangles[t][(k + 1) % 3])
        return name + " and its neighbour do not share an edge";
      if (mesh.constrained[t] >> k & 1) continue;
      if (other[side] >= points.size()) return name + " has a neighbour with a corner that does not exist";
      const Corner apex = on_grid(points, grid, other[side]);
      const int inside = in_circle(corner[0], corner[1], corner[2], apex);
      // cocircular: the edge must be the diagonal through the least of the four
      const bool tie = inside == 0 && std::min({corner[0], corner[1], corner[2], apex}) !=
                                          std::min(corner[(k + 1) % 3], corner[(k + 2) % 3]);
      if (inside > 0 || tie) return name + " has an edge that is not locally Delaunay";
    }
  }
  return {};
}

}  // namespace gcdt::bench
