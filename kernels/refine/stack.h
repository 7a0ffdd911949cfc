// SPDX-License-Identifier: Apache-2.0
// Tours of cavities by a work-item that is a thread. OpenCL C only.
//
// A thread has memory of its own that is as near as registers, so its tour keeps the sides that are still to be looked
// over on a stack, and the faces that it has entered in a list. It goes over no side twice, and has the places of three
// corners at hand where it enters a face, of which only one is new. `Tour` (cavity.h) needs no memory, and goes back
// over each side. What is found is the same (R1): each face is reached once, whatever the order.
#ifndef GCDT_STACK_H
#define GCDT_STACK_H

#include "refine/aim.h"
#include "refine/claim.h"

#ifdef GCDT_CONTIGUOUS

#ifndef GCDT_STACK_SIDES  // sides; where there are more, a tour without memory is made
#define GCDT_STACK_SIDES 64u
#endif
#ifndef GCDT_STACK_FACES  // faces; a cavity that has more is not listed
#define GCDT_STACK_FACES 256u
#endif

typedef struct StackTour {
  ulong entered;        // faces
  uint in_way, fixed;   // subsegments that have x in their lens: that may be split, and others
  bool near, tied;      // x is too near a corner; it is on the circle of a face beside the cavity
  bool out, full;       // there are more than `most` faces; there was no room on the stack
  uint pending;
  uint sides[GCDT_STACK_SIDES];  // the stack: pending ones
  uint faces[GCDT_STACK_FACES];  // the first ones that were entered
} StackTour;

// A side of a face of the cavity: p is before q, counter-clockwise.
typedef struct Front {
  Vertex p, q;
  uint code;
} Front;

static inline Front front_of(Mesh mesh, uint ref) {
  const uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
  const Front f = {.p = corner_vertex(mesh, c, next_corner(k)),
                   .q = corner_vertex(mesh, c, previous_corner(k)),
                   .code = face_side(mesh, face, k)};
  return f;
}

static inline bool is_listed(private const StackTour* tour) { return tour->entered <= GCDT_STACK_FACES; }

static inline void enter_face(private StackTour* tour, uint face) {
  if (tour->entered < GCDT_STACK_FACES) tour->faces[tour->entered] = face;
  ++tour->entered;
}

// At a subsegment of the cavity's border.
static inline void meet_on_tour(Judge judge, private StackTour* tour, Front f, Vertex x) {
  if (!gcdt_in_lens(judge.rules, f.p, f.q, x)) return;
  if (may_split(judge.mesh, judge.rules, f.code))
    ++tour->in_way;
  else
    ++tour->fixed;
}

// Looks over a side. If the cavity goes on there, enters the face beyond: of its other two sides one is put on the
// stack, and the front is the other. It has corners (r, q, p), so they are rq, across from p, and pr, across from q.
static inline bool look_beyond(Judge judge, private const Judged* j, private StackTour* tour, private Front* f,
                               Vertex x) {
  const Mesh mesh = judge.mesh;
  if (is_constrained(judge.marks, f->code)) {
    if (j) meet_on_tour(judge, tour, *f, x);
    return false;
  }
  const uint ref = mesh.edge_faces[f->code ^ 1u], face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  if (ref == GCDT_NONE) return false;
  const Vertex r = corner_vertex(mesh, mesh.face_data[GCDT_CORNERS(face)], k);
  const int side = gcdt_incircle(r, f->q, f->p, x);
  tour->tied |= side == 0;
  if (side <= 0) return false;
  enter_face(tour, face);
  if (j && is_too_near(*j, r, x)) tour->near = true;
  tour->full = tour->pending == GCDT_STACK_SIDES;
  if (tour->full) return false;
  tour->sides[tour->pending++] = GCDT_FACE_REF(face, previous_corner(k));
  f->q = r;
  f->code = face_side(mesh, face, next_corner(k));
  return true;
}

// The tour of the cavity of x from `root`, a face of it, which may have `most` faces. `j`: whose target x is; 0: only
// faces are wanted. Ends: each step looks over one of the three sides of the root, or of the two of a face that was
// entered, which is so once (R1). A mesh that is wrong is stopped by the number of all faces, as a stack that is full:
// the tour without memory, which is made then, finds it out.
static void tour_by_stack(Judge judge, private const Judged* j, uint root, Vertex x, ulong most,
                          private StackTour* tour) {
  const ulong all_faces = gcdt_forest_faces(judge.mesh.n, 1u);
  tour->entered = 0u;
  tour->in_way = tour->fixed = tour->pending = 0u;
  tour->near = tour->tied = tour->out = tour->full = false;
  enter_face(tour, root);
  for (uint k = 0; k < 3u; ++k) {
    tour->sides[tour->pending++] = GCDT_FACE_REF(root, k);
    if (j && is_too_near(*j, corner_vertex(judge.mesh, judge.mesh.face_data[GCDT_CORNERS(root)], k), x))
      tour->near = true;
  }
  while (tour->pending > 0u && !tour->full && !tour->out) {
    Front f = front_of(judge.mesh, tour->sides[--tour->pending]);
    while (look_beyond(judge, j, tour, &f, x) && !tour->out) {
      tour->out = tour->entered > most;
      if (tour->entered > all_faces) {
        tour->full = true;
        return;
      }
    }
  }
}

// Puts the faces of a tour into blocks (candidates.h), as those of `owner`. Returns GCDT_LISTED if there was room for
// all, else 0. No race: an atomic gives each block once.
static uint list_faces(private const StackTour* tour, uint owner, global uint* words, uint blocks,
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
