// SPDX-License-Identifier: Apache-2.0
// What goes into a run of the phases, and what it leaves, both in device memory.
#pragma once

#include <functional>

#include "phases/clean.hpp"
#include "phases/domain.hpp"
#include "phases/order.hpp"
#include "phases/refine.hpp"
#include "phases/split.hpp"

namespace gcdt {

/// The input, where the phases find all of it.
struct DeviceInput {
  InputPoints points;
  runtime::Buffer<cl_uint2> constraints;  ///< pairs of input points
};

/// Where the input comes from. `load` is called as part of the order step; and once more at the end for a note, where
/// rounding may have put all vertices on one line. What it reads must last as long as the call.
struct InputSource {
  std::uint64_t n = 0, m = 0;  ///< vertices and constraints
  std::function<DeviceInput()> load;
};

/// Arrays of the host's, which must last as long.
inline InputSource source_of(runtime::Runtime& runtime, Points points, Constraints constraints) {
  return {points.size(), constraints.size(), [&runtime, points, constraints] {
            return DeviceInput{stage(runtime, points), stage(runtime, constraints)};
          }};
}

/// `count` vertices of an array, from number `first` on.
inline Points part_of(Points::Type type, const void* vertices, std::size_t first, std::size_t count) {
  switch (type) {
    case Points::Type::float32: return Points::pairs(static_cast<const float*>(vertices) + 2 * first, count);
    case Points::Type::int32: return Points::pairs(static_cast<const std::int32_t*>(vertices) + 2 * first, count);
    case Points::Type::int64: return Points::pairs(static_cast<const std::int64_t*>(vertices) + 2 * first, count);
    default: return Points::pairs(static_cast<const double*>(vertices) + 2 * first, count);
  }
}

/// The result; all numbers are input numbers.
struct DeviceTriangulation {
  OrderedMesh mesh;
  runtime::Buffer<cl_uint> representatives;  ///< one per input vertex, then per added one
  Pieces pieces;
  runtime::Buffer<cl_uint> dropped;  ///< constraints, ascending
  Regions regions;                   ///< empty unless asked for
  Vertices vertices;
  OrderedMesh hull;              ///< all triangles, where a domain has left some out
  runtime::Buffer<cl_int> kept;  ///< the place of each of them in `mesh`, or -1
  AddedVertices added;
  runtime::Buffer<cl_uint> routed;  ///< of splitting: 1 for each constraint that was replaced by its route
  RefineResult refined;
  runtime::Buffer<cl_uchar> excuses;  ///< of refinement: GCDT_EXCUSE_... by triangle
  Chains chains;                      ///< of refinement: what another one goes on from
  bool adopted = false;               ///< `mesh` was there before: the hull has all its edges as constraints
  Statistics statistics;
};

}  // namespace gcdt
