// SPDX-License-Identifier: Apache-2.0
// Triangulates all glyphs of a font on all devices, a problem each, and draws the first ones: glyphs FONT PICTURE.svg
#include <ft2build.h>

#include <complex>
#include <cstdio>
#include <fstream>
#include <gcdt/gcdt_pool.hpp>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

using V = const FT_Vector*;
using Point = std::complex<double>;
Point at(V p) { return {double(p->x), double(p->y)}; }
struct Outline {  // contours come back to their starts: equal vertices are merged
  std::vector<std::array<double, 2>> points;
  std::vector<gcdt::Constraint> lines;
  void move(Point p) { points.push_back({p.real(), p.imag()}); }
  void line(Point p) {
    lines.push_back({std::uint32_t(points.size() - 1), std::uint32_t(points.size())});
    move(p);
  }
  void cubic(Point a, Point b, Point c, Point d) {
    for (double t = 0.125, u = 0.875; t <= 1; t += 0.125, u -= 0.125)
      line(u * u * u * a + 3 * u * u * t * b + 3 * u * t * t * c + t * t * t * d);
  }
  Point last() const { return {points.back()[0], points.back()[1]}; }
};
Outline& of(void* outline) { return *static_cast<Outline*>(outline); }
int main(int argc, char** argv) {
  FT_Library library;
  FT_Face face;
  if (argc != 3 || FT_Init_FreeType(&library) || FT_New_Face(library, argv[1], 0, &face)) return 2;
  FT_Outline_Funcs walk = {};  // curves become eight lines each
  walk.move_to = [](V p, void* o) { return of(o).move(at(p)), 0; };
  walk.line_to = [](V p, void* o) { return of(o).line(at(p)), 0; };
  walk.conic_to = [](V b, V d, void* o) {
    return of(o).cubic(of(o).last(), (of(o).last() + 2. * at(b)) / 3., (at(d) + 2. * at(b)) / 3., at(d)), 0;
  };
  walk.cubic_to = [](V b, V c, V d, void* o) { return of(o).cubic(of(o).last(), at(b), at(c), at(d)), 0; };
  std::vector<Outline> glyphs(face->num_glyphs);
  gcdt::Batch batch;
  for (std::size_t g = 0; g < glyphs.size(); batch.add(glyphs[g].points, glyphs[g].lines), ++g)
    if (!FT_Load_Glyph(face, FT_UInt(g), FT_LOAD_NO_SCALE))
      FT_Outline_Decompose(&face->glyph->outline, &walk, &glyphs[g]);
  const gcdt::BatchResult result = gcdt::Pool("all").triangulate(batch);
  std::printf("%zu glyphs, %zu of them with lines that cross\n", batch.size(), std::size_t(result.statistics().failed));
  std::ofstream picture(argv[2]);
  picture << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 24 6' fill='#cde' stroke='#357'>\n";
  for (std::size_t g = 0; g < std::min<std::size_t>(glyphs.size(), 24 * 6); ++g) {
    const auto point = [&](auto v) { picture << glyphs[g].points[v][0] << ' ' << glyphs[g].points[v][1] << ' '; };
    picture << "<g transform='translate(" << g % 24 << ' ' << g / 24 + 0.75 << ") scale(.8 -.8) scale("
            << 1. / face->units_per_EM << ")'><path stroke-width='8' d='";
    for (const auto& [a, b, c] : result.triangles(g)) picture << 'M', point(a), point(b), point(c), picture << 'z';
    picture << "'/><path stroke='#000' stroke-width='30' d='";
    for (const auto& [a, b] : result.pieces(g)) picture << 'M', point(a), point(b);
    picture << "'/></g>\n";
  }
  picture << "</svg>\n";
}
