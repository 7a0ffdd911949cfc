// SPDX-License-Identifier: Apache-2.0
#include "svg.hpp"

#include <algorithm>
#include <cmath>

#include "histogram.hpp"
#include "scale_bar.hpp"
#include "strokes.hpp"

namespace gcdt::io {

namespace {

constexpr double svg_margin = 0.02;  // of the longer side, all around
constexpr int shown_pixels = 1200;   // of the longer side, where nothing else asks for a size

/// Path data of relative lines.
class SvgPath {
 public:
  explicit SvgPath(OutputFile& file) : file_(file) {}
  void move(const Canvas::Place& place) {
    file_.print("M{} {}l", place[0], place[1]);
    first_ = true;
  }
  void line(const Canvas::Place& from, const Canvas::Place& to) {
    const std::int32_t x = to[0] - from[0], y = to[1] - from[1];
    file_.print("{}{}{}{}", !first_ && x >= 0 ? " " : "", x, y >= 0 ? " " : "", y);
    first_ = false;
  }
  void end() { file_.write("\n"); }
  void close() { file_.write("z\n"); }

 private:
  OutputFile& file_;
  bool first_ = true;
};

void fill_triangles(OutputFile& file, const Canvas& canvas, const MeshArrays& mesh, const Fill& fill) {
  for (std::size_t c = 0; c < fill.colours.size(); ++c) {
    Borders borders = borders_of(canvas, mesh, fill, c);
    if (borders.empty()) continue;
    file.print("<path fill=\"#{:06x}\" d=\"", fill.colours[c]);
    SvgPath path(file);
    borders.draw(path);
    file.print("\"/>\n");
  }
}

/// As draw_scale() does, `y` units down.
void draw_bar(OutputFile& file, const Canvas& canvas, double y) {
  const std::optional<ScaleBar> bar = ScaleBar::of(canvas);
  if (!bar) return;
  constexpr double high = ScaleBar::high, line = high / 16, tick = high / 3;
  const double middle = y + high / 2;
  const auto rectangle = [&](double x, double from, double width, double height) {
    file.print("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\"/>\n", x, from, width, height);
  };
  for (const double x : {0., bar->across}) rectangle(x - line / 2, middle - tick / 2, line, tick);
  rectangle(0, middle - line / 2, bar->across, line);
  file.print("<text x=\"{:.0f}\" y=\"{:.0f}\" font-size=\"{:.0f}\" font-family=\"sans-serif\">{}</text>\n",
             bar->across + high / 2, middle + high / 4, 0.7 * high, bar->length);
}

void draw_histogram(OutputFile& file, const Histogram& histogram) {
  for (const HistogramBar& bar : histogram.bars)
    file.print("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" fill=\"#{:06x}\"/>\n", bar.x, bar.y,
               bar.width, bar.height, bar.colour);
  if (histogram.numbers.empty()) return;
  file.print("<path stroke=\"#000\" stroke-width=\"{:.0f}\" d=\"M0 {:.0f}H{:.0f}\"/>\n", Histogram::gap / 8,
             histogram.base, histogram.numbers.back().first);
  for (const auto& [x, number] : histogram.numbers)
    file.print(
        "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"{}\" font-size=\"{:.0f}\" "
        "font-family=\"sans-serif\">{}°</text>\n",
        x, histogram.base + Histogram::gap / 2 + Histogram::numbers_high,
        number == 0    ? "start"
        : number == 60 ? "end"
                       : "middle",
        1.3 * Histogram::numbers_high, number);
}

void draw_edges(OutputFile& file, const Canvas& canvas, std::vector<Edge> edges, const char* colour, double stroke) {
  if (edges.empty()) return;
  file.print("<path stroke=\"{}\" stroke-width=\"{:.0f}\" d=\"", colour, stroke);
  SvgPath path(file);
  Strokes(canvas, std::move(edges)).draw(path);
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
  const std::vector<std::array<double, 2>> vertices = all_vertices(result);
  const Canvas canvas(vertices);
  const Fill fill = result.coloured_by_angle ? fill_by_angle(result.mesh, vertices) : fill_by_region(result.mesh);
  std::vector<Edge> unconstrained = unconstrained_edges(result.mesh);
  const double thin = thin_stroke(canvas, unconstrained, result.mesh.pieces), bold = 4 * thin;
  const double border = svg_margin * Canvas::longer_side;
  const double legend = ScaleBar::high + (result.coloured_by_angle ? Histogram::height : 0);
  const double width = canvas.width + 2 * border, height = canvas.height + 2 * border + legend;
  const double pixels = shown_pixels / std::max(width, height);
  file.print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" viewBox=\"{:.0f} {:.0f} {:.0f} "
      "{:.0f}\">\n",
      std::ceil(width * pixels), std::ceil(height * pixels), -border, -border, std::ceil(width), std::ceil(height));
  file.print("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n", -border, -border);
  fill_triangles(file, canvas, result.mesh, fill);
  file.print("<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n");
  draw_edges(file, canvas, std::move(unconstrained), "#577", thin);
  draw_edges(file, canvas, {result.mesh.pieces.begin(), result.mesh.pieces.end()}, "#103", bold);
  if (result.mesh.triangles.empty()) draw_dots(file, canvas, 2 * bold);
  file.print("</g>\n");
  draw_bar(file, canvas, canvas.height + border / 2);
  draw_histogram(file, Histogram(canvas, fill, canvas.height + border / 2 + ScaleBar::high));
  file.print("</svg>\n");
}

}  // namespace gcdt::io
