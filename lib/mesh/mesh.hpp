// SPDX-License-Identifier: Apache-2.0
// The triangulation on the device: topology without coordinates (kernels/common/shared.h has the layout).
#pragma once

#include <optional>

#include "common/levels.h"
#include "common/shared.h"
#include "device/runtime.hpp"
#include "order/order.h"

namespace gcdt {

/// A triangulation of the symbolic triangle with all n finite vertices in it when complete; or several, one for each
/// root (kernels/common/forest.h).
struct Mesh {
  std::uint32_t n = 0, roots = 1;
  runtime::Buffer<cl_uint4> face_data;  ///< 2 (2n+1): corners and sides of each face
  runtime::Buffer<cl_uint> edge_faces;  ///< 2 (3n+3) face references
  std::uint64_t claims_below = 0;       ///< all claim words are
  std::uint32_t claims_cleared = 0;     ///< how often
  runtime::Buffer<cl_uint> edge_marks;  ///< 3n+3 words of mark bits

  std::uint32_t faces() const { return faces(n); }
  std::uint32_t edges() const { return edges(n); }
  /// While it holds the first `vertices` vertices.
  std::uint32_t faces(std::uint32_t vertices) const { return device::gcdt_forest_faces(vertices, roots); }
  std::uint32_t edges(std::uint32_t vertices) const { return device::gcdt_forest_edges(vertices, roots); }
};

/// The distinct vertices on the grid, numbered level by level (kernels/common/levels.h).
struct Vertices {
  Grid grid;
  std::optional<device::Decimals> decimals;  ///< of a decimal grid
  device::Levels levels = {};
  runtime::Buffer<device::Levels> levels_buffer;  ///< one element, and a table if levels.tabled
  runtime::Buffer<cl_int2> points;        ///< n grid points; of a forest, what kernels/common/forest.h says behind
  runtime::Buffer<cl_uint> vertex_input;  ///< n: the representative's input number
  runtime::Buffer<cl_uint> input_vertex;  ///< one per input point: its vertex
  std::uint32_t roots = 1;                ///< triangulations in one mesh
  std::uint32_t largest = 0;              ///< input points of the largest of several
  std::uint32_t n() const { return levels.n; }
};

/// What cleaning found on its walks along constraints, as long as the mesh has not changed since.
struct WalkedPieces {
  runtime::Buffer<cl_uint> weights;  ///< about as many faces does each piece cross
  /// By piece, if it is a whole constraint: its first place in `faces`, and the number of its parts. Else (0, 0).
  runtime::Buffer<cl_uint2> parts;
  runtime::Buffer<cl_uint> faces;   ///< where parts begin
  runtime::Buffer<cl_uint> passed;  ///< how many edges they pass
  std::uint64_t crossed = 0;        ///< at least the sum of the weights
  std::uint32_t pool = 0;           ///< the pieces have so many parts at most beyond one each
  std::uint32_t existing = 0;       ///< so many constraints are an edge of the mesh each
};

/// The constraints after cleaning: distinct pieces, none with a vertex inside.
struct Pieces {
  std::uint32_t count = 0;
  runtime::Buffer<cl_uint2> ends;           ///< vertices (lower rank first), sorted by rank
  runtime::Buffer<cl_uint> source_offsets;  ///< count + 1; of no pieces not written before number_by_input()
  runtime::Buffer<cl_uint> sources;         ///< input constraints, ascending within a piece
  std::uint32_t source_count = 0;
  WalkedPieces walked;  ///< until the constraints are enforced
};

}  // namespace gcdt
