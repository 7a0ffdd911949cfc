// SPDX-License-Identifier: Apache-2.0
// CGAL on one core, as a peer (bench/peer.hpp): Delaunay_triangulation_2 from a range of points, or
// Constrained_Delaunay_triangulation_2 with insert_constraints by index, both with CGAL's own spatial sort and
// exact predicates on doubles. Reading the file is not timed.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>

#include "cgal_peer.hpp"

namespace {

using namespace gcdt::bench;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<Kernel>;

Answer run(const PeerInput& input) {
  const double start = now();
  if (input.constraints.empty()) {
    Delaunay mesh;
    mesh.insert(input.points.begin(), input.points.end());
    return {now() - start, mesh.number_of_faces()};
  }
  Constrained mesh;
  mesh.insert_constraints(input.points.begin(), input.points.end(), input.constraints.begin(), input.constraints.end());
  return {now() - start, mesh.number_of_faces()};
}

}  // namespace

int main() { serve("cgal", run); }
