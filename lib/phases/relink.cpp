// SPDX-License-Identifier: Apache-2.0
#include "phases/relink.hpp"

#include "mesh/phase.hpp"

namespace gcdt {

using runtime::over;
using runtime::Runtime;

RelinkedMesh relink(Runtime& runtime, Primitives& primitives, const Vertices& vertices, const OrderedMesh& ordered) {
  const cl_uint triangles = ordered.triangles, half_edges = 3 * triangles, n = vertices.n();
  auto owned = runtime.allocate<cl_uint>("numbers of edges", std::size_t{half_edges} + 1),
       before = runtime.allocate<cl_uint>("hull edges before", std::size_t{half_edges} + 1);
  runtime.launch("relink", "relink_flags", over(half_edges), half_edges, ordered.neighbours, owned, before);
  primitives.exclusive_scan(owned, owned, half_edges);
  const cl_uint count = primitives.scan_total(before, half_edges);
  if (std::uint64_t{triangles} + count + 2 != 2 * std::uint64_t{n})
    throw Error(Status::check_failed, "relink: the edges of the hull do not fit the triangles");
  auto hull = runtime.allocate<cl_uint>("hull edges", count), entering = runtime.allocate<cl_uint>("hull edges in", n);
  primitives.compact_indices(before, hull, half_edges);
  before = {};
  primitives.release();
  RelinkedMesh made = {make_mesh(runtime, n), runtime.allocate<cl_uint>("faces of triangles", triangles)};
  Mesh& mesh = made.mesh;
  mesh.claims_below = 1;
  runtime.launch("relink", "relink_entering", over(count), count, hull, ordered.corners, vertices.input_vertex,
                 entering);
  runtime.launch("relink", "relink_faces", over(triangles), triangles, count, ordered.corners, ordered.neighbours,
                 ordered.constrained, vertices.input_vertex, owned, mesh.face_data, mesh.edge_faces, mesh.edge_marks,
                 made.refs);
  runtime.launch("relink", "relink_outside", over(count), count, triangles, n, vertices.points, hull, ordered.corners,
                 vertices.input_vertex, owned, entering, mesh.face_data, mesh.edge_faces, mesh.edge_marks);
  return made;
}

}  // namespace gcdt
