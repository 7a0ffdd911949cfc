// SPDX-License-Identifier: Apache-2.0
#include "verify_complete.hpp"

#include <algorithm>
#include <deque>
#include <utility>

namespace gcdt::proof {

Completion::Completion(const Sites& sites)
    : sites_(sites),
      leaving_(sites.at.size(), none),
      hull_next_(sites.at.size(), none),
      hull_previous_(sites.at.size(), none),
      hull_edge_(sites.at.size(), none) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < sites.at.size(); ++v)
    if (sites.is_representative(v)) order.push_back(v);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return before(sites.at[a], sites.at[b]); });
  std::size_t line = 2;  // how many vertices from the first on are on one line
  while (turn(order[0], order[1], order[line]) == 0) ++line;
  start(order, line);
  for (std::size_t i = line + 1; i < order.size(); ++i) {
    append(order[i], order[i - 1]);
    restore();
  }
}

std::uint32_t Completion::add(const Corners& corners) {
  const auto t = static_cast<std::uint32_t>(triangles_.size());
  triangles_.push_back(corners);
  twins_.resize(3 * triangles_.size(), none);
  constrained_.resize(3 * triangles_.size(), 0);
  for (std::uint32_t k = 0; k < 3; ++k) leaving_[from(3 * t + k)] = 3 * t + k;
  return t;
}

/// The fan over the first `line` vertices, which are on one line, from the vertex after them.
void Completion::start(const std::vector<std::uint32_t>& order, std::size_t line) {
  const std::uint32_t tip = order[line];
  const bool left = turn(order[0], order[1], tip) > 0;
  std::vector<std::uint32_t> base(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(line));
  if (!left) std::reverse(base.begin(), base.end());
  for (std::size_t i = 0; i + 1 < base.size(); ++i) {
    const std::uint32_t t = add({base[i], base[i + 1], tip});
    hull_next_[base[i]] = base[i + 1];
    hull_edge_[base[i]] = 3 * t + 2;
    if (i == 0) continue;
    twins_[3 * t + 1] = 3 * (t - 1);
    twins_[3 * (t - 1)] = 3 * t + 1;
  }
  hull_next_[base.back()] = tip;
  hull_edge_[base.back()] = 3 * static_cast<std::uint32_t>(triangles_.size() - 1);
  hull_next_[tip] = base.front();
  hull_edge_[tip] = 1;
  for (const std::uint32_t v : base) hull_previous_[hull_next_[v]] = v;
  hull_previous_[base.front()] = tip;
  for (std::uint32_t h = 0; h < twins_.size(); ++h) suspects_.push_back(h);
  restore();
}

/// Joins v, which comes after all others, to the edges of the hull that it sees; the vertex `last` is on one.
void Completion::append(std::uint32_t v, std::uint32_t last) {
  std::uint32_t first = last, end = last;
  while (turn(first, hull_previous_[first], v) > 0) first = hull_previous_[first];
  while (turn(end, hull_next_[end], v) < 0) end = hull_next_[end];
  std::uint32_t before_t = none;
  for (std::uint32_t a = first; a != end;) {
    const std::uint32_t b = hull_next_[a], edge = hull_edge_[a];
    const std::uint32_t t = add({b, a, v});
    twins_[3 * t + 2] = edge;
    twins_[edge] = 3 * t + 2;
    if (before_t == none) {
      hull_edge_[first] = 3 * t;
    } else {
      twins_[3 * t] = 3 * before_t + 1;
      twins_[3 * before_t + 1] = 3 * t;
    }
    before_t = t;
    suspects_.push_back(3 * t + 2);
    a = b;
  }
  hull_edge_[v] = 3 * before_t + 1;
  hull_next_[first] = v;
  hull_previous_[v] = first;
  hull_next_[v] = end;
  hull_previous_[end] = v;
}

void Completion::put(std::uint32_t t, const Corners& corners, const std::array<Side, 3>& sides) {
  triangles_[t] = corners;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t h = 3 * t + k;
    twins_[h] = sides[k].twin;
    constrained_[h] = sides[k].constrained;
    if (sides[k].twin == none)
      hull_edge_[from(h)] = h;
    else
      twins_[sides[k].twin] = h;
    leaving_[from(h)] = h;
  }
}

// t = (p, a, b), u = (q, b, a)  become  t = (p, a, q), u = (p, q, b)
void Completion::flip(std::uint32_t h) {
  const std::uint32_t g = twins_[h], t = h / 3, u = g / 3;
  const std::uint32_t p = apex(h), a = from(h), b = to(h), q = apex(g);
  const Side bp = side(next(h)), pa = side(previous(h)), aq = side(next(g)), qb = side(previous(g));
  put(t, {p, a, q}, {aq, Side{3 * u + 2, false}, pa});
  put(u, {p, q, b}, {qb, bp, Side{3 * t + 1, false}});
}

bool Completion::must_flip(std::uint32_t h) const {
  if (twins_[h] == none || constrained_[h]) return false;
  const Vertex a = sites_.at[from(h)], b = sites_.at[to(h)], c = sites_.at[apex(h)], d = sites_.at[apex(twins_[h])];
  const Wide inside = incircle(a, b, c, d);
  if (inside != 0) return inside > 0;
  return before(before(c, d) ? c : d, before(a, b) ? a : b);
}

/// Lawson's flips. A suspect that has moved by now was made a suspect again by the flip that moved it.
void Completion::restore() {
  while (!suspects_.empty()) {
    const std::uint32_t h = suspects_.back();
    suspects_.pop_back();
    if (!must_flip(h)) continue;
    const std::uint32_t t = h / 3, u = twins_[h] / 3;
    flip(h);
    for (const std::uint32_t s : {3 * t, 3 * t + 2, 3 * u, 3 * u + 1}) suspects_.push_back(s);
  }
}

/// Calls visit(h) for one half-edge v -> w of each triangle at v, until it returns true.
template <class Visit>
void Completion::around(std::uint32_t v, Visit&& visit) const {
  const std::uint32_t start = leaving_[v];
  std::uint32_t h = start;
  do {
    if (visit(h)) return;
    h = twins_[previous(h)];
  } while (h != none && h != start);
  if (h == start) return;
  for (h = twins_[start]; h != none; h = twins_[h]) {
    h = next(h);
    if (visit(h)) return;
  }
}

/// What the segment from v to w meets first.
Completion::Step Completion::leave(std::uint32_t v, std::uint32_t w) const {
  Step found = {false, none, none};
  const Direction towards(sites_.at[v], sites_.at[w]);
  auto ahead = [&](std::uint32_t x) {
    const Direction d(sites_.at[v], sites_.at[x]);
    return static_cast<Wide>(d.x) * towards.x + static_cast<Wide>(d.y) * towards.y > 0;
  };
  around(v, [&](std::uint32_t h) {
    const std::uint32_t a = to(h), b = apex(h);
    const std::int64_t left = turn(v, a, w), right = turn(v, b, w);
    if (left == 0 && ahead(a)) found = {true, h, a};
    if (right == 0 && ahead(b)) found = {true, previous(h), b};
    if (left > 0 && right < 0) found = {false, next(h), none};
    return found.half_edge != none;
  });
  return found;
}

/// The half-edge between a and b, in either direction; none if there is no such edge.
std::uint32_t Completion::find(std::uint32_t a, std::uint32_t b) const {
  std::uint32_t found = none;
  around(a, [&](std::uint32_t h) {
    if (to(h) == b) found = h;
    if (apex(h) == b) found = previous(h);
    return found != none;
  });
  return found;
}

/// The interiors of ab and pq meet in one point.
bool Completion::crosses(std::uint32_t a, std::uint32_t b, std::uint32_t p, std::uint32_t q) const {
  auto apart = [](std::int64_t s, std::int64_t t) { return (s < 0 && t > 0) || (s > 0 && t < 0); };
  return apart(turn(a, b, p), turn(a, b, q)) && apart(turn(p, q, a), turn(p, q, b));
}

/// Calls visit(h) for each half-edge that the segment from v towards w crosses up to the first vertex on it, and
/// returns that vertex; none if visit returned true.
template <class Visit>
std::uint32_t Completion::cross(std::uint32_t v, std::uint32_t w, Visit&& visit) const {
  const Step step = leave(v, w);
  if (step.along_edge) return step.end;
  for (std::uint32_t h = step.half_edge;;) {
    if (visit(h)) return none;
    h = twins_[h];
    const std::int64_t at_apex = turn(v, w, apex(h));
    if (at_apex == 0) return apex(h);
    // h runs from left to right of the segment as seen from behind it.
    h = at_apex > 0 ? next(h) : previous(h);
  }
}

bool Completion::is_free(std::uint32_t a, std::uint32_t b) const {
  for (std::uint32_t v = a; v != b && v != none;) {
    v = cross(v, b, [&](std::uint32_t h) { return constrained_[h] != 0; });
    if (v == none) return false;
  }
  return true;
}

/// Flips edges away until a and b, between which there is no vertex, are joined. Where a flip leaves an edge in the
/// way, chance decides, so that it ends.
void Completion::clear(std::uint32_t a, std::uint32_t b) {
  std::deque<std::array<std::uint32_t, 2>> in_the_way;
  cross(a, b, [&](std::uint32_t h) {
    in_the_way.push_back({from(h), to(h)});
    return false;
  });
  while (!in_the_way.empty()) {
    const auto [x, y] = in_the_way.front();
    in_the_way.pop_front();
    const std::uint32_t h = find(x, y);
    const std::uint32_t p = apex(h), q = apex(twins_[h]);
    const bool convex = crosses(p, q, x, y), still = crosses(a, b, p, q);
    if (!convex || (still && random_() % 2)) {
      in_the_way.push_back({x, y});
      continue;
    }
    const std::uint32_t t = h / 3, u = twins_[h] / 3;
    flip(h);
    for (const std::uint32_t s : {3 * t, 3 * t + 1, 3 * t + 2, 3 * u, 3 * u + 1}) suspects_.push_back(s);
    if (still) in_the_way.push_back({p, q});
  }
}

bool Completion::constrain(std::uint32_t a, std::uint32_t b) {
  if (!is_free(a, b)) return false;
  for (std::uint32_t v = a; v != b;) {
    const std::uint32_t w = cross(v, b, [](std::uint32_t) { return false; });
    clear(v, w);
    const std::uint32_t h = find(v, w);
    constrained_[h] = 1;
    if (twins_[h] != none) constrained_[twins_[h]] = 1;
    v = w;
  }
  restore();
  return true;
}

namespace {

std::uint64_t z_order(Vertex v) {
  std::uint64_t code = 0;
  for (int i = 0; i < 31; ++i)
    code |= (std::uint64_t(v.x) >> i & 1) << 2 * i | (std::uint64_t(v.y) >> i & 1) << (2 * i + 1);
  return code;
}

}  // namespace

void Completion::sort() {
  std::vector<std::uint64_t> z(sites_.at.size());
  for (std::size_t v = 0; v < z.size(); ++v) z[v] = z_order(sites_.at[v]);
  struct Place {
    std::uint64_t first, second;
    std::uint32_t half_edge;  // the one across from the first corner
  };
  std::vector<Place> places;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    std::uint32_t k = 0;
    for (std::uint32_t j = 1; j < 3; ++j)
      if (z[triangles_[t][j]] < z[triangles_[t][k]]) k = j;
    places.push_back({z[triangles_[t][k]], z[triangles_[t][(k + 1) % 3]], 3 * t + k});
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return std::pair(a.first, a.second) < std::pair(b.first, b.second); });
  std::vector<std::uint32_t> moved(twins_.size());
  for (std::uint32_t t = 0; t < places.size(); ++t)
    for (std::uint32_t k = 0, h = places[t].half_edge; k < 3; ++k, h = next(h)) moved[h] = 3 * t + k;
  const auto corners = triangles_;
  const auto twins = twins_;
  const auto constrained = constrained_;
  for (std::uint32_t h = 0; h < moved.size(); ++h) {
    triangles_[moved[h] / 3][moved[h] % 3] = corners[h / 3][h % 3];
    twins_[moved[h]] = twins[h] == none ? none : moved[twins[h]];
    constrained_[moved[h]] = constrained[h];
  }
  for (std::uint32_t h = 0; h < moved.size(); ++h) leaving_[from(h)] = h;
}

}  // namespace gcdt::proof
