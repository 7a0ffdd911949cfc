// SPDX-License-Identifier: Apache-2.0
// Point location on the device (kernels/query/locate.cl).
#pragma once

#include "phases/fans.hpp"
#include "phases/order.hpp"
#include "phases/output.hpp"

namespace gcdt {

/// The mesh in which queries are located. It covers the convex hull; all or some of its triangles are kept.
struct SearchMesh {
  const Vertices& vertices;
  const OrderedMesh& all;
  bool by_input;                           ///< whether corners are input numbers; if not, they are vertices
  const runtime::Buffer<cl_int>* kept;     ///< the place of each triangle of `all` in `result`, or -1; null: all kept
  const OrderedMesh& result;               ///< `all` itself if all are kept
  const runtime::Buffer<cl_uint>& starts;  ///< least triangle of `all` at each vertex (least_triangles)
  const runtime::Buffer<cl_uint>& least;   ///< the same of `result`
  Fans& fans;                              ///< of `all`, made when a query's way is long
};

/// For each query: the least kept triangle that holds it, border included, or -1; the corners of that triangle; and for
/// each corner twice the area of the query with the edge across from it, in cells, exactly.
struct Located {
  runtime::Buffer<cl_int> triangles;
  runtime::Buffer<cl_uint> corners;
  runtime::Buffer<cl_long> areas;
};

/// The least triangle at each vertex; GCDT_NONE if there is none.
runtime::Buffer<cl_uint> least_triangles(runtime::Runtime& runtime, const Vertices& vertices, const OrderedMesh& mesh,
                                         bool by_input);

/// The same for each input vertex; -1 if there is none.
runtime::Buffer<cl_int> least_triangles_by_input(runtime::Runtime& runtime, const Vertices& vertices,
                                                 const runtime::Buffer<cl_uint>& least);

/// Rounds queries to the grid as vertices are, and locates them; a query off the grid is outside. Throws
/// coordinate_not_finite, indices {query, axis}, where the first query has the number `first`, and round_limit. Needs
/// about 100 bytes a query; blocks. Where a query is on its way for long, vertices with many triangles get fans, which
/// later calls find in `mesh`.
Located locate(runtime::Runtime& runtime, Primitives& primitives, const SearchMesh& mesh, const InputPoints& queries,
               std::uint64_t first = 0);

}  // namespace gcdt
