// SPDX-License-Identifier: Apache-2.0
#include "oracle.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

namespace gcdt::test {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_2 exact(const GridPoint& p) { return {static_cast<double>(p[0]), static_cast<double>(p[1])}; }

}  // namespace

int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return static_cast<int>(CGAL::orientation(exact(a), exact(b), exact(c)));
}

int in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  return static_cast<int>(CGAL::side_of_oriented_circle(exact(a), exact(b), exact(c), exact(d)));
}

bool between(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return orientation(a, b, c) == 0 && std::min(a, b) <= c && c <= std::max(a, b);
}

std::vector<GridPoint> on_grid(const std::vector<Point>& points, const Grid& grid) {
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

std::vector<std::uint32_t> representatives(const std::vector<GridPoint>& points) {
  std::map<GridPoint, std::uint32_t> first;
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < points.size(); ++i) result.push_back(first.emplace(points[i], i).first->second);
  return result;
}

bool cross(const std::vector<GridPoint>& points, const Segment& s, const Segment& t) {
  const GridPoint &a = points[s[0]], &b = points[s[1]], &c = points[t[0]], &d = points[t[1]];
  if (orientation(a, b, c) * orientation(a, b, d) >= 0 || orientation(c, d, a) * orientation(c, d, b) >= 0)
    return false;
  return std::none_of(points.begin(), points.end(),
                      [&](const GridPoint& p) { return orientation(a, b, p) == 0 && orientation(c, d, p) == 0; });
}

std::vector<std::array<std::uint64_t, 2>> crossings(const std::vector<GridPoint>& points,
                                                    const std::vector<Segment>& constraints) {
  std::vector<std::array<std::uint64_t, 2>> pairs;
  for (std::size_t c = 0; c < constraints.size(); ++c)
    for (std::size_t d = c + 1; d < constraints.size(); ++d)
      if (cross(points, constraints[c], constraints[d])) pairs.push_back({c, d});
  return pairs;
}

std::vector<std::uint32_t> dropped(const std::vector<GridPoint>& points, const std::vector<Segment>& constraints) {
  std::vector<std::uint32_t> kept, result;
  for (std::uint32_t c = 0; c < constraints.size(); ++c) {
    const bool crosses = std::any_of(kept.begin(), kept.end(),
                                     [&](std::uint32_t k) { return cross(points, constraints[c], constraints[k]); });
    (crosses ? result : kept).push_back(c);
  }
  return result;
}

std::map<Edge, std::vector<std::uint32_t>> pieces(const std::vector<GridPoint>& points,
                                                  const std::vector<Segment>& constraints,
                                                  const std::vector<std::uint32_t>& without) {
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

std::size_t triangle_count(const std::vector<GridPoint>& points) {
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

Edges classify_by(const std::vector<GridPoint>& points, Span<std::array<std::uint32_t, 3>> triangles,
                  const std::function<bool(const Edge&)>& constrained) {
  std::map<Edge, std::vector<GridPoint>> opposite;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) opposite[edge(points[t[(k + 1) % 3]], points[t[(k + 2) % 3]])].push_back(points[t[k]]);
  Edges edges;
  for (const auto& [e, corners] : opposite) {
    if (corners.size() > 2) throw std::runtime_error("an edge with more than two triangles");
    if (corners.size() < 2 || constrained(e)) {
      edges.decided.insert(e);
      continue;
    }
    const bool left = orientation(e.first, e.second, corners[0]) > 0;
    const GridPoint &p = corners[left ? 0 : 1], &q = corners[left ? 1 : 0];
    const int circle = in_circle(e.first, e.second, p, q);
    if (circle == 0) {
      edges.tied.insert(e);
      if (e.first != std::min({e.first, p, q})) edges.wrong.insert(e);
    } else {
      edges.decided.insert(e);
      if (circle > 0) edges.wrong.insert(e);
    }
  }
  return edges;
}

}  // namespace gcdt::test
