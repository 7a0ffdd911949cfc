// SPDX-License-Identifier: Apache-2.0
// Candidates: the vertices that a round may insert. OpenCL C only.
#ifndef GCDT_CANDIDATES_H
#define GCDT_CANDIDATES_H

#include "refine/cavity.h"

// What a candidate lies in: (x, y, what, kind).
#define GCDT_IN_FACE 0u        // what: the face
#define GCDT_ON_EDGE 1u        // what: a side code of an unconstrained edge
#define GCDT_ON_SUBSEGMENT 2u  // what: the edge
#define GCDT_FAR 4u            // added to the last: rounded the other way
#define GCDT_LISTED 8u         // added: the faces that it claims stand in blocks
#define GCDT_TIED 16u          // added to the first two: x may be on the circle of a face beside the cavity

static inline uint kind_of_candidate(uint4 candidate) { return candidate.w & 7u; }
static inline Vertex candidate_point(uint4 candidate) { return gcdt_finite_vertex(candidate.x, candidate.y); }

// ---- Lists of cavities ------------------------------------------------------------------------------------
// The faces of cavities in blocks of eight words: seven faces, less in the last one, which has GCDT_NONE behind them,
// and whose they are: who aims, by its place in the list `aiming`, or the candidate of a subsegment. Who claims them
// has a work-item for each block, so that a large cavity takes no longer than a small one. What is not listed, because
// blocks have run out or it is a subsegment's on a CPU, is gone through again.
#define GCDT_OF_SUBSEGMENT 0x80000000u  // added to the number of the candidate

typedef struct CavityList {
  global uint* words;
  uint blocks;  // that there is room for
  uint owner, block, used;
} CavityList;

static inline CavityList begin_list(global uint* words, uint blocks, uint owner) {
  CavityList list;
  list.words = words;
  list.blocks = blocks;
  list.owner = owner;
  list.block = 0u;
  list.used = GCDT_BLOCK - 1u;
  return list;
}

// Writes words that no other work-item has: an atomic gives each block once.
static inline void add_to_list(CavityList* list, uint face, volatile global RefineReport* report) {
  if (list->used == GCDT_BLOCK - 1u) {
    list->block = atomic_inc(&report->blocks);
    list->used = 0u;
    if (list->block < list->blocks) list->words[GCDT_BLOCK * list->block + GCDT_BLOCK - 1u] = list->owner;
  }
  if (list->block < list->blocks) list->words[GCDT_BLOCK * list->block + list->used] = face;
  ++list->used;
}

// Returns GCDT_LISTED if there was room for all, else 0. (Numbers of blocks ascend, so the last one tells.)
static inline uint end_list(CavityList* list) {
  if (list->block >= list->blocks) return 0u;
  if (list->used < GCDT_BLOCK - 1u) list->words[GCDT_BLOCK * list->block + list->used] = GCDT_NONE;
  return GCDT_LISTED;
}

// The faces' labels: 0 where the domain is not kept, else 1 + a triangle of the same region. Flips stay in a region.
static inline uint label_of(Mesh mesh, uint face) { return mesh.face_data[GCDT_SIDES(face)].w; }

// What the vertices from `inputs` on were put on: three corners or, with GCDT_NONE for the third, two ends; the piece.
typedef struct Origins {
  uint inputs;
  global const uint4* of;
} Origins;

static inline uint piece_under(Origins origins, uint v) {
  return v < origins.inputs ? GCDT_NONE : origins.of[v - origins.inputs].w;
}

static inline bool may_split(Mesh mesh, RefineRules rules, uint code) {
  if (rules.splits == GCDT_SPLIT_ALL) return true;
  if (rules.splits == GCDT_SPLIT_NONE) return false;
  return label_of(mesh, GCDT_REF_FACE(mesh.edge_faces[code])) != 0u &&
         label_of(mesh, GCDT_REF_FACE(mesh.edge_faces[code ^ 1u])) != 0u;
}

typedef struct Lists {
  volatile global uint* marks;
  global uint* asked;  // as long as there are subsegments
  global ulong* keys;  // as the next two as long as `capacity`
  global uint* numbers;
  global uint4* candidates;
  uint capacity;
  volatile global RefineReport* report;
} Lists;

// Zeroes what a round counts.
static inline void begin_search(volatile global RefineReport* report) {
  report->bad = report->aiming = report->sitting_out = report->asked = 0u;
  report->candidates = report->blocks = report->refused = 0u;
}

// Puts the subsegment into the list, once: the mark decides by atomic_or. (Of few compared with faces.)
static inline void ask(Lists lists, uint edge) {
  if (lists.marks[edge] & GCDT_MARK_ASKED) return;
  if (atomic_or(lists.marks + edge, GCDT_MARK_ASKED) & GCDT_MARK_ASKED) return;
  lists.asked[atomic_inc(&lists.report->asked)] = edge;
}

// Any order: candidates are sorted. Those that do not fit are counted, and the host comes again with more room. Returns
// its number.
static inline uint add_candidate(Lists lists, u64 key, Vertex at, uint what, uint kind) {
  const uint slot = atomic_inc(&lists.report->candidates);
  if (slot >= lists.capacity) return slot;
  lists.keys[slot] = key;
  lists.numbers[slot] = slot;
  lists.candidates[slot] = (uint4)((uint)at.x, (uint)at.y, what, kind);
  return slot;
}

// If x, on pq's side that the face of `ref` lies on with its corner r, is beyond qr or rp: the code of that side, which
// is not kept; else GCDT_NONE. Of kept faces the answer is not asked for: their vertices lie in them (fits_face).
static uint code_beyond(Mesh mesh, uint ref, Vertex x) {
  const uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)], s = mesh.face_data[GCDT_SIDES(face)];
  if (s.w != 0u) return GCDT_NONE;
  const Vertex p = corner_vertex(mesh, c, next_corner(k)), q = corner_vertex(mesh, c, previous_corner(k)),
               r = corner_vertex(mesh, c, k);
  if (gcdt_orient2d_finite(p, q, x) <= 0) return GCDT_NONE;
  if (gcdt_orient2d(q, r, x) < 0) return element(s, next_corner(k));
  if (gcdt_orient2d(r, p, x) < 0) return element(s, previous_corner(k));
  return GCDT_NONE;
}

// Where what a candidate needs begins: a face of a cavity, which it needs whole, or a face that it needs alone.
typedef struct Root {
  uint face;
  bool of_cavity;
} Root;

#define GCDT_ROOTS 4u

// Root i of a candidate; its face is GCDT_NONE if there is none. Of a subsegment: the faces on both sides, whose flags
// change, and behind each the face that x is in if it is not that one. A face in which x is, or on whose unconstrained
// side, is of a cavity: strictly inside a circle is all of the closed face but its corners.
static Root candidate_root(Mesh mesh, uint4 candidate, uint i) {
  Root root;
  const uint kind = kind_of_candidate(candidate);
  root.face = GCDT_NONE;
  root.of_cavity = true;
  if (kind & GCDT_ON_SUBSEGMENT) {
    const Vertex x = candidate_point(candidate);
    const uint ref = mesh.edge_faces[2u * candidate.z + i / 2u];
    if (i % 2u == 0u) {
      root.face = GCDT_REF_FACE(ref);
      root.of_cavity = side_of_circle(mesh, root.face, x) > 0;
    } else {
      const uint beyond = code_beyond(mesh, ref, x);
      if (beyond != GCDT_NONE) root.face = GCDT_REF_FACE(mesh.edge_faces[beyond ^ 1u]);
    }
  } else if (i == 0u) {
    root.face = kind == GCDT_IN_FACE ? candidate.z : GCDT_REF_FACE(mesh.edge_faces[candidate.z]);
  }
  return root;
}

// The side of the face that x lies on, as the corner across from it; 3 if x is strictly inside, GCDT_NONE if it is
// outside or a corner.
static uint side_under(Mesh mesh, uint face, Vertex x) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
  uint on = 3u;
  for (uint k = 0; k < 3u; ++k) {
    const i64 side =
        gcdt_orient2d(corner_vertex(mesh, c, next_corner(k)), corner_vertex(mesh, c, previous_corner(k)), x);
    if (side < 0 || (side == 0 && on != 3u)) return GCDT_NONE;
    if (side == 0) on = k;
  }
  return on;
}

#endif
