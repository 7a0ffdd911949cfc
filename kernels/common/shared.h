// SPDX-License-Identifier: Apache-2.0
// Types, sentinels, bit layouts and counters that kernels and host share. OpenCL C and C++17.
#ifndef GCDT_SHARED_H
#define GCDT_SHARED_H

#ifdef __OPENCL_VERSION__
typedef int i32;
typedef uint u32;
typedef long i64;
typedef ulong u64;
#define GCDT_INLINE static inline
// A function that is given local memory. It has to become part of the kernel: PoCL gives each work-group its own copy
// of those local variables that it finds in the kernel, and a compiler that keeps such a function apart may put the one
// variable that all its calls are given into it, where every group then shares it (tests/device/local_memory.sh looks
// for it).
#define GCDT_GIVEN_LOCAL static inline __attribute__((always_inline))
// A function that a compiler is to keep apart from the kernels that call it. PoCL (3 to 6) compiles a kernel's text
// three times over, by itself and in two launchers that it becomes part of, but what those call once: of large kernels
// this is most of the time of a first call. Such a function is given no local memory, as said above, and it has no
// barrier and does not ask which work-item it is for: PoCL makes one that does part of the kernel after all. Elsewhere
// it is as any other.
#ifdef GCDT_CONTIGUOUS
#define GCDT_APART static __attribute__((noinline))
#else
#define GCDT_APART static inline
#endif
// Before kernels that one work-group does by itself: how many work-items it has, where the host says so to the
// compiler.
#ifdef GCDT_ONE_GROUP
#define GCDT_BY_ONE_GROUP __attribute__((reqd_work_group_size(GCDT_ONE_GROUP, 1, 1)))
#else
#define GCDT_BY_ONE_GROUP
#endif
#include "common/loops.h"
#else
#include <cstdint>
namespace gcdt::device {
typedef std::int32_t i32;
typedef std::uint32_t u32;
typedef std::int64_t i64;
typedef std::uint64_t u64;
#define GCDT_INLINE inline
#endif

// No triangle, edge, vertex or constraint has this number.
#define GCDT_NONE 0xFFFFFFFFu

// ---- The mesh -----------------------------------------------------------------------------------
// n finite vertices 0 .. n-1 and three symbolic ones n, n+1, n+2 (predicates.h).
// A complete triangulation of the symbolic triangle has 2n+1 faces and 3n+3 edges.
//
//   face_data     = for each face t two uint4, in one cache sector:
//   corners[t]    = face_data[GCDT_CORNERS(t)]: the three corners, counter-clockwise; w: claim word (mesh.h)
//   sides[t]      = face_data[GCDT_SIDES(t)]: sides[t][k] is the side code of the edge opposite corner k; w: spare
//   edge_faces[s] = uint: the face reference on side s of edge s/2
//   edge_marks[e] = uint: bits below
//
//   side code       31 .............. 1   0          face reference  31 ............. 2   1 .. 0
//                   edge number           side                        face number          corner k
//
// edge_faces[sides[t][k]] == (t, k): side codes index edge_faces; s ^ 1 is the other side.
// Every word has one owner: whoever owns face t owns corners[t], sides[t] and edge_faces[sides[t][k]]
// (L1 in kernels/README.md).
#define GCDT_CORNERS(face) (2u * (face))
#define GCDT_SIDES(face) (2u * (face) + 1u)
#define GCDT_FACE_REF(face, corner) (((u32)(face) << 2) | (u32)(corner))
#define GCDT_REF_FACE(ref) ((ref) >> 2)
#define GCDT_REF_CORNER(ref) ((ref)&3u)
#define GCDT_SIDE(edge, side) (((u32)(edge) << 1) | (u32)(side))
#define GCDT_SIDE_EDGE(code) ((code) >> 1)

GCDT_INLINE u32 gcdt_face_count(u32 n) { return 2u * n + 1u; }

// The same of a forest (forest.h) with so many roots. Vertex v brings faces 2v and 2v+1, edges 3v .. 3v+2 behind
// those of the roots.
GCDT_INLINE u32 gcdt_forest_faces(u32 n, u32 roots) { return 2u * n + roots; }
GCDT_INLINE u32 gcdt_forest_edges(u32 n, u32 roots) { return 3u * (n + roots); }

// The array `points` of a forest with so many roots goes on behind its n points, in words:
//
//   [0] roots   [1] spare   [2 .. 2 + n) the problem of vertex v   [2 + n .. 2 + n + roots] the first rank of problem p
//
// The last element is the end of the last problem's ranks.
#define GCDT_FOREST_ROOTS_WORD 0u
GCDT_INLINE u32 gcdt_problem_word(u32 v) { return 2u + v; }
GCDT_INLINE u32 gcdt_first_rank_word(u32 n, u32 problem) { return 2u + n + problem; }
// Elements of `points`, each as long as two words.
GCDT_INLINE u64 gcdt_forest_points(u32 n, u32 roots) { return n + ((u64)gcdt_first_rank_word(n, roots) + 2u) / 2u; }

// edge_marks
#define GCDT_MARK_CONSTRAINED 1u  // part of a constraint: never flipped, never crossed
#define GCDT_MARK_QUEUED 2u       // stands in the list of edges to be tested next

// Edges whose marks a work-item of a sweep reads at once, as one uint4 (flip.cl).
#define GCDT_SWEEP_EDGES 4u

// ---- Failure bits (Counters.failed) ---------------------------------------------------------------
#define GCDT_FAILED_WALK 1u      // a walk did not find what must be there
#define GCDT_FAILED_CROSSING 2u  // two constraints cross (comparator or a crossed constrained edge)
#define GCDT_FAILED_COUNT 4u     // crossed triangles and new triangles differ in number
#define GCDT_FAILED_MATCH 8u     // an edge of a new triangle has no partner
#define GCDT_FAILED_MISSING 16u  // a constraint is not an edge after enforcement
#define GCDT_FAILED_HIT 32u      // a vertex inside a piece: cleaning should have split there
#define GCDT_FAILED_INDEX 64u    // an end of a constraint is no input vertex

// Everything the device reports to the host; zeroed at the start of a phase.
typedef struct Counters {
  u32 failed;
  u32 history_depth;
  u32 edge_splits;
  u32 chunks;        // of owned vertices, taken from the pool by walks (constrain.cl)
  u32 list_test[3];  // lengths of the flip phase's lists, by round modulo 3 and 2
  u32 list_flip[2];
  u32 list_insert[2];  // lengths of the insert phase's lists, by round modulo 2; where problems have lists of their own
                       // list_test[0] is the problems that have edges left, list_insert[0] the vertices left
  u32 rounds;          // rounds done inside one work-group; of problems by groups of their own: the most
  u32 patch_rounds[4];  // of flips within a patch of the mesh, and in turn within districts: the most
  u32 patches_left;     // patches that have left all their edges to others
  u32 flips_low, flips_high;
  u32 steps_low, steps_high;  // triangles visited by point location
  u32 pairs_low, pairs_high;  // crossed (triangle, constraint) pairs
  u32 existing_edges;
  u32 symbolic_chain_vertices;
  u32 hexagons;
  u32 new_edges, spare_edges;        // taken from the list of spare slots, and its length (slots.cl)
  u32 crossed_faces, crossed_edges;  // lengths of their lists (constrain.cl)
  u32 owned_left, owned_right;       // vertices of all chains
  u32 hits;                          // vertices inside constraints (clean.cl, enforce.cl)
  u32 unfinished;                    // parts of constraints whose walk failed, for want of fans or for good (clean.cl)
  u32 lost;             // of refinement: what a round has changed is not all found by its vertices (refine/propose.h)
  u32 zero_length;      // constraints without a length (enforce.cl)
  u32 pairs_of_two[4];  // by intersection_case() (constrain.cl)
} Counters;

// ---- Layers of minima over the chains (kernels/constrain/constrain.cl) ------------------------------------------
#define GCDT_MINIMA_RADIX 16u
#define GCDT_MINIMA_LAYERS 8

typedef struct MinimaLayers {
  u32 count;                       // layers, the distances themselves included
  u32 begin[GCDT_MINIMA_LAYERS];   // where layer l starts in `minima`; layer 0 is the chain
  u32 length[GCDT_MINIMA_LAYERS];  // entries of layer l
} MinimaLayers;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(MinimaLayers) == (1 + 2 * GCDT_MINIMA_LAYERS) * sizeof(u32), "MinimaLayers has no padding");
static_assert(sizeof(Counters) == 40 * sizeof(u32), "Counters has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif
