// SPDX-License-Identifier: Apache-2.0
// CGAL on one core, as a peer (bench/peer.hpp): Delaunay_triangulation_2 from a range of points, or
// Constrained_Delaunay_triangulation_2 with insert_constraints by index, both with CGAL's own spatial sort and
// exact predicates on doubles. Reading the file is not timed.
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include "inputs.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<Kernel>;

struct Input {
  std::vector<Kernel::Point_2> points;
  std::vector<std::pair<std::size_t, std::size_t>> constraints;
};

Input read(const std::string& path) {
  const gcdt::bench::Workload given = gcdt::bench::read_pslg(path);
  Input input;
  for (const auto& point : given.points) input.points.emplace_back(point[0], point[1]);
  for (const auto& ends : given.constraints) input.constraints.emplace_back(ends[0], ends[1]);
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
