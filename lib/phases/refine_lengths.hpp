// SPDX-License-Identifier: Apache-2.0
// Lengths wanted at vertices that an earlier refinement has added.
#pragma once

#include <vector>

#include "mesh/mesh.hpp"

namespace gcdt {

/// `lengths` has one, in cells, for each vertex of the input. Appends those of the added ones, which are linear on what
/// each was put on, as they were when that was done. All of `origins` are of refinement.
void extend_lengths(runtime::Runtime& runtime, const Vertices& vertices, const runtime::Buffer<cl_uint4>& origins,
                    std::vector<cl_uint>& lengths);

}  // namespace gcdt
