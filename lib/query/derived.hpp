// SPDX-License-Identifier: Apache-2.0
// What a result has to say on demand only, made on the device when first asked for: hull, triangles of vertices, pieces
// of edges, and what point location starts from.
#pragma once

#include "phases/locate.hpp"
#include "phases/triangulation.hpp"

namespace gcdt {

class Derived {
 public:
  /// All refer to a result that is not changed any more.
  const runtime::Buffer<cl_uint>& hull(runtime::Runtime& runtime, Primitives& primitives,
                                       const DeviceTriangulation& result);
  const runtime::Buffer<cl_int>& vertex_triangles(runtime::Runtime& runtime, const DeviceTriangulation& result);
  const runtime::Buffer<cl_int>& edge_pieces(runtime::Runtime& runtime, const DeviceTriangulation& result);
  /// Of the queries; see locate.hpp.
  Located locate(runtime::Runtime& runtime, Primitives& primitives, const DeviceTriangulation& result,
                 const InputPoints& queries, std::uint64_t first = 0);

 private:
  void find_least(runtime::Runtime& runtime, const DeviceTriangulation& result);

  runtime::Buffer<cl_uint> hull_, starts_, least_;  // starts_ only where a domain has left triangles out
  runtime::Buffer<cl_int> vertex_triangles_, edge_pieces_;
  Fans fans_;  // for point location
};

/// The ends of pieces of a result, which are input numbers, as vertices.
runtime::Buffer<cl_uint2> ends_as_vertices(runtime::Runtime& runtime, const Vertices& vertices, const Pieces& pieces);

/// The mesh of the whole convex hull.
const OrderedMesh& hull_mesh(const DeviceTriangulation& result);

/// How many vertices are on the convex hull, those inside its edges included; 0 without triangles.
std::uint64_t hull_count(const DeviceTriangulation& result);

}  // namespace gcdt
