// SPDX-License-Identifier: Apache-2.0
#include "split_oracle.hpp"

#include <algorithm>

namespace oracle {

namespace {

int sign_of(const Integer& v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

std::int64_t half_up(const Rational& v) { return static_cast<std::int64_t>(floor_of(v + Rational(1, 2))); }

void sort_along(Links& vertices, const GridPair& a, const GridPair& b) {
  const Integer dx = b[0] - a[0], dy = b[1] - a[1];
  std::sort(vertices.begin(), vertices.end(),
            [&](const GridPair& p, const GridPair& q) { return dx * p[0] + dy * p[1] < dx * q[0] + dy * q[1]; });
}

}  // namespace

Integer turn(const GridPair& a, const GridPair& b, const GridPair& c) {
  return Integer(b[0] - a[0]) * Integer(c[1] - a[1]) - Integer(b[1] - a[1]) * Integer(c[0] - a[0]);
}

std::optional<std::array<Rational, 2>> crossing(const GridPair& a, const GridPair& b, const GridPair& c,
                                                const GridPair& d) {
  const Integer p = turn(c, d, a), q = turn(c, d, b);
  if (sign_of(p) * sign_of(q) >= 0 || sign_of(turn(a, b, c)) * sign_of(turn(a, b, d)) >= 0) return std::nullopt;
  const Rational t = Rational(p) / Rational(Integer(p - q));
  return std::array<Rational, 2>{Rational(a[0]) + t * Rational(b[0] - a[0]),
                                 Rational(a[1]) + t * Rational(b[1] - a[1])};
}

bool meets(const GridPair& a, const GridPair& b, const GridPair& h) {
  Rational from = 0, to = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const Rational low = Rational(2 * h[axis] - 1, 2), high = Rational(2 * h[axis] + 1, 2);
    const std::int64_t length = b[axis] - a[axis];
    if (length == 0) {
      if (Rational(a[axis]) < low || Rational(a[axis]) > high) return false;
      continue;
    }
    Rational enter = (low - a[axis]) / length, leave = (high - a[axis]) / length;
    if (enter > leave) std::swap(enter, leave);
    from = std::max(from, enter);
    to = std::min(to, leave);
  }
  if (from > to) return false;
  const Rational t = (from + to) / 2;
  for (int axis = 0; axis < 2; ++axis)
    if (half_up(Rational(a[axis]) + t * Rational(b[axis] - a[axis])) != h[axis]) return false;
  return true;
}

Split split(const std::vector<GridPair>& points, const std::vector<gcdt::Constraint>& constraints) {
  Split result;
  const std::set<GridPair> input(points.begin(), points.end());
  std::set<GridPair> hot = input;
  std::map<GridPair, std::array<std::uint32_t, 2>> pixels;
  auto ends = [&](std::uint32_t c) {
    return std::array<GridPair, 2>{points[constraints[c][0]], points[constraints[c][1]]};
  };
  const auto count = static_cast<std::uint32_t>(constraints.size());
  for (std::uint32_t c = 0; c < count; ++c)
    for (std::uint32_t d = c + 1; d < count; ++d) {
      const auto x = crossing(ends(c)[0], ends(c)[1], ends(d)[0], ends(d)[1]);
      if (!x) continue;
      const GridPair pixel = {half_up((*x)[0]), half_up((*x)[1])};
      if ((*x)[0] == pixel[0] && (*x)[1] == pixel[1] && input.count(pixel)) continue;
      ++result.crossings;
      pixels.insert({pixel, {c, d}});  // pairs come in order: the first is the least
      result.moved.insert({c, d});
      hot.insert(pixel);
    }
  for (const auto& [pixel, pair] : pixels)
    if (!input.count(pixel)) result.added[pixel] = pair;
  result.links.resize(count);
  auto link = [&](std::uint32_t c) {
    const auto [a, b] = ends(c);
    Links& links = result.links[c];
    links.clear();
    if (a == b) return;
    for (const GridPair& h : hot)
      if (result.moved.count(c) ? meets(a, b, h) : turn(a, b, h) == 0 && meets(a, b, h)) links.push_back(h);
    sort_along(links, a, b);
  };
  for (std::uint32_t c = 0; c < count; ++c) link(c);
  for (bool more = true; more;) {
    more = false;
    std::set<std::uint32_t> next;
    for (std::uint32_t c = 0; c < count; ++c) {
      if (result.moved.count(c)) continue;
      for (std::uint32_t d : result.moved)
        for (std::size_t i = 0; i + 1 < result.links[d].size(); ++i)
          if (crossing(ends(c)[0], ends(c)[1], result.links[d][i], result.links[d][i + 1])) next.insert(c);
    }
    for (std::uint32_t c : next) {
      result.moved.insert(c);
      link(c);
      more = true;
    }
  }
  for (std::uint32_t c = 0; c < count; ++c)
    for (std::size_t i = 0; i + 1 < result.links[c].size(); ++i)
      result.pieces[edge_of(result.links[c][i], result.links[c][i + 1])].push_back(c);
  return result;
}

}  // namespace oracle
