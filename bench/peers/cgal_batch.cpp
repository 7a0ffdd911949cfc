// SPDX-License-Identifier: Apache-2.0
// CGAL on one core, problem after problem: the batch's peer.
#include "cgal_batch.hpp"

#include <utility>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace gcdt::bench {

std::uint64_t triangulate_with_cgal(const SketchBatch& batch) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::uint64_t triangles = 0;
  std::vector<Kernel::Point_2> points;
  std::vector<std::pair<std::size_t, std::size_t>> lines;
  for (std::size_t p = 0; p < batch.size(); ++p) {
    points.clear();
    lines.clear();
    for (std::uint64_t v = batch.vertex_offsets[p]; v < batch.vertex_offsets[p + 1]; ++v)
      points.emplace_back(batch.vertices[v][0], batch.vertices[v][1]);
    for (std::uint64_t c = batch.constraint_offsets[p]; c < batch.constraint_offsets[p + 1]; ++c)
      lines.emplace_back(batch.constraints[c][0], batch.constraints[c][1]);
    CGAL::Constrained_Delaunay_triangulation_2<Kernel> mesh;
    // Without constraints it would insert nothing.
    if (lines.empty()) mesh.insert(points.begin(), points.end());
    mesh.insert_constraints(points.begin(), points.end(), lines.begin(), lines.end());
    triangles += mesh.number_of_faces();
  }
  return triangles;
}

}  // namespace gcdt::bench
