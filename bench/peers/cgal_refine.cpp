// SPDX-License-Identifier: Apache-2.0
// CGAL's Mesh_2 on one core, as a peer (bench/peer.hpp) of refinement: the whole call, from a range of points to the
// refined mesh, Constrained_Delaunay_triangulation_2 and Delaunay_mesher_2 by angle alone. Its argument is Triangle's
// switches: p (segments), c (the hull is a border), q ANGLE. Reading the file is not timed. For measurement only.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include "inputs.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Delaunay_mesh_vertex_base_2<Kernel>;
using Face = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Mesh = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Mesh>;
using Mesher = CGAL::Delaunay_mesher_2<Mesh, Criteria>;

// Above 20.7 degrees nobody promises that it ends.
constexpr std::size_t most_added_per_vertex = 40;

struct Input {
  std::vector<Kernel::Point_2> points;
  std::vector<std::pair<std::size_t, std::size_t>> constraints;
};

struct Made {
  double ms = 0, least_angle = 180;
  std::size_t triangles = 0, vertices = 0;
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

void close_hull(Mesh& mesh) {
  std::vector<std::pair<Mesh::Vertex_handle, Mesh::Vertex_handle>> edges;
  auto first = mesh.incident_vertices(mesh.infinite_vertex()), v = first;
  do {
    const Mesh::Vertex_handle a = v, b = ++v;
    edges.emplace_back(a, b);
  } while (v != first);
  for (const auto& [a, b] : edges) mesh.insert_constraint(a, b);
}

double least_angle(const Mesh::Face& face) {
  constexpr double degrees = 57.29577951308232;
  double least = 180;
  for (int k = 0; k < 3; ++k) {
    const auto at = face.vertex(k)->point();
    const auto u = face.vertex((k + 1) % 3)->point() - at, v = face.vertex((k + 2) % 3)->point() - at;
    least = std::min(least, degrees * std::atan2(u.x() * v.y() - u.y() * v.x(), u * v));
  }
  return least;
}

Made run(const Input& input, double angle, bool hull) {
  Made made;
  const double start = now(), sine = std::sin(angle / 57.29577951308232);
  Mesh mesh;
  if (input.constraints.empty())
    mesh.insert(input.points.begin(), input.points.end());
  else
    mesh.insert_constraints(input.points.begin(), input.points.end(), input.constraints.begin(),
                            input.constraints.end());
  if (hull) close_hull(mesh);
  const std::size_t given = mesh.number_of_vertices();
  Mesher mesher(mesh, Criteria(sine * sine));
  mesher.init();
  while (mesher.step_by_step_refine_mesh())
    if (mesh.number_of_vertices() > given * (1 + most_added_per_vertex)) throw std::runtime_error("does not end");
  made.ms = now() - start;
  made.vertices = input.points.size() + mesh.number_of_vertices() - given;  // of equal points CGAL keeps one
  for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face)
    if (face->is_in_domain()) {
      ++made.triangles;
      made.least_angle = std::min(made.least_angle, least_angle(*face));
    }
  return made;
}

}  // namespace

int main(int count, char** words) {
  const std::string switches = count > 1 ? words[1] : "";
  const std::size_t q = switches.find('q');
  const double angle = q == std::string::npos ? 20 : std::strtod(switches.c_str() + q + 1, nullptr);
  const bool hull = switches.find('p') == std::string::npos || switches.find('c') != std::string::npos;
  std::cout << "cgal-mesh-2-" << CGAL_STR(CGAL_VERSION) << " constraints" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream request(line);
    std::string path;
    int most = 3;
    double seconds = 0;
    request >> path >> most >> seconds;
    try {
      const Input input = read(path);
      Made made;
      std::ostringstream times;
      const double start = now();
      for (int i = 0; i < most && (i < 3 || now() - start < 1000 * seconds); ++i) {
        made = run(input, angle, hull);
        times << ' ' << made.ms;
      }
      std::cout << "ok " << made.triangles << times.str() << " mesh " << made.vertices << ' ' << made.least_angle
                << std::endl;
    } catch (const std::exception& error) {
      std::string what = error.what();
      std::replace(what.begin(), what.end(), '\n', ' ');
      std::cout << "error " << what << std::endl;
    }
  }
}
