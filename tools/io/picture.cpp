// SPDX-License-Identifier: Apache-2.0
#include "picture.hpp"

#include <cairo-pdf.h>
#include <cairo.h>

#include <cstring>
#include <exception>
#include <memory>

#include "histogram.hpp"
#include "scale_bar.hpp"
#include "shade.hpp"
#include "strokes.hpp"

namespace gcdt::io {

namespace {

constexpr double margin = 0.02 * Canvas::longer_side;
constexpr double footer = ScaleBar::high;              // below the picture
constexpr double png_pixels = 2000, pdf_points = 720;  // of the longer side of what is drawn
constexpr double pdf_shade_pixels = 4000;              // of the shade, which is an image in the .pdf
constexpr std::size_t many = 100000;                   // edges, from which on short ones become shade
constexpr double short_pixels = 8;
constexpr std::uint32_t thin_colour = 0x557777, bold_colour = 0x110033;

/// cairo is C: what a file throws waits outside.
struct Sink {
  OutputFile& file;
  std::exception_ptr thrown;

  static cairo_status_t write(void* sink, const unsigned char* data, unsigned int size) {
    auto* self = static_cast<Sink*>(sink);
    try {
      self->file.write({reinterpret_cast<const char*>(data), size});
      return CAIRO_STATUS_SUCCESS;
    } catch (...) {
      self->thrown = std::current_exception();
      return CAIRO_STATUS_WRITE_ERROR;
    }
  }
  void check(cairo_status_t status) const {
    if (thrown) std::rethrow_exception(thrown);
    if (status != CAIRO_STATUS_SUCCESS)
      throw Failure(Exit::output, fmt::format("the picture cannot be drawn: {}", cairo_status_to_string(status)));
  }
};

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Pen = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

/// A path in units; lines that end less than `step` from where the last one did are left out.
class Path {
 public:
  Path(cairo_t* pen, double step) : pen_(pen), step_(step) {}
  void move(const Canvas::Place& place) {
    cairo_move_to(pen_, place[0], place[1]);
    at_ = place;
  }
  void line(const Canvas::Place&, const Canvas::Place& to) {
    left_ = to;
    if (std::abs(to[0] - at_[0]) < step_ && std::abs(to[1] - at_[1]) < step_) return;
    cairo_line_to(pen_, to[0], to[1]);
    at_ = to;
  }
  void end() {
    if (left_ != at_) cairo_line_to(pen_, left_[0], left_[1]);
  }
  void close() { cairo_close_path(pen_); }

 private:
  cairo_t* pen_;
  double step_;
  Canvas::Place at_{}, left_{};
};

class Drawing {
 public:
  /// `units`: of the canvas, a pixel of the shade.
  Drawing(cairo_t* pen, const Result& result, const Canvas& canvas, const Fill& fill, double units)
      : pen_(pen), result_(result), canvas_(canvas), fill_(fill), units_(units) {}

  void draw() {
    colour(0xffffff);
    cairo_paint(pen_);
    fill_triangles();
    cairo_set_line_cap(pen_, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(pen_, CAIRO_LINE_JOIN_ROUND);
    std::vector<Edge> thin = unconstrained_edges(result_.mesh);
    std::vector<Edge> bold(result_.mesh.pieces.begin(), result_.mesh.pieces.end());
    const double stroke = thin_stroke(canvas_, thin, bold);
    draw_edges(std::move(thin), thin_colour, stroke);
    draw_edges(std::move(bold), bold_colour, 4 * stroke);
    if (result_.mesh.triangles.empty()) draw_dots(8 * stroke);
    draw_scale(pen_, canvas_, canvas_.height + margin / 2, footer);
    draw_histogram(Histogram(canvas_, fill_, canvas_.height + margin / 2 + footer));
  }

 private:
  void colour(std::uint32_t rgb) {
    cairo_set_source_rgb(pen_, (rgb >> 16 & 255) / 255., (rgb >> 8 & 255) / 255., (rgb & 255) / 255.);
  }

  void fill_triangles() {
    for (std::size_t c = 0; c < fill_.colours.size(); ++c) {
      Borders borders = borders_of(canvas_, result_.mesh, fill_, c);
      if (borders.empty()) continue;
      Path path(pen_, units_ / 4);
      borders.draw(path);
      colour(fill_.colours[c]);
      cairo_fill(pen_);
    }
  }

  void draw_histogram(const Histogram& histogram) {
    for (const HistogramBar& bar : histogram.bars) {
      cairo_rectangle(pen_, bar.x, bar.y, bar.width, bar.height);
      colour(bar.colour);
      cairo_fill(pen_);
    }
    if (histogram.numbers.empty()) return;
    colour(0);
    cairo_move_to(pen_, 0, histogram.base);
    cairo_line_to(pen_, histogram.numbers.back().first, histogram.base);
    cairo_set_line_width(pen_, Histogram::gap / 8);
    cairo_stroke(pen_);
    for (const auto& [x, number] : histogram.numbers) {
      const std::string text = std::to_string(number);
      const double width = text_width(text, Histogram::numbers_high), left = number == 0    ? 0
                                                                             : number == 60 ? x - width
                                                                                            : x - width / 2;
      draw_text(pen_, text, left, histogram.base + Histogram::gap, Histogram::numbers_high);
    }
  }

  void draw_edges(std::vector<Edge> edges, std::uint32_t rgb, double stroke) {
    colour(rgb);
    if (edges.size() > many) shade(edges, stroke);
    Path path(pen_, 0);
    Strokes(canvas_, std::move(edges)).draw(path);
    cairo_set_line_width(pen_, stroke);
    cairo_stroke(pen_);
  }

  /// Takes the short ones out of `edges`, and draws them together.
  void shade(std::vector<Edge>& edges, double stroke) {
    Shade shade(canvas_, units_);
    const double longest = short_pixels * units_;
    edges.erase(std::remove_if(edges.begin(), edges.end(),
                               [&](const Edge& e) {
                                 const auto &a = canvas_.places[e[0]], &b = canvas_.places[e[1]];
                                 if (std::abs(a[0] - b[0]) > longest || std::abs(a[1] - b[1]) > longest) return false;
                                 shade.add(a, b, stroke / units_);
                                 return true;
                               }),
                edges.end());
    const Surface mask(cairo_image_surface_create(CAIRO_FORMAT_A8, shade.width(), shade.height()),
                       cairo_surface_destroy);
    const std::vector<std::uint8_t> covered = shade.coverage();
    unsigned char* rows = cairo_image_surface_get_data(mask.get());
    if (!rows) return;  // the pen has the status
    const auto width = static_cast<std::size_t>(shade.width());
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(mask.get()));
    for (std::size_t row = 0; row < static_cast<std::size_t>(shade.height()); ++row)
      std::memcpy(rows + row * stride, covered.data() + row * width, width);
    cairo_surface_mark_dirty(mask.get());
    cairo_save(pen_);
    cairo_scale(pen_, units_, units_);
    cairo_mask_surface(pen_, mask.get(), 0, 0);
    cairo_restore(pen_);
  }

  void draw_dots(double width) {
    for (const auto& [x, y] : canvas_.places) {
      cairo_move_to(pen_, x, y);
      cairo_close_path(pen_);
    }
    colour(0);
    cairo_set_line_width(pen_, width);
    cairo_stroke(pen_);
  }

  cairo_t* pen_;
  const Result& result_;
  const Canvas& canvas_;
  const Fill& fill_;
  double units_;
};

/// Where things are in it, their colours, and its size in units.
struct Picture {
  explicit Picture(const Result& result) : Picture(result, all_vertices(result)) {}
  Canvas canvas;
  Fill fill;
  double width, height;

 private:
  Picture(const Result& result, const std::vector<std::array<double, 2>>& vertices)
      : canvas(vertices),
        fill(result.coloured_by_angle ? fill_by_angle(result.mesh, vertices) : fill_by_region(result.mesh)),
        width(canvas.width + 2 * margin),
        height(canvas.height + 2 * margin + footer + (result.coloured_by_angle ? Histogram::height : 0)) {}
};

/// Draws with `scale` pixels or points a unit.
void draw(cairo_surface_t* surface, const Sink& sink, const Result& result, const Picture& picture, double scale,
          double shade_units) {
  const Pen pen(cairo_create(surface), cairo_destroy);
  cairo_scale(pen.get(), scale, scale);
  cairo_translate(pen.get(), margin, margin);
  Drawing(pen.get(), result, picture.canvas, picture.fill, shade_units).draw();
  cairo_show_page(pen.get());
  sink.check(cairo_status(pen.get()));
}

}  // namespace

void write_png(OutputFile& file, const Result& result) {
  const Picture picture(result);
  const double scale = png_pixels / Canvas::longer_side;
  const auto pixels = [&](double units) { return static_cast<int>(std::ceil(units * scale)); };
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, pixels(picture.width), pixels(picture.height)),
                        cairo_surface_destroy);
  Sink sink{file, nullptr};
  sink.check(cairo_surface_status(surface.get()));
  draw(surface.get(), sink, result, picture, scale, 1 / scale);
  sink.check(cairo_surface_write_to_png_stream(surface.get(), Sink::write, &sink));
}

void write_pdf(OutputFile& file, const Result& result) {
  const Picture picture(result);
  const double scale = pdf_points / Canvas::longer_side;
  Sink sink{file, nullptr};
  const Surface surface(
      cairo_pdf_surface_create_for_stream(Sink::write, &sink, picture.width * scale, picture.height * scale),
      cairo_surface_destroy);
  sink.check(cairo_surface_status(surface.get()));
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
  draw(surface.get(), sink, result, picture, scale, Canvas::longer_side / pdf_shade_pixels);
  cairo_surface_finish(surface.get());
  sink.check(cairo_surface_status(surface.get()));
}

}  // namespace gcdt::io
