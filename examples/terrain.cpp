// SPDX-License-Identifier: Apache-2.0
// A terrain with a cliff along breaklines, interpolated to a picture (terrain.pgm) and a height at a place.
#include <cmath>
#include <cstdio>

#include <gcdt/gcdt.hpp>

// Hills, and a plateau 20 higher beyond the cliff.
static double height(double x, double y, bool plateau) {
  return 10 * std::sin(x / 20) * std::cos(y / 15) + (plateau ? 20 : 0);
}

int main() {
  std::vector<std::array<double, 2>> points;
  std::vector<double> heights;
  auto add = [&](double x, double y, bool plateau) {
    points.push_back({x, y});
    heights.push_back(height(x, y, plateau));
  };
  // The foot of the cliff and its edge, one unit apart, as two lines of constraints.
  std::vector<gcdt::Constraint> breaklines;
  for (const bool edge : {false, true})
    for (int i = 0; i <= 20; ++i) {
      add((edge ? 61 : 60) + 2 * std::sin(i), 5 * i, edge);
      const auto last = static_cast<std::uint32_t>(points.size() - 1);
      if (i > 0) breaklines.push_back({last - 1, last});
    }
  for (int i = 0; i <= 25; ++i)
    for (int j = 0; j <= 20; ++j)
      if (std::abs(4 * i - 60) > 5) add(4 * i, 5 * j, 4 * i > 60);
  try {
    gcdt::Solver solver;
    const gcdt::Result mesh = solver.solve(points, breaklines);
    const int width = 400, rows = 400;
    std::vector<std::array<double, 2>> cells;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < width; ++column) cells.push_back({(column + 0.5) / 4, 100 - (row + 0.5) / 4});
    const gcdt::Array<double> values = mesh.interpolate(cells, heights, -1000);
    std::FILE* picture = std::fopen("terrain.pgm", "wb");
    if (!picture) return 1;
    std::fprintf(picture, "P5\n%d %d\n255\n", width, rows);
    for (const double value : values) std::fputc(value < -500 ? 0 : static_cast<int>(5 * (value + 12)), picture);
    std::fclose(picture);
    const auto there = mesh.interpolate(std::vector<std::array<double, 2>>{{20, 50}, {80, 50}}, heights, -1000);
    std::printf("height %.2f below the cliff, %.2f above\n", there[0], there[1]);
    return there[0] == height(20, 50, false) && there[1] == height(80, 50, true) ? 0 : 1;  // both are vertices
  } catch (const gcdt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
