// SPDX-License-Identifier: Apache-2.0
// Slow, plain, exact statements about inputs and meshes on the grid, by CGAL's exact predicates and
// rational numbers: what the tests hold results against. Shares no code with the library. (CGAL's headers are read by
// oracle.cpp alone: they take longer to compile than a test.)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "workloads.hpp"

namespace gcdt::test {

using GridPoint = std::array<std::int64_t, 2>;
using Edge = std::pair<GridPoint, GridPoint>;  ///< ends in (X, Y) order
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// 1: c is left of ab, -1: right, 0: on the line.
int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c);

/// 1: d is inside the circle through the counter-clockwise triangle abc, -1: outside, 0: on it.
int in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d);

/// Whether c lies in the closed segment ab.
bool between(const GridPoint& a, const GridPoint& b, const GridPoint& c);

inline Edge edge(const GridPoint& a, const GridPoint& b) { return {std::min(a, b), std::max(a, b)}; }

/// The grid points of integer coordinates, unscaled.
inline std::vector<GridPoint> integers(const std::vector<Point>& points) {
  std::vector<GridPoint> result;
  for (const Point& p : points) result.push_back({static_cast<std::int64_t>(p[0]), static_cast<std::int64_t>(p[1])});
  return result;
}

/// Moved so that the least X and the least Y are 0.
inline std::vector<GridPoint> from_zero(std::vector<GridPoint> points) {
  for (int axis = 0; axis < 2; ++axis) {
    std::int64_t least = points.empty() ? 0 : points[0][axis];
    for (const GridPoint& p : points) least = std::min(least, p[axis]);
    for (GridPoint& p : points) p[axis] -= least;
  }
  return points;
}

/// round((p - origin) / cell), half to even, in rational arithmetic. On a decimal grid coordinates and
/// origin are the decimals they stand for.
std::vector<GridPoint> on_grid(const std::vector<Point>& points, const Grid& grid);

/// For each vertex the least number of its grid point.
std::vector<std::uint32_t> representatives(const std::vector<GridPoint>& points);

/// docs/contract.md, 3: whether two constraints cross, that is, properly and not at a vertex.
bool cross(const std::vector<GridPoint>& points, const Segment& s, const Segment& t);

/// All crossing pairs (c, d), c < d, in that order.
std::vector<std::array<std::uint64_t, 2>> crossings(const std::vector<GridPoint>& points,
                                                    const std::vector<Segment>& constraints);

/// docs/contract.md, 3, `drop`: the constraints that cross an earlier kept one, ascending.
std::vector<std::uint32_t> dropped(const std::vector<GridPoint>& points, const std::vector<Segment>& constraints);

/// docs/contract.md, 3: every piece of the constraints (but those in `without`) with its sources, ascending.
std::map<Edge, std::vector<std::uint32_t>> pieces(const std::vector<GridPoint>& points,
                                                  const std::vector<Segment>& constraints,
                                                  const std::vector<std::uint32_t>& without = {});

/// 2n - 2 - h with n the distinct vertices and h those on the hull's boundary; 0 where docs/contract.md, 4, says so.
std::size_t triangle_count(const std::vector<GridPoint>& points);

/// The Z-order of a grid point: bit 2i is bit i of X, bit 2i + 1 is bit i of Y.
inline std::uint64_t morton(const GridPoint& p) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 31; ++bit)
    code |= static_cast<std::uint64_t>(p[0] >> bit & 1) << (2 * bit) | static_cast<std::uint64_t>(p[1] >> bit & 1)
                                                                           << (2 * bit + 1);
  return code;
}

/// A mesh's edges, sorted apart by what decides them.
struct Edges {
  std::set<Edge> decided;  ///< on the hull, constrained, or strictly locally Delaunay
  std::set<Edge> tied;     ///< unconstrained, the four vertices cocircular
  std::set<Edge> wrong;    ///< not locally Delaunay, or tied and against the tie rule
};

/// Every edge of `triangles`; whether it is `constrained`. A CDT of one input has one set `decided`,
/// and by the tie rule one set `tied`; another CDT of it shares the first only.
Edges classify_by(const std::vector<GridPoint>& points, Span<std::array<std::uint32_t, 3>> triangles,
                  const std::function<bool(const Edge&)>& constrained);

/// The same; `constrained` are the pieces, a set or a map.
template <class Pieces>
Edges classify(const std::vector<GridPoint>& points, Span<std::array<std::uint32_t, 3>> triangles,
               const Pieces& constrained) {
  return classify_by(points, triangles, [&](const Edge& e) { return constrained.count(e) != 0; });
}

}  // namespace gcdt::test
