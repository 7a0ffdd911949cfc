// SPDX-License-Identifier: Apache-2.0
// The colours of a picture's triangles, by region or by least angle, and the outlines along which they are filled.
#pragma once

#include "canvas.hpp"
#include "mesh_arrays.hpp"

namespace gcdt::io {

/// Pale, so that edges stand out, and distinct for most eyes.
constexpr std::array<std::uint32_t, 7> region_colours = {0xcfe3c8, 0xf6e2b3, 0xf3c9c0, 0xc9d9ee,
                                                         0xe0cfe8, 0xd6e9e6, 0xead9c4};

/// From the sharpest angles, red, to those of equilateral triangles, blue: distinct for most eyes.
constexpr std::array<std::uint32_t, 12> angle_colours = {0x8e0b21, 0xb2182b, 0xd6604d, 0xf08a62, 0xf4b183, 0xfbd9a5,
                                                         0xf7f3c6, 0xdcecd5, 0xb7dbe4, 0x92c5de, 0x6aa9d0, 0x4393c3};
constexpr double degrees_of_colour = 60.0 / angle_colours.size();

/// What fills a picture: nothing, if no colour is of any triangle.
struct Fill {
  std::vector<std::uint8_t> colour;    ///< of each triangle, in `colours`; or empty
  std::vector<std::uint32_t> colours;  ///< red, green and blue
  /// With colours by angle: how many triangles have a least angle from k degrees on, below k + 1, up to 60; else empty.
  std::vector<std::size_t> histogram;
};

/// By region: the first colour that no earlier region across an edge has; else any. So regions that share an edge have
/// different colours, as long as those suffice. Without regions nothing.
Fill fill_by_region(const MeshArrays& mesh);
/// By the least angle of each triangle, five degrees a colour. `vertices`: all of them.
Fill fill_by_angle(const MeshArrays& mesh, const std::vector<std::array<double, 2>>& vertices);

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

/// The borders of all triangles of colour `c`.
Borders borders_of(const Canvas& canvas, const MeshArrays& mesh, const Fill& fill, std::size_t c);

}  // namespace gcdt::io
