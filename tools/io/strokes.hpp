// SPDX-License-Identifier: Apache-2.0
// The edges of a picture as strokes.
#pragma once

#include <algorithm>
#include <cmath>

#include "canvas.hpp"
#include "triangle_files.hpp"

namespace gcdt::io {

using Edge = std::array<std::uint32_t, 2>;

constexpr double thinnest = 12, thickest = 200;  ///< of the strokes of unconstrained edges

/// Draws every edge once on a path (move, line, end), in few strokes: from each vertex on it follows unused edges
/// as long as there are any.
class Strokes {
 public:
  Strokes(const Canvas& canvas, std::vector<Edge> edges) : canvas_(canvas), edges_(std::move(edges)) {
    auto invisible = [&](const Edge& e) { return canvas.places[e[0]] == canvas.places[e[1]]; };
    edges_.erase(std::remove_if(edges_.begin(), edges_.end(), invisible), edges_.end());
    starts_.resize(canvas.places.size() + 1);
    for (const Edge& e : edges_)
      for (std::uint32_t v : e) ++starts_[v + 1];
    for (std::size_t v = 1; v < starts_.size(); ++v) starts_[v] += starts_[v - 1];
    incident_.resize(2 * edges_.size());
    next_.assign(starts_.begin(), starts_.end() - 1);
    for (std::size_t e = 0; e < edges_.size(); ++e)
      for (std::uint32_t v : edges_[e]) incident_[next_[v]++] = static_cast<std::uint32_t>(e);
    next_.assign(starts_.begin(), starts_.end() - 1);
    used_.resize(edges_.size());
  }

  template <class Path>
  void draw(Path& path) {
    for (const Edge& edge : edges_)
      while (follow(path, edge[0])) path.end();
  }

 private:
  /// One stroke from vertex `at`; false if no edge was left there.
  template <class Path>
  bool follow(Path& path, std::uint32_t at) {
    bool drawn = false;
    for (;; drawn = true) {
      while (next_[at] < starts_[at + 1] && used_[incident_[next_[at]]]) ++next_[at];
      if (next_[at] == starts_[at + 1]) return drawn;
      const std::uint32_t e = incident_[next_[at]++];
      used_[e] = true;
      const std::uint32_t to = edges_[e][0] == at ? edges_[e][1] : edges_[e][0];
      const auto &from_place = canvas_.places[at], &place = canvas_.places[to];
      if (!drawn) path.move(from_place);
      path.line(from_place, place);
      at = to;
    }
  }

  const Canvas& canvas_;
  std::vector<Edge> edges_;
  std::vector<std::size_t> starts_, next_;
  std::vector<std::uint32_t> incident_;
  std::vector<bool> used_;
};

/// The width of thin strokes: a tenth of the median edge, so that dense parts are not blotted out by
/// strokes that would suit sparse ones, within bounds that can still be seen and still be called thin.
inline double thin_stroke(const Canvas& canvas, Span<Edge> some, Span<Edge> others) {
  std::vector<double> squares;
  for (const Span<Edge> edges : {some, others})
    for (const Edge& e : edges) {
      const auto &a = canvas.places[e[0]], &b = canvas.places[e[1]];
      const double x = a[0] - b[0], y = a[1] - b[1];
      squares.push_back(x * x + y * y);
    }
  if (squares.empty()) return thickest;
  const auto median = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), median, squares.end());
  return std::clamp(std::sqrt(*median) / 10, thinnest, thickest);
}

/// The vertices of a result, in their order.
inline std::vector<std::array<double, 2>> all_vertices(const Result& result) {
  std::vector<std::array<double, 2>> vertices = result.input.vertices;
  vertices.insert(vertices.end(), result.mesh.added.begin(), result.mesh.added.end());
  return vertices;
}

inline std::vector<Edge> unconstrained_edges(const MeshArrays& mesh) {
  std::vector<Edge> edges;
  for_each_edge(mesh, [&](std::uint32_t a, std::uint32_t b, bool constrained) {
    if (!constrained) edges.push_back({a, b});
  });
  return edges;
}

}  // namespace gcdt::io
