// SPDX-License-Identifier: Apache-2.0
// Isolated vertices come early. A vertex that goes in after a dense row of others that it has for neighbours in the end
// sees the row through one edge, and each flip gives it one neighbour more: a chain, which no order of flips mends.
// OpenCL C and C++17.
//
// How isolated a vertex is says its depth: the longer of the prefixes that its Morton code shares with its neighbours
// on the curve, in pairs of bits. That is the depth of the smallest cell of the quadtree in which another vertex is.
// The end of a long constraint is seen by whatever lies along it, however near its neighbours are: there the length
// counts.
#ifndef GCDT_ISOLATION_H
#define GCDT_ISOLATION_H

#include "common/levels.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

#define GCDT_DEPTHS 32u
// Tables of how many vertices there are of each depth, a row, and stride, a column: of vertices that are not tied, then
// of those that are; and how many there are of each depth, tied or not.
#define GCDT_FREE_COUNT(depth, strides) ((depth)*GCDT_MAX_LEVELS + (strides))
#define GCDT_TIED_COUNT(depth, strides) GCDT_FREE_COUNT(GCDT_DEPTHS + (depth), strides)
#define GCDT_EACH_COUNT(depth) GCDT_FREE_COUNT(2u * GCDT_DEPTHS, depth)
#define GCDT_DEPTH_COUNTS GCDT_EACH_COUNT(GCDT_DEPTHS)

// Of a cell that is at most as large as a length below 2^31 along an axis, and more than half as large; 32 for 0.
GCDT_INLINE u32 gcdt_depth_of_length(u32 length) {
  u32 depth = 32;
  for (; length > 0u; length >>= 1) --depth;
  return depth;
}

// A vertex is tied to a constraint that is so many depths longer than its neighbours are away. The depth that counts of
// it is the length's, and less the more neighbours may lie along the constraint.
#define GCDT_TIED 2u
GCDT_INLINE u32 gcdt_is_tied(u32 depth, u32 length) { return depth >= length + GCDT_TIED; }
GCDT_INLINE u32 gcdt_tied_depth(u32 depth, u32 length) {
  const u32 more = depth - length - (GCDT_TIED - 1u);
  return length > more ? length - more : 0u;
}

// The column of a rank: how often the ratio divides it.
GCDT_INLINE u32 gcdt_strides_of_rank(u32 rank) {
  u32 strides = 0;
  while (strides + 1u < GCDT_MAX_LEVELS && (rank & ((GCDT_LEVEL_RATIO << 2u * strides) - 1u)) == 0u) ++strides;
  return strides;
}

// Vertices less deep than these are of level j at least, however odd their rank. Both ascend with j.
typedef struct DepthLevels {
  u32 free_below[GCDT_MAX_LEVELS], tied_below[GCDT_MAX_LEVELS];
} DepthLevels;

#ifdef __OPENCL_VERSION__
#define GCDT_DEPTH_LEVELS_POINTER global const DepthLevels*
#else
#define GCDT_DEPTH_LEVELS_POINTER const DepthLevels*
#endif

// The level of a vertex: that of its rank, or that of its depth if it is coarser. Ends: j falls.
GCDT_INLINE u32 gcdt_level(u32 levels, GCDT_DEPTH_LEVELS_POINTER by, u32 strides, u32 depth, u32 tied) {
  u32 j = strides < levels ? levels - 1u - strides : 0u;
  while (j > 0u && depth < (tied ? by->tied_below[j - 1u] : by->free_below[j - 1u])) --j;
  return j;
}

#ifndef __OPENCL_VERSION__
}  // namespace gcdt::device
#endif

#endif
