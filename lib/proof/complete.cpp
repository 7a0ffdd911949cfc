// SPDX-License-Identifier: Apache-2.0
#include "proof/complete.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace gcdt::proof {

Completion::Completion(const Sites& sites, std::uint64_t& steps)
    : sites_(sites), steps_(steps), leaving_(sites.at.size(), none), cavity_(sites, steps) {
  DelaunayMesh mesh = delaunay(sites, steps);
  triangles_ = std::move(mesh.triangles);
  twins_ = std::move(mesh.twins);
  constrained_.assign(twins_.size(), 0);
  place_.assign(twins_.size(), none);
  for (std::uint32_t h = 0; h < twins_.size(); ++h) leaving_[from(h)] = h;
}

void Completion::put(std::uint32_t t, const Corners& corners, const std::array<Side, 3>& sides) {
  triangles_[t] = corners;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t h = 3 * t + k;
    twins_[h] = sides[k].twin;
    constrained_[h] = sides[k].constrained;
    if (sides[k].twin != none) twins_[sides[k].twin] = h;
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
  return inside_circle(sites_, from(h), to(h), apex(h), apex(twins_[h]));
}

/// Lawson's flips. A suspect that has moved by now was made a suspect again by the flip that moved it.
void Completion::restore() {
  while (!suspects_.empty()) {
    const std::uint32_t h = suspects_.back();
    suspects_.pop_back();
    ++steps_;
    if (!must_flip(h)) continue;
    const std::uint32_t t = h / 3, u = twins_[h] / 3;
    flip(h);
    for (const std::uint32_t s : {3 * t, 3 * t + 2, 3 * u, 3 * u + 1}) suspects_.push_back(s);
  }
}

/// Looks around a vertex for what the segment to another one meets first, one triangle at a time.
class Completion::Search {
 public:
  Search(const Completion& mesh, std::uint32_t v, std::uint32_t w)
      : mesh_(mesh), v_(v), w_(w), start_(mesh.leaving_[v]), h_(start_) {}

  /// Looks at a triangle; true: `found` is set, to a half-edge `none` if the mesh does not cover the segment.
  bool look(Step& found) {
    found = {false, none, none};
    if (h_ == none) return true;
    const std::uint32_t a = mesh_.to(h_), b = mesh_.apex(h_);
    const std::int64_t left = mesh_.sites_.turn(v_, a, w_), right = mesh_.sites_.turn(v_, b, w_);
    if (left == 0 && ahead(a)) found = {true, h_, a};
    if (right == 0 && ahead(b)) found = {true, previous(h_), b};
    if (left > 0 && right < 0) found = {false, next(h_), none};
    if (found.half_edge != none) return true;
    move();
    return false;
  }

 private:
  bool ahead(std::uint32_t x) const {
    const Direction towards(mesh_.sites_.at[v_], mesh_.sites_.at[w_]), d(mesh_.sites_.at[v_], mesh_.sites_.at[x]);
    return static_cast<Wide>(d.x) * towards.x + static_cast<Wide>(d.y) * towards.y > 0;
  }
  /// Counter-clockwise all around, or up to the hull and then clockwise from where it began.
  void move() {
    if (!clockwise_) {
      h_ = mesh_.twins_[previous(h_)];
      if (h_ == start_)
        h_ = none;
      else if (h_ == none)
        clockwise_ = true, h_ = start_;
      if (!clockwise_) return;
    }
    h_ = mesh_.twins_[h_];
    if (h_ != none) h_ = next(h_);
  }

  const Completion& mesh_;
  const std::uint32_t v_, w_, start_;
  std::uint32_t h_;
  bool clockwise_ = false;
};

/// Follows the segment from v towards w, which begins with `step`, to the next vertex on it, and returns that; none if
/// it crosses a constraint. `part` has what it crosses, as seen from v.
std::uint32_t Completion::follow(std::uint32_t v, std::uint32_t w, const Step& step, Part& part) {
  part.half_edge = none;
  part.crossed.clear();
  if (step.along_edge) {
    part.half_edge = step.half_edge;
    return step.end;
  }
  for (std::uint32_t h = step.half_edge; h != none && !constrained_[h];) {
    ++steps_;
    part.crossed.push_back(h);
    h = twins_[h];
    if (h == none) return none;
    const std::int64_t at_apex = sites_.turn(v, w, apex(h));
    if (at_apex == 0) return apex(h);
    // h runs from left to right of the segment as seen from behind it.
    h = at_apex > 0 ? next(h) : previous(h);
  }
  return none;
}

/// The parts of a segment, in any order, from both ends inwards; false if it crosses a constraint.
bool Completion::find_parts(std::uint32_t a, std::uint32_t b, std::vector<Part>& parts) {
  for (parts.clear(); a != b;) {
    Search from_a(*this, a, b), from_b(*this, b, a);
    Step step;
    bool at_a;
    do {
      ++steps_;
      at_a = from_a.look(step);
    } while (!at_a && !from_b.look(step));
    parts.emplace_back();
    std::uint32_t& end = at_a ? a : b;
    end = at_a ? follow(a, b, step, parts.back()) : follow(b, a, step, parts.back());
    if (end == none) return false;
  }
  return true;
}

void Completion::constrain_edge(std::uint32_t h) {
  constrained_[h] = 1;
  if (twins_[h] != none) constrained_[twins_[h]] = 1;
}

bool Completion::constrain(std::uint32_t a, std::uint32_t b) {
  std::vector<Part> parts;
  if (!find_parts(a, b, parts)) return false;
  // No triangle is crossed by two parts, so one leaves the half-edges of the others as they are.
  for (const Part& part : parts)
    if (part.half_edge != none)
      constrain_edge(part.half_edge);
    else
      replace_crossed(part.crossed);
  restore();
  return true;
}

/// Puts a new edge from the first vertex of a segment to its last in the place of the edges that it crosses.
void Completion::replace_crossed(const std::vector<std::uint32_t>& crossed) {
  // The triangles, and their half-edges that are not crossed: on the left against the segment, on the right along it.
  std::vector<std::uint32_t> free = {crossed.front() / 3}, left = {next(crossed.front())},
                             right = {previous(crossed.front())};
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    const std::uint32_t h = twins_[crossed[i]], following = i + 1 < crossed.size() ? crossed[i + 1] : none;
    free.push_back(h / 3);
    if (following != next(h)) right.push_back(next(h));
    if (following != previous(h)) left.push_back(previous(h));
  }
  std::reverse(left.begin(), left.end());
  const Border on_left = border(left), on_right = border(right);
  const std::uint32_t h = fill(on_left, free.data()), g = fill(on_right, free.data() + left.size() - 1);
  twins_[h] = g;
  twins_[g] = h;
  constrain_edge(h);
}

Completion::Border Completion::border(const std::vector<std::uint32_t>& path) {
  Border made;
  for (std::uint32_t i = 0; i < path.size(); ++i) {
    made.vertices.push_back(from(path[i]));
    made.outer.push_back(side(path[i]));
    place_[path[i]] = i;
  }
  made.vertices.push_back(to(path.back()));
  for (const Side& outer : made.outer) made.beyond.push_back(outer.twin == none ? none : place_[outer.twin]);
  for (const std::uint32_t h : path) place_[h] = none;
  return made;
}

/// Triangulates the polygon of a border and a new edge from its end to its begin, and returns that. The triangles take
/// the numbers `free`, one less than the border has edges.
std::uint32_t Completion::fill(const Border& border, const std::uint32_t* free) {
  cavity_.triangulate(border.vertices);
  const auto placed = [&](std::uint32_t h) { return 3 * free[h / 3] + h % 3; };
  for (std::uint32_t h = 0; h < 3 * cavity_.triangles().size(); ++h) {
    triangles_[free[h / 3]][h % 3] = border.vertices[cavity_.triangles()[h / 3][h % 3]];
    twins_[placed(h)] = cavity_.twin(h) == none ? none : placed(cavity_.twin(h));
    constrained_[placed(h)] = 0;
    suspects_.push_back(placed(h));
  }
  for (std::uint32_t i = 0; i < border.outer.size(); ++i) {
    const std::uint32_t h = placed(cavity_.along(i));
    twins_[h] = border.beyond[i] == none ? border.outer[i].twin : placed(cavity_.along(border.beyond[i]));
    if (twins_[h] != none) twins_[twins_[h]] = h;
    constrained_[h] = border.outer[i].constrained;
  }
  for (std::uint32_t h = 0; h < 3 * cavity_.triangles().size(); ++h) leaving_[from(placed(h))] = placed(h);
  return placed(cavity_.along(static_cast<std::uint32_t>(border.outer.size())));
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
  // Of the first and the second corner, and the half-edge across from the first.
  std::vector<std::tuple<std::uint64_t, std::uint64_t, std::uint32_t>> places;
  for (std::uint32_t h = 0; h < twins_.size(); ++h)
    if (z[apex(h)] < z[from(h)] && z[apex(h)] < z[to(h)]) places.emplace_back(z[apex(h)], z[from(h)], h);
  std::sort(places.begin(), places.end());
  std::vector<std::uint32_t> moved(twins_.size());
  for (std::uint32_t t = 0; t < places.size(); ++t)
    for (std::uint32_t k = 0, h = std::get<2>(places[t]); k < 3; ++k, h = next(h)) moved[h] = 3 * t + k;
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
