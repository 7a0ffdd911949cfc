// SPDX-License-Identifier: Apache-2.0
#include "phases/arrange.hpp"

#include "device/step.hpp"

namespace gcdt {

using runtime::over_large;

ArrangedForest arrange_problems(runtime::Runtime& runtime, Primitives& primitives, const Mesh& mesh,
                                const Vertices& vertices) {
  const cl_uint problems = mesh.roots;
  Step gathering(runtime, "gather");
  ArrangedForest result;
  result.first_triangle = runtime.allocate<cl_uint>("first triangles", std::size_t{problems} + 1);
  auto least = runtime.allocate<cl_uint>("triangles by least corner", mesh.n);
  auto second = runtime.allocate<cl_uint>("triangles by second corner", mesh.n);
  runtime.launch("arrange", "arrange_count", over_large(problems), problems, mesh.n, vertices.points, mesh.face_data,
                 mesh.edge_faces, least, second, result.first_triangle);
  primitives.exclusive_scan(result.first_triangle, result.first_triangle, problems);
  const cl_uint count = runtime.read_one(result.first_triangle, problems);
  OrderedMesh& ordered = result.mesh;
  ordered.triangles = count;
  ordered.corners = runtime.allocate<cl_uint>("output corners", std::size_t{3} * count);
  ordered.neighbours = runtime.allocate<cl_int>("output neighbours", std::size_t{3} * count);
  ordered.constrained = runtime.allocate<cl_uchar>("output flags", count);
  auto refs = runtime.allocate<cl_uint>("output faces", count);
  auto in_order = runtime.allocate<cl_uint>("output faces in order", count);
  auto positions = runtime.allocate<cl_int>("output positions", mesh.faces());
  runtime.launch("arrange", "arrange_problems", over_large(problems), problems, mesh.n, vertices.points, mesh.face_data,
                 mesh.edge_faces, mesh.edge_marks, result.first_triangle, least, second, refs, in_order, positions,
                 ordered.corners, ordered.neighbours, ordered.constrained);
  ordered.gather_ms = gathering.end();
  return result;
}

}  // namespace gcdt
