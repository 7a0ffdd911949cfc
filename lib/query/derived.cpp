// SPDX-License-Identifier: Apache-2.0
#include "query/derived.hpp"

#include "mesh/phase.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

const OrderedMesh& hull_mesh(const DeviceTriangulation& result) {
  return result.kept.allocated() ? result.hull : result.mesh;
}

// T = 2 n - 2 - h.
std::uint64_t hull_count(const DeviceTriangulation& result) {
  const std::uint64_t triangles = hull_mesh(result).triangles;
  return triangles == 0 ? 0 : 2 * std::uint64_t{result.vertices.n()} - 2 - triangles;
}

Buffer<cl_uint2> ends_as_vertices(Runtime& runtime, const Vertices& vertices, const Pieces& pieces) {
  auto ends = runtime.allocate<cl_uint2>("ends as vertices", pieces.count);
  const cl_uint count = 2 * pieces.count;
  if (count != 0) runtime.launch("hull", "number_ends", over(count), count, pieces.ends, vertices.input_vertex, ends);
  return ends;
}

const Buffer<cl_uint>& Derived::hull(Runtime& runtime, Primitives& primitives, const DeviceTriangulation& result) {
  if (hull_.allocated()) return hull_;
  const OrderedMesh& mesh = hull_mesh(result);
  const Vertices& vertices = result.vertices;
  const cl_uint half_edges = 3 * mesh.triangles;
  auto places = runtime.allocate<cl_uint>("places of hull edges", std::size_t{half_edges} + 1);
  if (half_edges != 0) runtime.launch("hull", "hull_flags", over(half_edges), half_edges, mesh.neighbours, places);
  const cl_uint count = primitives.scan_total(places, half_edges);
  if (count != hull_count(result)) throw Error(Status::check_failed, "hull: its edges do not fit the triangles");
  auto edges = runtime.allocate<cl_uint>("hull edges", count);
  primitives.compact_indices(places, edges, half_edges);
  places = {};
  auto made = runtime.allocate<cl_uint>("hull", count);
  if (count != 0) {
    auto edge_at = runtime.filled<cl_uint>("hull edges at vertices", vertices.n(), 0);
    auto first = runtime.filled<cl_uint>("first rank of hull", 1, GCDT_NONE);
    auto links = runtime.allocate<cl_uint2>("hull links", count),
         doubled = runtime.allocate<cl_uint2>("hull links", count);
    runtime.launch("hull", "hull_starts", over(count), count, vertices.levels_buffer, edges, mesh.corners,
                   vertices.input_vertex, edge_at, first);
    runtime.launch("hull", "hull_links", over(count), count, vertices.levels_buffer, edges, mesh.corners,
                   vertices.input_vertex, edge_at, first, links);
    for (unsigned round = bit_width(count); round > 0; --round) {
      runtime.launch("hull", "hull_double", over(count), count, links, doubled);
      std::swap(links, doubled);
    }
    runtime.launch("hull", "hull_order", over(count), count, edges, mesh.corners, links, made);
  }
  runtime.finish();
  primitives.release();
  return hull_ = std::move(made);
}

void Derived::find_least(Runtime& runtime, const DeviceTriangulation& result) {
  if (!least_.allocated()) least_ = least_triangles(runtime, result.vertices, result.mesh, true);
}

const Buffer<cl_int>& Derived::vertex_triangles(Runtime& runtime, const DeviceTriangulation& result) {
  if (vertex_triangles_.allocated()) return vertex_triangles_;
  find_least(runtime, result);
  auto made = least_triangles_by_input(runtime, result.vertices, least_);
  runtime.finish();
  return vertex_triangles_ = std::move(made);
}

const Buffer<cl_int>& Derived::edge_pieces(Runtime& runtime, const DeviceTriangulation& result) {
  if (edge_pieces_.allocated()) return edge_pieces_;
  const Pieces& pieces = result.pieces;
  const cl_uint half_edges = 3 * result.mesh.triangles;
  const Buffer<cl_uint2> ends = ends_as_vertices(runtime, result.vertices, pieces);
  auto made = runtime.allocate<cl_int>("pieces of edges", half_edges);
  if (half_edges != 0)
    runtime.launch("hull", "edge_pieces", over(half_edges), half_edges, result.vertices.levels_buffer,
                   result.mesh.corners, result.mesh.constrained, result.vertices.input_vertex, cl_uint{pieces.count},
                   ends, made);
  runtime.finish();
  return edge_pieces_ = std::move(made);
}

Located Derived::locate(Runtime& runtime, Primitives& primitives, const DeviceTriangulation& result,
                        const InputPoints& queries, std::uint64_t first) {
  find_least(runtime, result);
  const bool selected = result.kept.allocated();
  if (selected && !starts_.allocated()) starts_ = least_triangles(runtime, result.vertices, result.hull, true);
  const SearchMesh mesh = {result.vertices, hull_mesh(result),           true,   selected ? &result.kept : nullptr,
                           result.mesh,     selected ? starts_ : least_, least_, fans_};
  return gcdt::locate(runtime, primitives, mesh, queries, first);
}

}  // namespace gcdt
