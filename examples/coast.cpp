// SPDX-License-Identifier: Apache-2.0
// Meshes Iceland and the sea around it for tides, say: short edges along the coast, long ones far from it, no small
// angles. Draws the mesh by the least angle of each triangle, with their histogram: coast MAP.poly PICTURE.svg
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <gcdt/gcdt.hpp>
#include <map>

using Point = std::array<double, 2>;

constexpr double west = -26, east = -11, south = 62.5, north = 67.5, step = 0.5;

struct Coast {
  std::vector<Point> points;
  std::vector<gcdt::Constraint> lines;
};

/// What the .poly file has within the frame.
Coast read(const char* path) {
  std::ifstream file(path);
  std::size_t count = 0, number = 0, other = 0, a = 0, b = 0;
  Coast coast;
  std::vector<Point> all;
  std::map<std::size_t, std::uint32_t> inside;
  file >> count >> other >> other >> other;
  for (Point p; all.size() < count && file >> number >> p[0] >> p[1]; all.push_back(p)) {
    if (all.empty()) other = number;  // the first number, 0 or 1
    if (p[0] <= west || p[0] >= east || p[1] <= south || p[1] >= north) continue;
    inside[number] = std::uint32_t(coast.points.size());
    coast.points.push_back(p);
  }
  std::size_t lines = 0, markers = 0;
  file >> lines >> markers;
  for (std::size_t i = 0; i < lines && file >> number >> a >> b; ++i) {
    for (std::size_t k = 0; k < markers; ++k) file >> other;
    if (inside.count(a) && inside.count(b)) coast.lines.push_back({inside[a], inside[b]});
  }
  return coast;
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  Coast coast = read(argv[1]);
  std::vector<Point> points = coast.points;
  std::vector<double> lengths(points.size(), 0.04);  // along the coast; else by the distance from it
  for (double x = west; x <= east; x += step)
    for (double y = south; y <= north; y += step) {
      double nearest = HUGE_VAL;
      for (const Point& p : coast.points) nearest = std::min(nearest, std::hypot(p[0] - x, p[1] - y));
      points.push_back({x, y});
      lengths.push_back(0.04 + 0.4 * nearest);
    }
  try {
    gcdt::Options options;
    options.refine = gcdt::Refinement{};
    options.refine->least_angle = 28;
    options.refine->sizes = lengths;
    const gcdt::Triangulation mesh = gcdt::triangulate(points, coast.lines, options);
    const std::size_t given = points.size();
    points.insert(points.end(), mesh.added.begin(), mesh.added.end());
    std::ofstream picture(argv[2]);
    picture << "<svg xmlns='http://www.w3.org/2000/svg' width='1500' height='660' viewBox='" << west << ' ' << -north
            << ' ' << east - west << " 6.6' stroke='#345' stroke-width='.004'>\n"
            << "<rect x='-26' y='-67.5' width='15' height='6.6' fill='#fff' stroke='none'/>\n";
    std::vector<std::size_t> histogram(60, 0);
    for (const auto& t : mesh.triangles) {
      double least = 180;
      for (int k = 0; k < 3; ++k) {
        const Point &o = points[t[k]], &p = points[t[(k + 1) % 3]], &q = points[t[(k + 2) % 3]];
        const double ux = p[0] - o[0], uy = p[1] - o[1], vx = q[0] - o[0], vy = q[1] - o[1];
        least = std::min(least, std::atan2(ux * vy - uy * vx, ux * vx + uy * vy) * 180 / std::acos(-1.0));
      }
      ++histogram[std::min<std::size_t>(59, std::size_t(least))];
      picture << "<path fill='hsl(" << int(4 * std::min(60.0, least) - 40) << " 60% 75%)' d='M";
      for (const std::uint32_t v : t) picture << points[v][0] << ' ' << -points[v][1] << ' ';
      picture << "z'/>\n";
    }
    picture << "<path stroke='#000' stroke-width='.02' fill='none' d='";
    for (const auto& [a, b] : mesh.pieces)
      picture << 'M' << points[a][0] << ' ' << -points[a][1] << ' ' << points[b][0] << ' ' << -points[b][1];
    picture << "'/>\n";
    const std::size_t most = *std::max_element(histogram.begin(), histogram.end());
    for (std::size_t angle = 0; angle < 60; ++angle)  // a bar a degree, 0 to 60, below the map
      picture << "<rect x='" << west + angle * 0.25 << "' y='" << -61 - 1.4 * double(histogram[angle]) / double(most)
              << "' width='.25' height='" << 1.4 * double(histogram[angle]) / double(most) << "' fill='hsl("
              << 4 * int(angle) - 40 << " 60% 75%)'/>\n";
    picture << "</svg>\n";
    const auto& s = mesh.statistics.refine;
    const std::uint64_t left = s.left_input_angle + s.left_beside_angle;
    std::size_t small = 0;
    for (int angle = 0; angle < 28; ++angle) small += histogram[angle];
    std::printf(
        "%zu vertices of coast and sea, %zu added, %zu triangles; %zu of them below 28 degrees, all at angles of the "
        "coast\n",
        given, mesh.added.size(), mesh.triangles.size(), small);
    return s.complete && small <= left && s.left_grid + s.left_refused + s.left_fixed == 0 ? 0 : 1;
  } catch (const gcdt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
