// SPDX-License-Identifier: Apache-2.0
// Where a query stands in its search. OpenCL C and C++17.
#ifndef GCDT_LOCATE_H
#define GCDT_LOCATE_H

#include "common/levels.h"
#include "constrain/fan.h"

// The key of a query that is not on the grid: above every Morton code.
#define GCDT_OFF_GRID ((u64)1 << GCDT_MORTON_BITS)

// Triangles that a walk goes through in one launch at most. After the first one fans are made, of which walks that are
// long only because triangles are many there have no use: hundreds of steps are usual where vertices are sparse.
#define GCDT_LOCATE_STEPS 1024u

#ifdef __OPENCL_VERSION__
// A corner is the number of an input vertex (`by_input`) or of a vertex.
GCDT_INLINE uint vertex_of(global const uint* input_vertex, uint by_input, uint corner) {
  return by_input ? input_vertex[corner] : corner;
}

#endif

#endif
