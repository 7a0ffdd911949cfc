// SPDX-License-Identifier: Apache-2.0
#include "phases/output.hpp"

#include "device/step.hpp"
#include "mesh/phase.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;
using runtime::over_large;
using runtime::Runtime;

namespace {

/// Sorts the references of finite faces by canonical order, and returns how many they are. Adds to `gather_ms` what
/// finding them takes.
std::uint32_t sort_faces(Runtime& runtime, Primitives& primitives, const Mesh& mesh, const Vertices& vertices,
                         Buffer<cl_uint>& refs, double& gather_ms) {
  Step gathering(runtime, "gather");
  const cl_uint bits = bit_width(mesh.n);
  auto keys = runtime.allocate<cl_ulong>("output keys", mesh.faces());
  auto finite = runtime.filled<cl_uint>("output count", 1, 0);
  runtime.launch("output", "key_faces", over(mesh.faces()), mesh.faces(), vertices.levels_buffer, bits, mesh.face_data,
                 keys, refs, finite);
  const std::uint32_t triangles = runtime.read_one(finite);
  gather_ms += gathering.end();
  // The first corner's rank is a bucket: most vertices are the first of some triangles, few of many.
  if (triangles != 0) primitives.order_by_buckets(keys, refs, mesh.faces(), triangles, 2 * bits, bits, mesh.n);
  primitives.release();
  runtime.end_step();
  return triangles;
}

/// The same without an order: finite faces by number, each with its first corner.
std::uint32_t select_faces(Runtime& runtime, Primitives& primitives, const Mesh& mesh, Buffer<cl_uint>& refs,
                           double& gather_ms) {
  Step gathering(runtime, "gather");
  auto before = runtime.allocate<cl_uint>("output finite faces", std::size_t{mesh.faces()} + 1);
  runtime.launch("select", "select_finite", over(mesh.faces()), mesh.faces(), mesh.n, mesh.face_data, before);
  const std::uint32_t triangles = primitives.scan_total(before, mesh.faces());
  runtime.launch("select", "select_refs", over(mesh.faces()), mesh.faces(), before, refs);
  primitives.release();
  gather_ms += gathering.end();
  return triangles;
}

OrderedMesh triangles_by_one_item(Runtime& runtime, const Mesh& mesh, const Vertices& vertices) {
  Step gathering(runtime, "gather");
  const cl_uint faces = mesh.faces(), bits = bit_width(mesh.n);
  OrderedMesh ordered = make_ordered(runtime, faces);
  const auto count = runtime.allocate<cl_uint>("output count", 1);
  const auto keys = runtime.allocate<cl_ulong>("output keys", faces),
             other_keys = runtime.allocate<cl_ulong>("other half of the keys", faces);
  const auto refs = runtime.allocate<cl_uint>("output faces", faces),
             other_refs = runtime.allocate<cl_uint>("other half of the values", faces);
  const auto positions = runtime.allocate<cl_int>("output positions", faces);
  runtime.launch("by_one_item", "output_by_one_item", runtime::one_item(), faces, vertices.levels_buffer, bits,
                 mesh.face_data, mesh.edge_faces, mesh.edge_marks, keys, refs, other_keys, other_refs, positions, count,
                 ordered.corners, ordered.neighbours, ordered.constrained);
  const std::size_t triangles = runtime.read_one(count);
  ordered.triangles = static_cast<std::uint32_t>(triangles);
  ordered.corners.shrink(3 * triangles);
  ordered.neighbours.shrink(3 * triangles);
  ordered.constrained.shrink(triangles);
  ordered.gather_ms = gathering.end();
  return ordered;
}

}  // namespace

OrderedMesh make_ordered(Runtime& runtime, std::size_t triangles) {
  OrderedMesh ordered;
  ordered.triangles = static_cast<std::uint32_t>(triangles);
  ordered.corners = runtime.allocate<cl_uint>("output corners", 3 * triangles);
  ordered.neighbours = runtime.allocate<cl_int>("output neighbours", 3 * triangles);
  ordered.constrained = runtime.allocate<cl_uchar>("output flags", triangles);
  return ordered;
}

OrderedMesh order_triangles(Runtime& runtime, Primitives& primitives, const Plan& plan, const Mesh& mesh,
                            const Vertices& vertices, bool canonical, Buffer<cl_uint>* refs_of_triangles) {
  if (canonical && mesh.n >= 3 && plan.output == Plan::By::one) {
    primitives.release();
    return triangles_by_one_item(runtime, mesh, vertices);
  }
  auto refs = runtime.allocate<cl_uint>("output faces", mesh.faces());
  double gather_ms = 0;
  cl_uint count = 0;
  if (mesh.n >= 3)
    count = canonical ? sort_faces(runtime, primitives, mesh, vertices, refs, gather_ms)
                      : select_faces(runtime, primitives, mesh, refs, gather_ms);
  Step gathering(runtime, "gather");
  OrderedMesh ordered = make_ordered(runtime, count);
  ordered.gather_ms = gather_ms;
  if (count == 0) return ordered;
  auto positions = runtime.filled<cl_int>("output positions", mesh.faces(), -1);
  runtime.launch("output", "place_faces", over(count), count, refs, positions);
  runtime.launch("output", "gather_triangles", over(count), count, mesh.face_data, mesh.edge_faces, mesh.edge_marks,
                 refs, positions, ordered.corners, ordered.neighbours, ordered.constrained);
  if (refs_of_triangles) *refs_of_triangles = std::move(refs);
  ordered.gather_ms += gathering.end();
  return ordered;
}

ArrangedForest arrange_problems(Runtime& runtime, Primitives& primitives, const Mesh& mesh, const Vertices& vertices) {
  const cl_uint problems = mesh.roots;
  Step gathering(runtime, "gather");
  ArrangedForest result;
  result.first_triangle = runtime.allocate<cl_uint>("first triangles", std::size_t{problems} + 1);
  runtime.launch("arrange", "arrange_count", over_large(problems), problems, mesh.n, vertices.points, mesh.face_data,
                 mesh.edge_faces, result.first_triangle);
  const cl_uint count = primitives.scan_total(result.first_triangle, problems);
  OrderedMesh& ordered = result.mesh = make_ordered(runtime, count);
  auto least = runtime.allocate<cl_uint>("triangles by least corner", mesh.n);
  auto second = runtime.allocate<cl_uint>("triangles by second corner", mesh.n);
  auto refs = runtime.allocate<cl_uint>("output faces", count);
  auto in_order = runtime.allocate<cl_uint>("output faces in order", count);
  auto positions = runtime.allocate<cl_int>("output positions", mesh.faces());
  runtime.launch("arrange", "arrange_problems", over_large(problems), problems, mesh.n, vertices.points, mesh.face_data,
                 mesh.edge_faces, mesh.edge_marks, result.first_triangle, least, second, refs, in_order, positions,
                 ordered.corners, ordered.neighbours, ordered.constrained);
  ordered.gather_ms = gathering.end();
  return result;
}

Buffer<cl_uint> number_by_input(Runtime& runtime, const Plan& plan, const Vertices& vertices, OrderedMesh& ordered,
                                Pieces& pieces) {
  const auto inputs = static_cast<cl_uint>(vertices.input_vertex.size());
  const cl_uint ends = 2 * pieces.count;
  auto representatives = runtime.allocate<cl_uint>("output representatives", inputs);
  if (inputs != 0 && plan.number == Plan::By::one) {
    runtime.launch("by_one_item", "number_by_one_item", runtime::one_item(), inputs, cl_uint{ordered.triangles},
                   cl_uint{pieces.count}, vertices.vertex_input, vertices.input_vertex, representatives,
                   ordered.corners, pieces.ends, pieces.source_offsets);
    return representatives;
  }
  if (inputs != 0)
    runtime.launch("output", "number_representatives", over(inputs), inputs, vertices.n(), vertices.vertex_input,
                   vertices.input_vertex, representatives);
  number_corners(runtime, vertices, ordered);
  if (ends != 0)
    runtime.launch("output", "number_corners", over(ends), ends, vertices.vertex_input, pieces.ends);
  else
    runtime.fill<cl_uint>(pieces.source_offsets, 0, 1);
  return representatives;
}

void number_corners(Runtime& runtime, const Vertices& vertices, OrderedMesh& ordered) {
  const cl_uint count = 3 * ordered.triangles;
  if (count != 0)
    runtime.launch("output", "number_corners", over(count), count, vertices.vertex_input, ordered.corners);
}

}  // namespace gcdt
