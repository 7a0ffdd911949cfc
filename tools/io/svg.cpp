// SPDX-License-Identifier: Apache-2.0
#include "svg.hpp"

#include <algorithm>
#include <cmath>

#include "svg_fill.hpp"

namespace gcdt::io {

namespace {

constexpr double margin = 0.02;     // of the longer side, all around
constexpr int shown_pixels = 1200;  // of the longer side, where nothing else asks for a size

constexpr double thinnest = 12, thickest = 200;  // of the strokes of unconstrained edges

using Edge = std::array<std::uint32_t, 2>;

/// Path data that draws every edge once, in few strokes: from each vertex on it follows unused edges
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

  void draw(OutputFile& file) {
    for (const Edge& edge : edges_)
      for (std::uint32_t at = edge[0]; follow(file, at);) file.write("\n");
  }

 private:
  /// One stroke from vertex `at`; false if no edge was left there.
  bool follow(OutputFile& file, std::uint32_t at) {
    bool drawn = false;
    for (;; drawn = true) {
      while (next_[at] < starts_[at + 1] && used_[incident_[next_[at]]]) ++next_[at];
      if (next_[at] == starts_[at + 1]) return drawn;
      const std::uint32_t e = incident_[next_[at]++];
      used_[e] = true;
      const std::uint32_t to = edges_[e][0] == at ? edges_[e][1] : edges_[e][0];
      const auto &from_place = canvas_.places[at], &place = canvas_.places[to];
      if (!drawn) file.print("M{} {}l", from_place[0], from_place[1]);
      const std::int32_t x = place[0] - from_place[0], y = place[1] - from_place[1];
      file.print("{}{}{}{}", drawn && x >= 0 ? " " : "", x, y >= 0 ? " " : "", y);
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
double thin_stroke(const Canvas& canvas, Span<Edge> some, Span<Edge> others) {
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

void draw_edges(OutputFile& file, const Canvas& canvas, std::vector<Edge> edges, const char* colour, double stroke) {
  if (edges.empty()) return;
  file.print("<path stroke=\"{}\" stroke-width=\"{:.0f}\" d=\"", colour, stroke);
  Strokes(canvas, std::move(edges)).draw(file);
  file.print("\"/>\n");
}

void draw_dots(OutputFile& file, const Canvas& canvas, double stroke) {
  if (canvas.places.empty()) return;
  file.print("<path stroke=\"#000\" stroke-width=\"{:.0f}\" d=\"", stroke);
  for (const auto& [x, y] : canvas.places) file.print("M{} {}h0\n", x, y);
  file.print("\"/>\n");
}

}  // namespace

void write_svg(OutputFile& file, const Result& result) {
  std::vector<std::array<double, 2>> vertices = result.input.vertices;
  vertices.insert(vertices.end(), result.mesh.added.begin(), result.mesh.added.end());
  const Canvas canvas(vertices);
  std::vector<Edge> unconstrained;
  for_each_edge(result.mesh, [&](std::uint32_t a, std::uint32_t b, bool constrained) {
    if (!constrained) unconstrained.push_back({a, b});
  });
  const double thin = thin_stroke(canvas, unconstrained, result.mesh.pieces), bold = 4 * thin;
  const double border = margin * Canvas::longer_side;
  const double width = canvas.width + 2 * border, height = canvas.height + 2 * border;
  const double pixels = shown_pixels / std::max(width, height);
  file.print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" viewBox=\"{:.0f} {:.0f} {:.0f} "
      "{:.0f}\">\n",
      std::ceil(width * pixels), std::ceil(height * pixels), -border, -border, std::ceil(width), std::ceil(height));
  file.print("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n", -border, -border);
  if (!result.mesh.region.empty()) fill_regions(file, canvas, result.mesh);
  file.print("<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n");
  draw_edges(file, canvas, std::move(unconstrained), "#577", thin);
  draw_edges(file, canvas, {result.mesh.pieces.begin(), result.mesh.pieces.end()}, "#103", bold);
  if (result.mesh.triangles.empty()) draw_dots(file, canvas, 2 * bold);
  file.print("</g>\n</svg>\n");
}

}  // namespace gcdt::io
