// SPDX-License-Identifier: Apache-2.0
// A mesh of many triangulations at once, a forest: one root triangle for each problem of a batch.
// OpenCL C only.
//
// Without GCDT_FOREST the mesh has one root and everything here is a constant: the programs are what they
// would be if there were no forests. With it, words behind the points say which problem a vertex is of (shared.h).
//
// Problem p has the root face p, the root edges 3p .. 3p+2, and symbolic vertices of its own, n + 3p .. n + 3p+2,
// which stand for the same three directions in all problems: so no directed edge occurs twice in the forest.
// Ranks run through the problems one after the other: those of problem p are [first rank, next first rank).
// Each problem's faces are linked among themselves only. Until constraints are enforced, slot p is one of them, and so
// are those that the problem's vertices bring: a split leaves the first child in the slot, a flip exchanges faces of
// one problem. Enforcement hands out the slots of all crossed faces and edges together, so that problems exchange some.
#ifndef GCDT_FOREST_H
#define GCDT_FOREST_H

#include "common/levels.h"

#ifdef GCDT_FOREST

static inline global const uint* forest_words(global const int2* points, uint n) {
  return (global const uint*)(points + n);
}
static inline uint root_count(global const int2* points, uint n) {
  return forest_words(points, n)[GCDT_FOREST_ROOTS_WORD];
}
static inline uint problem_of(global const int2* points, uint n, uint v) {
  return forest_words(points, n)[gcdt_problem_word(v)];
}
// Of each problem, and behind the last.
static inline global const uint* first_ranks(global const int2* points, uint n) {
  return forest_words(points, n) + gcdt_first_rank_word(n, 0u);
}
static inline uint first_rank(global const int2* points, uint n, uint problem) {
  return first_ranks(points, n)[problem];
}
static inline uint root_of(global const int2* points, uint n, uint v) { return problem_of(points, n, v); }
// Which of the three directions symbolic vertex v >= n stands for.
static inline uint symbol_of(uint v, uint n) { return (v - n) % 3u; }

// The vertices of a problem in the levels up to `level`, as ranks in units of stride[level]: from x up to y.
static inline uint2 units_of_problem(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint n,
                                     uint problem) {
  const uint stride = levels->stride[level];
  return (uint2)((first_rank(points, n, problem) + stride - 1u) / stride,
                 (first_rank(points, n, problem + 1u) + stride - 1u) / stride);
}

// The vertices of v's problem that are coarser than `level`, as ranks in units of stride[level - 1]: from x up to y.
static inline uint2 coarse_units(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint n, uint v) {
  return units_of_problem(levels, level - 1u, points, n, problem_of(points, n, v));
}

// The problems of this work-item, all of each.
static inline Items trees_of_this(uint problems, global const int2* points, uint n) {
  return problems_of_this(problems, first_ranks(points, n));
}

#else

static inline uint first_rank(global const int2* points, uint n, uint problem) { return problem == 0u ? 0u : n; }
static inline Items trees_of_this(uint problems, global const int2* points, uint n) { return items_of_this(problems); }
static inline uint root_count(global const int2* points, uint n) { return 1u; }
static inline uint root_of(global const int2* points, uint n, uint v) { return 0u; }
static inline uint symbol_of(uint v, uint n) { return v - n; }
static inline uint2 coarse_units(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint n, uint v) {
  const uint stride = levels->stride[level - 1u];
  return (uint2)(0u, (n + stride - 1u) / stride);
}

#endif

#endif
