// SPDX-License-Identifier: Apache-2.0
// Isolated vertices come early. A vertex that goes in after a dense row of others that it has for neighbours in the end
// sees the row through one edge, and each flip gives it one neighbour more: a chain, which no order of flips mends.
// OpenCL C and C++17.
//
// How isolated a vertex is says its depth: the longer of the prefixes that its Morton code shares with its neighbours
// on the curve, in pairs of bits. That is the depth of the smallest cell of the quadtree in which another vertex is.
#ifndef GCDT_ISOLATION_H
#define GCDT_ISOLATION_H

#include "common/levels.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

#define GCDT_QUADTREE_DEPTHS 32u
// A table of how many vertices there are of each depth, a row, and stride, a column.
#define GCDT_DEPTH_COUNT(depth, strides) ((depth)*GCDT_MAX_LEVELS + (strides))
#define GCDT_DEPTH_COUNTS GCDT_DEPTH_COUNT(GCDT_QUADTREE_DEPTHS, 0u)

// The column of a rank: how many levels above the finest it is, if there are so many. Ends: strides grow to 2^30.
GCDT_INLINE u32 gcdt_strides_of_rank(u32 rank) {
  u32 strides = 0;
  while (strides + 1u < GCDT_MAX_LEVELS && (rank & ((1u << GCDT_STRIDE_BITS(strides + 1u)) - 1u)) == 0u) ++strides;
  return strides;
}

// Vertices less deep than below[j] are of level j at least, however odd their rank. It ascends with j.
typedef struct DepthLevels {
  u32 below[GCDT_MAX_LEVELS];
} DepthLevels;

#ifdef __OPENCL_VERSION__
#define GCDT_DEPTH_LEVELS_POINTER global const DepthLevels*
#else
#define GCDT_DEPTH_LEVELS_POINTER const DepthLevels*
#endif

// The level of a vertex: that of its rank, or that of its depth if it is coarser. Ends: j falls.
GCDT_INLINE u32 gcdt_level(u32 levels, GCDT_DEPTH_LEVELS_POINTER by, u32 strides, u32 depth) {
  u32 j = strides < levels ? levels - 1u - strides : 0u;
  while (j > 0u && depth < by->below[j - 1u]) --j;
  return j;
}

#ifndef __OPENCL_VERSION__
}  // namespace gcdt::device
#endif

#endif
