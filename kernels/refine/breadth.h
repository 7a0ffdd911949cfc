// SPDX-License-Identifier: Apache-2.0
// Tours of cavities by a work-item that is a thread. OpenCL C only.
//
// A thread has memory of its own that is as near as registers, so its tour keeps what is beyond the sides that are
// still to be looked over in a queue, and the faces that it has entered in a list. Each face beyond a side is read
// once, where `Tour` (cavity.h), which needs no memory, goes back over each side. What is found is the same (R1): each
// face is entered once, whatever the order. A queue, not a stack, so that a face that is put in has time to come from
// memory before it is taken out.
#ifndef GCDT_BREADTH_H
#define GCDT_BREADTH_H

#include "common/prefetch.h"
#include "refine/aim.h"
#include "refine/claim.h"

#ifdef GCDT_CONTIGUOUS

#ifndef GCDT_TOUR_SIDES  // sides that are still to be looked over, a power of two; where there are more, `Tour` goes
#define GCDT_TOUR_SIDES 64u
#endif
#ifndef GCDT_TOUR_FACES  // faces; a cavity that has more is not listed
#define GCDT_TOUR_FACES 256u
#endif

typedef struct BreadthTour {
  ulong entered;                // faces
  uint in_way, fixed;           // subsegments that have x in their lens: that may be split, and others
  bool near, tied;              // x is too near a corner; it is on the circle of a face beside the cavity
  bool out, full;               // there are more than `most` faces; there was no room in the queue
  uint put, taken;              // sides, since the beginning
  uint queue[GCDT_TOUR_SIDES];  // faces beyond sides, with the corners across from these; side i at i modulo its size
  uint faces[GCDT_TOUR_FACES];  // the first ones that were entered
} BreadthTour;

static inline uint pending(private const BreadthTour* tour) { return tour->put - tour->taken; }

static inline bool is_listed(private const BreadthTour* tour) { return tour->entered <= GCDT_TOUR_FACES; }

// Side k of a face that was entered, with these corners: what is beyond goes into the queue. At a subsegment the
// cavity ends.
static inline void put_side(Judge judge, private const Judged* j, private BreadthTour* tour, uint4 c, uint k, uint code,
                            Vertex x) {
  const Mesh mesh = judge.mesh;
  const uint beyond = mesh.edge_faces[code ^ 1u];
  if (!is_constrained(judge.marks, code)) {
    if (beyond == GCDT_NONE) return;
    GCDT_PREFETCH(mesh.face_data + GCDT_CORNERS(GCDT_REF_FACE(beyond)));
    tour->queue[tour->put++ % GCDT_TOUR_SIDES] = beyond;
  } else if (j && gcdt_in_lens(judge.rules, corner_vertex(mesh, c, next_corner(k)),
                               corner_vertex(mesh, c, previous_corner(k)), x)) {
    if (may_split(mesh, judge.rules, code))
      ++tour->in_way;
    else
      ++tour->fixed;
  }
}

// The corner across from the side that is taken next.
static inline void prefetch_apex(Mesh mesh, private const BreadthTour* tour) {
#ifdef GCDT_PREFETCHES
  if (pending(tour) == 0u) return;
  const uint ref = tour->queue[tour->taken % GCDT_TOUR_SIDES];
  GCDT_PREFETCH(mesh.points + face_corner(mesh, GCDT_REF_FACE(ref), GCDT_REF_CORNER(ref)));
#else
  (void)mesh;
  (void)tour;
#endif
}

// The tour of the cavity of x from `root`, a face of it, which may have `most` faces. `j`: whose target x is; 0: only
// faces are wanted. Ends: each step takes a side from the queue, and a face that is entered, which is so once (R1),
// puts two there. A mesh that is wrong is stopped by the number of all faces, as a queue that is full: the tour without
// memory, which is made then, finds it out.
static void tour_by_breadth(Judge judge, private const Judged* j, uint root, Vertex x, ulong most,
                            private BreadthTour* tour) {
  const Mesh mesh = judge.mesh;
  const ulong all_faces = gcdt_forest_faces(mesh.n, 1u);
  const uint4 c = mesh.face_data[GCDT_CORNERS(root)], s = mesh.face_data[GCDT_SIDES(root)];
  tour->entered = 1u;
  tour->faces[0] = root;
  tour->in_way = tour->fixed = tour->put = tour->taken = 0u;
  tour->near = tour->tied = tour->out = tour->full = false;
  for (uint k = 0; k < 3u; ++k) {
    if (j && is_too_near(*j, corner_vertex(mesh, c, k), x)) tour->near = true;
    put_side(judge, j, tour, c, k, element(s, k), x);
  }
  while (pending(tour) > 0u) {
    const uint ref = tour->queue[tour->taken++ % GCDT_TOUR_SIDES], face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
    const uint4 corners = mesh.face_data[GCDT_CORNERS(face)], sides = mesh.face_data[GCDT_SIDES(face)];
    const Vertex p = corner_vertex(mesh, corners, next_corner(k)), q = corner_vertex(mesh, corners, previous_corner(k)),
                 r = corner_vertex(mesh, corners, k);
    prefetch_apex(mesh, tour);
    const int side = gcdt_incircle(p, q, r, x);
    tour->tied |= side == 0;
    if (side <= 0) continue;
    if (j && is_too_near(*j, r, x)) tour->near = true;
    if (tour->entered < GCDT_TOUR_FACES) tour->faces[tour->entered] = face;
    tour->out = ++tour->entered > most;
    tour->full = pending(tour) + 2u > GCDT_TOUR_SIDES || tour->entered > all_faces;
    if (tour->out || tour->full) return;
    put_side(judge, j, tour, corners, previous_corner(k), element(sides, previous_corner(k)), x);
    put_side(judge, j, tour, corners, next_corner(k), element(sides, next_corner(k)), x);
  }
}

// Puts the faces of a tour into blocks (candidates.h), as those of `owner`. Returns GCDT_LISTED if there was room for
// all, else 0. No race: an atomic gives each block once.
static uint list_faces(private const BreadthTour* tour, uint owner, global uint* words, uint blocks,
                       volatile global RefineReport* report) {
  if (!is_listed(tour)) return 0u;
  const uint count = (uint)tour->entered, taken = (count + GCDT_BLOCK - 2u) / (GCDT_BLOCK - 1u),
             first = atomic_add(&report->blocks, taken), end = min(first + taken, blocks);
  uint i = 0u;
  for (uint b = first; b < end; ++b) {
    for (uint k = 0; k + 1u < GCDT_BLOCK; ++k, ++i) words[GCDT_BLOCK * b + k] = i < count ? tour->faces[i] : GCDT_NONE;
    words[GCDT_BLOCK * b + GCDT_BLOCK - 1u] = owner;
  }
  return i >= count ? GCDT_LISTED : 0u;
}

#endif

#endif
