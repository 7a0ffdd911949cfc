// SPDX-License-Identifier: Apache-2.0
#include "proof/cavity.hpp"

#include <algorithm>
#include <numeric>

#include "proof/delaunay.hpp"

namespace gcdt::proof {

void Cavity::triangulate(const std::vector<std::uint32_t>& path) {
  path_ = path;
  const auto last = static_cast<std::uint32_t>(path.size() - 1);
  distances_.assign(path.size(), 0);
  for (std::uint32_t i = 1; i < last; ++i) distances_[i] = turn(last, 0, i);
  order_.resize(last - 1);
  take_off_at_random();
  put_back();
}

void Cavity::take_off(std::uint32_t place) {
  next_[previous_[place]] = next_[place];
  previous_[next_[place]] = previous_[place];
}

/// Leaves order_, of which all but the first are taken off, the last one first.
void Cavity::take_off_at_random() {
  const auto count = static_cast<std::uint32_t>(path_.size());
  next_.resize(count);
  previous_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
    next_[i] = i + 1 < count ? i + 1 : 0, previous_[i] = i > 0 ? i - 1 : count - 1;
  std::iota(order_.begin(), order_.end(), 1u);
  for (std::size_t left = order_.size(); left > 1; --left) {
    std::size_t i;
    std::uint32_t place;
    do {  // less than two rounds, expected: of two neighbours one may go, and of the two at the ends both
      i = random_() % left;
      place = order_[i];
      ++steps_;
    } while (distances_[place] < distances_[previous_[place]] && distances_[place] < distances_[next_[place]]);
    std::swap(order_[i], order_[left - 1]);
    take_off(place);
  }
}

std::uint32_t Cavity::add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  auto t = static_cast<std::uint32_t>(triangles_.size());
  if (unused_.empty()) {
    triangles_.emplace_back();
    twins_.resize(twins_.size() + 3);
  } else {
    t = unused_.back();
    unused_.pop_back();
  }
  triangles_[t] = {a, b, c};
  std::fill_n(twins_.begin() + 3 * t, 3, none);
  return t;
}

void Cavity::put_back() {
  triangles_.clear();
  twins_.clear();
  unused_.clear();
  along_.assign(path_.size(), none);
  const auto last = static_cast<std::uint32_t>(path_.size() - 1);
  add(0, order_[0], last);
  along_[0] = 2, along_[order_[0]] = 0, along_[last] = 1;
  for (std::size_t i = 1; i < order_.size(); ++i) put_back(order_[i]);
}

/// Whether the triangle on the other side of an edge must go, as seen from the place.
bool Cavity::covers(std::uint32_t place, const Hidden& edge) const {
  if (edge.half_edge == none) return false;
  if (turn(edge.to, edge.from, place) <= 0) return true;
  const std::uint32_t apex = triangles_[edge.half_edge / 3][edge.half_edge % 3];
  return inside_circle(sites_, path_[edge.from], path_[edge.to], path_[apex], path_[place]);
}

/// Ends: no triangle is met twice, since triangles without a vertex inside form a tree.
void Cavity::put_back(std::uint32_t place) {
  const std::uint32_t from = previous_[place], to = next_[place];
  hidden_.assign(1, {from, to, along_[from]});
  std::uint32_t fan = none;  // the last triangle made around the place, which go from `to` to `from`
  while (!hidden_.empty()) {
    const Hidden edge = hidden_.back();
    const std::uint32_t h = edge.half_edge;
    hidden_.pop_back();
    ++steps_;
    if (covers(place, edge)) {
      const std::uint32_t apex = triangles_[h / 3][h % 3];
      hidden_.push_back({edge.from, apex, twins_[previous(h)]});
      hidden_.push_back({apex, edge.to, twins_[next(h)]});
      unused_.push_back(h / 3);
      continue;
    }
    const std::uint32_t t = add(edge.to, edge.from, place);
    if (h != none)
      link(3 * t + 2, h);
    else
      along_[edge.to] = 3 * t + 2;
    if (fan == none)
      along_[place] = 3 * t + 1;
    else
      link(3 * t + 1, 3 * fan);
    fan = t;
  }
  along_[from] = 3 * fan;
}

}  // namespace gcdt::proof
