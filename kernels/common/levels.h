// SPDX-License-Identifier: Apache-2.0
// Coarse-to-fine levels (paper, section 8, "Upsampling", made geometric). OpenCL C and C++17.
//
// The distinct vertices sorted along the Z-order curve have ranks 0 .. n-1. Level j of K holds the
// ranks that are multiples of its stride and not of the next coarser one: 1 for the finest, then 4, 64, 1024 and so on.
// So every R-th vertex along the curve is coarser, R = 4 for the finest level and 16 for others: each level is spread
// evenly and every new vertex has a coarser one close by on the curve. (Sixteen takes half of the levels that four
// does, for a few more flips; in the finest level, which has most of the vertices, flips are dearer.)
// Vertices are numbered level by level, along the curve inside each: numbers below begin[j] are coarser than level j,
// and number <-> rank is arithmetic.
//
// Where isolated vertices come earlier than their rank says (isolation.h), a table stands for the arithmetic. Level j
// then has more than the ranks above, but never misses one of them: whoever looks for coarser vertices at multiples of
// a stride finds them.
#ifndef GCDT_LEVELS_H
#define GCDT_LEVELS_H

#include "common/shared.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

#define GCDT_FINEST_RATIO 4u
#define GCDT_COARSER_RATIO 16u
// With 2^31 vertices the coarsest of so many has two.
#define GCDT_MAX_LEVELS 9
// The stride of the level so many above the finest: 2 to this power, twice its depth in the quadtree.
#define GCDT_STRIDE_BITS(above) ((above) == 0u ? 0u : 4u * (above)-2u)

typedef struct Levels {
  u32 n;                           // distinct finite vertices
  u32 count;                       // K >= 1
  u32 stride[GCDT_MAX_LEVELS];     // 2^GCDT_STRIDE_BITS(K-1-j)
  u32 begin[GCDT_MAX_LEVELS + 1];  // first vertex of level j; begin[K] = n
  u32 tabled;                      // nonzero: behind the struct stand n ranks by vertex, then n vertices by rank
} Levels;

#ifdef __OPENCL_VERSION__
#define GCDT_LEVELS_POINTER global const Levels*
#define GCDT_TABLE_POINTER global const u32*
#else
#define GCDT_LEVELS_POINTER const Levels*
#define GCDT_TABLE_POINTER const u32*
using std::uintptr_t;
#endif

// By the address: Mesa 22 loses the indices of a pointer to a struct that is cast to another, and a host's compiler
// takes what is behind a struct for nothing.
#define GCDT_LEVELS_TABLE(levels) ((GCDT_TABLE_POINTER)((uintptr_t)(levels) + sizeof(Levels)))

// Rank on the curve of finite vertex v. Ends: j decreases, and begin[0] = 0.
GCDT_INLINE u32 gcdt_rank_of_vertex(GCDT_LEVELS_POINTER levels, u32 v) {
  if (levels->tabled) return GCDT_LEVELS_TABLE(levels)[v];
  u32 j = levels->count - 1u;
  while (v < levels->begin[j]) --j;
  if (j == 0) return v * levels->stride[0];
  const u32 i = v - levels->begin[j], finest = j + 1u == levels->count;
  const u32 coarser = finest ? i / (GCDT_FINEST_RATIO - 1u) : i / (GCDT_COARSER_RATIO - 1u);
  return (i + coarser + 1u) * levels->stride[j];
}

// The finite vertex with that rank, looking at levels 0 .. last only: rank counts in units of
// stride[last]. With last = K-1 it is the plain rank. Ends: j decreases.
GCDT_INLINE u32 gcdt_vertex_of_rank(GCDT_LEVELS_POINTER levels, u32 last, u32 rank) {
  if (levels->tabled) return GCDT_LEVELS_TABLE(levels)[levels->n + rank * levels->stride[last]];
  u32 r = rank;
  for (u32 j = last; j > 0; --j) {
    const u32 ratio = j + 1u == levels->count ? GCDT_FINEST_RATIO : GCDT_COARSER_RATIO, coarser = r / ratio;
    if (r % ratio != 0) return levels->begin[j] + r - coarser - 1u;
    r = coarser;
  }
  return r;
}

// How many vertices of `level` come before rank `unit` of the curve, which counts in units of stride[level]: of these
// ranks, every R-th is coarser.
GCDT_INLINE u32 gcdt_vertices_before(GCDT_LEVELS_POINTER levels, u32 level, u32 unit) {
  const u32 ratio = level + 1u == levels->count ? GCDT_FINEST_RATIO : GCDT_COARSER_RATIO;
  return level == 0 ? unit : unit - (unit + ratio - 1u) / ratio;
}

// Morton code of a grid point: bit 2i is bit i of x, bit 2i+1 is bit i of y.
#define GCDT_MORTON_BITS 62u
GCDT_INLINE u64 gcdt_spread_bits(u64 v) {
  v = (v | (v << 16)) & 0x0000FFFF0000FFFFul;
  v = (v | (v << 8)) & 0x00FF00FF00FF00FFul;
  v = (v | (v << 4)) & 0x0F0F0F0F0F0F0F0Ful;
  v = (v | (v << 2)) & 0x3333333333333333ul;
  return (v | (v << 1)) & 0x5555555555555555ul;
}
GCDT_INLINE u64 gcdt_morton(u32 x, u32 y) { return gcdt_spread_bits(x) | (gcdt_spread_bits(y) << 1); }
// Is the code of p above that of q? The highest bit in which they differ decides, y before x.
GCDT_INLINE int gcdt_after_on_curve(u32 px, u32 py, u32 qx, u32 qy) {
  const u32 x = px ^ qx, y = py ^ qy;
  return y < x && y < (x ^ y) ? px > qx : py > qy;
}
// The inverse of gcdt_spread_bits: the even bits of v. x = gather(code), y = gather(code >> 1).
GCDT_INLINE u32 gcdt_gather_bits(u64 v) {
  v &= 0x5555555555555555ul;
  v = (v | (v >> 1)) & 0x3333333333333333ul;
  v = (v | (v >> 2)) & 0x0F0F0F0F0F0F0F0Ful;
  v = (v | (v >> 4)) & 0x00FF00FF00FF00FFul;
  v = (v | (v >> 8)) & 0x0000FFFF0000FFFFul;
  return (u32)(v | (v >> 16));
}

// The levels of n distinct vertices; the coarsest has at most `coarsest` vertices where K allows.
GCDT_INLINE Levels make_levels(u32 n, u32 coarsest) {
  Levels levels;
  levels.n = n;
  levels.count = 1;
  levels.tabled = 0;
  for (u32 j = 0; j < GCDT_MAX_LEVELS; ++j) levels.stride[j] = levels.begin[j] = 0;
  levels.begin[GCDT_MAX_LEVELS] = 0;
  while (levels.count < GCDT_MAX_LEVELS && n > (u64)coarsest << GCDT_STRIDE_BITS(levels.count - 1u)) ++levels.count;
  levels.begin[levels.count] = n;
  for (u32 j = levels.count; j-- > 0;) {
    const u32 above = levels.count - 1u - j;
    const u64 coarser = (u64)1 << GCDT_STRIDE_BITS(above + 1u);
    levels.stride[j] = 1u << GCDT_STRIDE_BITS(above);
    levels.begin[j] = j == 0 ? 0 : (u32)((n + coarser - 1) / coarser);
  }
  return levels;
}

#ifndef __OPENCL_VERSION__
}  // namespace gcdt::device
#endif

#endif
