// SPDX-License-Identifier: Apache-2.0
// The regions of a picture: their colours, and the outlines along which they are filled.
#pragma once

#include "canvas.hpp"

#include <gcdt/gcdt.hpp>

namespace gcdt::io {

/// Pale, so that edges stand out, and distinct for most eyes.
constexpr std::array<std::uint32_t, 7> region_colours = {0xcfe3c8, 0xf6e2b3, 0xf3c9c0, 0xc9d9ee,
                                                         0xe0cfe8, 0xd6e9e6, 0xead9c4};

/// The number of a colour for each region: the first that no earlier region across an edge has; else any. So regions
/// that share an edge have different colours, as long as those suffice.
std::vector<std::uint8_t> colours_of_regions(const Triangulation& mesh);

/// The outlines of all triangles of one colour, on a path (move, line, close). Each has its inside to the left, so that
/// as many edges come to a vertex as leave it: a walk over unused edges ends where it began, and only there.
class Borders {
 public:
  explicit Borders(const Canvas& canvas) : canvas_(canvas), starts_(canvas.places.size() + 1) {}

  void add(std::uint32_t from, std::uint32_t to) { edges_.push_back({from, to}); }

  bool empty() const { return edges_.empty(); }

  template <class Path>
  void draw(Path& path) {
    for (const auto& edge : edges_) ++starts_[edge[0] + 1];
    for (std::size_t v = 1; v < starts_.size(); ++v) starts_[v] += starts_[v - 1];
    ends_.resize(edges_.size());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (const auto& edge : edges_) ends_[next[edge[0]]++] = edge[1];
    next.assign(starts_.begin(), starts_.end() - 1);
    for (const auto& edge : edges_)
      while (next[edge[0]] < starts_[edge[0] + 1]) walk(path, edge[0], next);
  }

 private:
  template <class Path>
  void walk(Path& path, std::uint32_t at, std::vector<std::size_t>& next) {
    const Canvas::Place first = canvas_.places[at];
    Canvas::Place from = first;
    bool drawn = false;
    while (next[at] < starts_[at + 1]) {
      at = ends_[next[at]++];
      const Canvas::Place to = canvas_.places[at];
      if (to == from) continue;
      if (!drawn) path.move(first);
      path.line(from, to);
      drawn = true;
      from = to;
    }
    if (drawn) path.close();
  }

  const Canvas& canvas_;
  std::vector<std::array<std::uint32_t, 2>> edges_;
  std::vector<std::size_t> starts_;
  std::vector<std::uint32_t> ends_;
};

/// The borders of all regions of colour `c`.
Borders borders_of(const Canvas& canvas, const Triangulation& mesh, const std::vector<std::uint8_t>& colours,
                   std::size_t c);

}  // namespace gcdt::io
