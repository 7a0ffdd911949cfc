// SPDX-License-Identifier: Apache-2.0
// Slow, plain, exact statements about inputs and meshes on the grid, by CGAL's exact predicates and
// rational numbers: what the tests hold results against. Shares no code with the library.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <gcdt/gcdt.hpp>

#include "workloads.hpp"

namespace gcdt::test {

using GridPoint = std::array<std::int64_t, 2>;
using Edge = std::pair<GridPoint, GridPoint>;  ///< ends in (X, Y) order
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

inline Kernel::Point_2 exact(const GridPoint& p) { return {static_cast<double>(p[0]), static_cast<double>(p[1])}; }

/// 1: c is left of ab, -1: right, 0: on the line.
inline int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return static_cast<int>(CGAL::orientation(exact(a), exact(b), exact(c)));
}

inline bool between(const GridPoint& a, const GridPoint& b, const GridPoint& c) {  // c in the closed segment ab
  return orientation(a, b, c) == 0 && std::min(a, b) <= c && c <= std::max(a, b);
}

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
inline std::vector<GridPoint> on_grid(const std::vector<Point>& points, const Grid& grid) {
  using Rational = CGAL::Exact_rational;
  const auto power = [](int base, int exponent) {
    Rational result = 1;
    for (int i = 0; i < std::abs(exponent); ++i) result *= base;
    return exponent < 0 ? Rational(1) / result : result;
  };
  Rational cell = power(2, grid.cell_exponent);
  if (grid.cell_units > 0) cell = power(10, -grid.cell_decimals) * Rational(static_cast<long>(grid.cell_units));
  const auto rounded = [](const Rational& value) {        // by bisection: needs no numerator
    std::int64_t low = -1, high = std::int64_t{1} << 62;  // low <= value < high
    while (high - low > 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (Rational(static_cast<long>(middle)) <= value ? low : high) = middle;
    }
    const Rational rest = value - Rational(static_cast<long>(low)), half = Rational(1) / Rational(2);
    return rest > half || (rest == half && low % 2 != 0) ? low + 1 : low;
  };
  const auto decimal = [&](double value) {  // the nearest multiple of the cell
    const Rational size = Rational(std::fabs(value)) / cell;
    const Rational units = Rational(static_cast<long>(rounded(size))) * cell;
    return Rational(value < 0 ? Rational(-units) : units);
  };
  std::vector<GridPoint> result;
  for (const Point& p : points) {
    GridPoint g{};
    for (int axis = 0; axis < 2; ++axis) {
      const bool written = grid.kind == Grid::Kind::decimal;
      const Rational x = written ? decimal(p[axis]) : Rational(p[axis]);
      const Rational origin = written ? decimal(grid.origin[axis]) : Rational(grid.origin[axis]);
      g[axis] = rounded(Rational((x - origin) / cell));
    }
    result.push_back(g);
  }
  return result;
}

/// For each vertex the least number of its grid point.
inline std::vector<std::uint32_t> representatives(const std::vector<GridPoint>& points) {
  std::map<GridPoint, std::uint32_t> first;
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < points.size(); ++i) result.push_back(first.emplace(points[i], i).first->second);
  return result;
}

/// docs/contract.md, 3: whether two constraints cross, that is, properly and not at a vertex.
inline bool cross(const std::vector<GridPoint>& points, const Segment& s, const Segment& t) {
  const GridPoint &a = points[s[0]], &b = points[s[1]], &c = points[t[0]], &d = points[t[1]];
  if (orientation(a, b, c) * orientation(a, b, d) >= 0 || orientation(c, d, a) * orientation(c, d, b) >= 0)
    return false;
  return std::none_of(points.begin(), points.end(),
                      [&](const GridPoint& p) { return orientation(a, b, p) == 0 && orientation(c, d, p) == 0; });
}

/// All crossing pairs (c, d), c < d, in that order.
inline std::vector<std::array<std::uint64_t, 2>> crossings(const std::vector<GridPoint>& points,
                                                           const std::vector<Segment>& constraints) {
  std::vector<std::array<std::uint64_t, 2>> pairs;
  for (std::size_t c = 0; c < constraints.size(); ++c)
    for (std::size_t d = c + 1; d < constraints.size(); ++d)
      if (cross(points, constraints[c], constraints[d])) pairs.push_back({c, d});
  return pairs;
}

/// docs/contract.md, 3, `drop`: the constraints that cross an earlier kept one, ascending.
inline std::vector<std::uint32_t> dropped(const std::vector<GridPoint>& points,
                                          const std::vector<Segment>& constraints) {
  std::vector<std::uint32_t> kept, result;
  for (std::uint32_t c = 0; c < constraints.size(); ++c) {
    const bool crosses = std::any_of(kept.begin(), kept.end(),
                                     [&](std::uint32_t k) { return cross(points, constraints[c], constraints[k]); });
    (crosses ? result : kept).push_back(c);
  }
  return result;
}

/// docs/contract.md, 3: every piece of the constraints (but those in `without`) with its sources, ascending.
inline std::map<Edge, std::vector<std::uint32_t>> pieces(const std::vector<GridPoint>& points,
                                                         const std::vector<Segment>& constraints,
                                                         const std::vector<std::uint32_t>& without = {}) {
  std::map<Edge, std::vector<std::uint32_t>> result;
  for (std::uint32_t c = 0; c < constraints.size(); ++c) {
    if (std::binary_search(without.begin(), without.end(), c)) continue;
    const GridPoint &a = points[constraints[c][0]], &b = points[constraints[c][1]];
    std::set<GridPoint> chain;
    for (const GridPoint& p : points)
      if (between(a, b, p)) chain.insert(p);
    if (a == b) continue;
    for (auto p = chain.begin(), q = std::next(p); q != chain.end(); ++p, ++q) result[edge(*p, *q)].push_back(c);
  }
  return result;
}

/// 2n - 2 - h with n the distinct vertices and h those on the hull's boundary; 0 where docs/contract.md, 4, says so.
inline std::size_t triangle_count(const std::vector<GridPoint>& points) {
  std::vector<GridPoint> sorted = points;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return 0;
  std::set<GridPoint> boundary;
  for (int side : {1, -1}) {  // lower and upper chain, collinear points kept
    std::vector<GridPoint> chain;
    for (const GridPoint& p : sorted) {
      while (chain.size() > 1 && side * orientation(chain[chain.size() - 2], chain.back(), p) < 0) chain.pop_back();
      chain.push_back(p);
    }
    if (side == 1 && std::all_of(sorted.begin(), sorted.end(),
                                 [&](const GridPoint& p) { return orientation(sorted[0], sorted.back(), p) == 0; }))
      return 0;
    boundary.insert(chain.begin(), chain.end());
  }
  return 2 * sorted.size() - 2 - boundary.size();
}

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

/// Every edge of `triangles`; `constrained` are the pieces. A CDT of one input has one set `decided`,
/// and by the tie rule one set `tied`; another CDT of it shares the first only.
template <class Pieces>
Edges classify(const std::vector<GridPoint>& points, Span<std::array<std::uint32_t, 3>> triangles,
               const Pieces& constrained) {
  std::map<Edge, std::vector<GridPoint>> opposite;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) opposite[edge(points[t[(k + 1) % 3]], points[t[(k + 2) % 3]])].push_back(points[t[k]]);
  Edges edges;
  for (const auto& [e, corners] : opposite) {
    if (corners.size() > 2) throw std::runtime_error("an edge with more than two triangles");
    if (corners.size() < 2 || constrained.count(e)) {
      edges.decided.insert(e);
      continue;
    }
    const bool left = orientation(e.first, e.second, corners[0]) > 0;
    const GridPoint &p = corners[left ? 0 : 1], &q = corners[left ? 1 : 0];
    const auto circle = CGAL::side_of_oriented_circle(exact(e.first), exact(e.second), exact(p), exact(q));
    if (circle == CGAL::ON_ORIENTED_BOUNDARY) {
      edges.tied.insert(e);
      if (e.first != std::min({e.first, p, q})) edges.wrong.insert(e);
    } else {
      edges.decided.insert(e);
      if (circle == CGAL::ON_POSITIVE_SIDE) edges.wrong.insert(e);
    }
  }
  return edges;
}

}  // namespace gcdt::test
