// SPDX-License-Identifier: Apache-2.0
// CGAL on one core, as a peer (bench/peer.hpp): Delaunay_triangulation_2 from a range of points, or
// Constrained_Delaunay_triangulation_2 with insert_constraints by index, both with CGAL's own spatial sort and
// exact predicates on doubles. Reading the file is not timed.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<Kernel>;

struct Input {
  std::vector<Kernel::Point_2> points;
  std::vector<std::pair<std::size_t, std::size_t>> constraints;
};

Input read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char magic[8] = {};
  std::int64_t n = 0, m = 0;
  file.read(magic, 8).read(reinterpret_cast<char*>(&n), 8).read(reinterpret_cast<char*>(&m), 8);
  if (!file || std::memcmp(magic, "PSLGBIN1", 8) != 0) throw std::runtime_error("no such input");
  std::vector<double> xy(2 * n);
  std::vector<std::int32_t> ends(2 * m);
  file.read(reinterpret_cast<char*>(xy.data()), 16 * n).read(reinterpret_cast<char*>(ends.data()), 8 * m);
  if (!file) throw std::runtime_error("the input ends too soon");
  Input input;
  for (std::int64_t i = 0; i < n; ++i) input.points.emplace_back(xy[2 * i], xy[2 * i + 1]);
  for (std::int64_t i = 0; i < m; ++i) input.constraints.emplace_back(ends[2 * i], ends[2 * i + 1]);
  return input;
}

double now() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// One run: its milliseconds, and the triangles made.
double run(const Input& input, std::size_t& triangles) {
  const double start = now();
  if (input.constraints.empty()) {
    Delaunay mesh;
    mesh.insert(input.points.begin(), input.points.end());
    const double ms = now() - start;
    triangles = mesh.number_of_faces();
    return ms;
  }
  Constrained mesh;
  mesh.insert_constraints(input.points.begin(), input.points.end(), input.constraints.begin(), input.constraints.end());
  const double ms = now() - start;
  triangles = mesh.number_of_faces();
  return ms;
}

}  // namespace

int main() {
  std::cout << "cgal-" << CGAL_STR(CGAL_VERSION) << " constraints" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string path;
    int most = 3;
    double seconds = 0;
    words >> path >> most >> seconds;
    try {
      const Input input = read(path);
      std::size_t triangles = 0;
      std::ostringstream times;
      const double start = now();
      for (int i = 0; i < most && (i < 3 || now() - start < 1000 * seconds); ++i) times << ' ' << run(input, triangles);
      std::cout << "ok " << triangles << times.str() << std::endl;
    } catch (const std::exception& error) {
      std::string what = error.what();
      for (char& c : what) c = c == '\n' ? ' ' : c;
      std::cout << "error " << what << std::endl;
    }
  }
}
