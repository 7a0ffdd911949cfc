// SPDX-License-Identifier: Apache-2.0
// Searches by bisection, of them also the nearer of two on the curve. OpenCL C only.
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

// The last rank in [low, high), in units of stride[last], of a vertex whose Morton code is not above that of `at`; low
// if there is none. Ends: the range halves.
static inline uint last_on_curve(GCDT_LEVELS_POINTER levels, uint last, global const int2* points, uint low, uint high,
                                 int2 at) {
  while (high - low > 1u) {
    const uint middle = low + (high - low) / 2u;
    const int2 p = points[gcdt_vertex_of_rank(levels, last, middle)];
    if (gcdt_after_on_curve((uint)p.x, (uint)p.y, (uint)at.x, (uint)at.y))
      high = middle;
    else
      low = middle;
  }
  return low;
}

static inline u64 distance_squared(int2 p, int2 q) {
  const i64 dx = (i64)p.x - q.x, dy = (i64)p.y - q.y;
  return (u64)(dx * dx) + (u64)(dy * dy);
}

// Of the coarser vertices `unit` and `unit` + 1 along the curve, in units of level `level` - 1, the one nearer to
// p: where the curve jumps, one of them is often still close. There are coarser ones up to unit `coarse`.
static inline uint nearer_coarse_vertex(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint coarse,
                                        uint unit, int2 p) {
  const uint before = gcdt_vertex_of_rank(levels, level - 1u, unit);
  if (unit + 1u >= coarse) return before;
  const uint after = gcdt_vertex_of_rank(levels, level - 1u, unit + 1u);
  return distance_squared(p, points[before]) <= distance_squared(p, points[after]) ? before : after;
}

#endif
