// SPDX-License-Identifier: Apache-2.0
// Outlines of glyphs filled by nonzero winding: a counter runs the other way round than its letter, strokes may
// overlap.
#include <cstdio>

#include <gcdt/gcdt.hpp>

using Contour = std::vector<std::array<std::int32_t, 2>>;

int main() {
  const std::vector<Contour> outlines = {
      {{0, 0}, {60, 0}, {60, 80}, {0, 80}},                              // the letter O ...
      {{15, 15}, {15, 65}, {45, 65}, {45, 15}},                          // ... and its counter, clockwise
      {{100, 0}, {115, 0}, {115, 80}, {100, 80}},                        // a T of two strokes: the stem
      {{80, 65}, {100, 65}, {115, 65}, {135, 65}, {135, 80}, {80, 80}},  // and the bar, over the stem's end
  };
  Contour points;
  std::vector<gcdt::Constraint> segments;
  for (const Contour& contour : outlines) {
    const auto first = static_cast<std::uint32_t>(points.size()), count = static_cast<std::uint32_t>(contour.size());
    points.insert(points.end(), contour.begin(), contour.end());
    for (std::uint32_t i = 0; i < count; ++i) segments.push_back({first + i, first + (i + 1) % count});
  }
  try {
    gcdt::Options options;
    options.domain = gcdt::Domain::nonzero;
    gcdt::Solver solver;
    const gcdt::Result glyphs = solver.solve(points, segments, options);
    // A picture in letters: the middle of each cell of 5 x 10 is in a triangle or is not.
    Contour cells;
    for (std::int32_t y = 75; y > 0; y -= 10)
      for (std::int32_t x = 2; x < 138; x += 5) cells.push_back({x, y});
    const auto found = glyphs.locate(cells);
    for (std::size_t i = 0; i < cells.size(); ++i)
      std::printf("%c%s", found[i] < 0 ? '.' : '#', i % 28 == 27 ? "\n" : "");
    const double area = glyphs.quality().area;
    std::printf("area %g\n", area);
    return area == 60 * 80 - 30 * 50 + 55 * 15 + 15 * 65 ? 0 : 1;
  } catch (const gcdt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
