// SPDX-License-Identifier: Apache-2.0
// Searches by bisection. OpenCL C only.
#ifndef GCDT_SEARCH_H
#define GCDT_SEARCH_H

#include "common/levels.h"

// The last i in [0, count) with begins[i] <= at, which ascend; 0 if there is none. Ends: the range halves.
static inline uint last_begin(global const uint* begins, uint count, uint at) {
  uint low = 0, high = count;
  while (high - low > 1u) {
    const uint middle = low + (high - low) / 2u;
    if (begins[middle] <= at)
      low = middle;
    else
      high = middle;
  }
  return low;
}

// The last rank in [low, high), in units of stride[last], of a vertex whose Morton code is not above `code`; low if
// there is none. Ends: the range halves.
static inline uint last_on_curve(GCDT_LEVELS_POINTER levels, uint last, global const int2* points, uint low, uint high,
                                 u64 code) {
  while (high - low > 1u) {
    const uint middle = low + (high - low) / 2u;
    const int2 p = points[gcdt_vertex_of_rank(levels, last, middle)];
    if (gcdt_morton((uint)p.x, (uint)p.y) <= code)
      low = middle;
    else
      high = middle;
  }
  return low;
}

#endif
