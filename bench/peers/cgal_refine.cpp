// SPDX-License-Identifier: Apache-2.0
// CGAL's Mesh_2 on one core, as a peer (bench/peer.hpp) of refinement: the whole call, from a range of points to the
// refined mesh, Constrained_Delaunay_triangulation_2 and Delaunay_mesher_2 by angle alone. Its argument is Triangle's
// switches: p (segments), c (the hull is a border), q ANGLE. Reading the file is not timed. For measurement only.
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>

#include "cgal_peer.hpp"

namespace {

using namespace gcdt::bench;
using Vertex = CGAL::Delaunay_mesh_vertex_base_2<Kernel>;
using Face = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Mesh = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Mesh>;
using Mesher = CGAL::Delaunay_mesher_2<Mesh, Criteria>;

// Above 20.7 degrees nobody promises that it ends.
constexpr std::size_t most_added_per_vertex = 40;

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

Answer run(const PeerInput& input, double angle, bool hull) {
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
  Answer made = {now() - start};
  double least = 180;
  for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face)
    if (face->is_in_domain()) {
      ++made.triangles;
      least = std::min(least, least_angle(*face));
    }
  std::ostringstream more;  // of equal points CGAL keeps one
  more << " mesh " << input.points.size() + mesh.number_of_vertices() - given << ' ' << least;
  made.more = more.str();
  return made;
}

}  // namespace

int main(int count, char** words) {
  const std::string switches = count > 1 ? words[1] : "";
  const std::size_t q = switches.find('q');
  const double angle = q == std::string::npos ? 20 : std::strtod(switches.c_str() + q + 1, nullptr);
  const bool hull = switches.find('p') == std::string::npos || switches.find('c') != std::string::npos;
  serve("cgal-mesh-2", [&](const PeerInput& input) { return run(input, angle, hull); });
}
