// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "batch_inputs.hpp"

namespace gcdt::bench {

/// Triangulates every problem with Constrained_Delaunay_triangulation_2 and forgets it; the triangles of all.
std::uint64_t triangulate_with_cgal(const SketchBatch& batch);

}  // namespace gcdt::bench
