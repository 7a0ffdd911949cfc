// SPDX-License-Identifier: Apache-2.0
// Flips that follow one another along a fan, by one work-item in one round. Where a vertex v comes into the triangles
// around another one, w, each flip gives v one neighbour of w's, and the next edge to be flipped leads from w to that
// neighbour: a chain, one flip a round. Where a round has little else to do, one work-item follows it, a flip in the
// time of a round: barriers then do not grow with fans. Where it has more, work-items wait for the longest slide
// (bench/NOTES.md, "Slides"). OpenCL C only.
#ifndef GCDT_SLIDE_H
#define GCDT_SLIDE_H

#include "flip/flip.h"
#include "flip/queue.h"

// Flips of a slide at most, which bounds the launch.
#define GCDT_SLIDE_FLIPS 32u
// Edges of a round that slides at most, a few flips' worth.
#ifndef GCDT_SLIDE_TESTS
#define GCDT_SLIDE_TESTS 8u
#endif

// An edge that a work-item keeps from its test to its flip.
typedef struct Kept {
  uint e;                              // GCDT_NONE: nothing is to be flipped
  uint2 refs;                          // of its faces
  uint4 corners_t, corners_u, st, su;  // their corners and sides
} Kept;

// What is known of an edge that has two faces. What may be wanted is read at once: few edges wait for memory, and for
// nothing else.
static inline Kept keep_edge(Mesh mesh, uint e, uint2 refs) {
  const uint t = GCDT_REF_FACE(refs.x), u = GCDT_REF_FACE(refs.y);
  Kept k;
  k.e = e;
  k.refs = refs;
  k.corners_t = mesh.face_data[GCDT_CORNERS(t)];
  k.corners_u = mesh.face_data[GCDT_CORNERS(u)];
#ifdef GCDT_CONTIGUOUS
  k.st = k.su = (uint4)(0u);
#else
  k.st = mesh.face_data[GCDT_SIDES(t)];
  k.su = mesh.face_data[GCDT_SIDES(u)];
#endif
  return k;
}

#if GCDT_FLIP_CHAIN == 1

// What became of an edge that a slide came to.
typedef enum Met { MET_LEGAL, MET_ILLEGAL, MET_UNKNOWN } Met;

// Tests the edge of side `code`, which has these references and marks, and whose near face is owned and has these
// corners. Illegal: its far face is owned now, too, and `k` has it. Unknown: it may be illegal, now or later, and is to
// be queued (flip.cl). Else it is constrained, or legal as long as its faces, both owned here, are not changed.
// No race: what is read of a far face, and of who is behind an edge, is right if the face can be taken, since whoever
// changes a face in this round has taken it before; else it is not acted on (flip_propagate).
static Met meet_edge(Mesh mesh, Claim c, uint ticket, uint code, uint marks, uint2 refs, uint4 corners,
                     private Kept* k) {
  if ((marks & GCDT_MARK_CONSTRAINED) || refs.y == GCDT_NONE) return MET_LEGAL;
  Kept met = keep_edge(mesh, GCDT_SIDE_EDGE(code), refs);
  met.corners_t = corners;
  const bool owned = met.corners_u.w == ticket,
             illegal = is_illegal_between(mesh, refs.x, refs.y, corners, met.corners_u);
  if (owned && !illegal) return MET_LEGAL;
  if (!illegal || (!owned && !try_lock(mesh, GCDT_REF_FACE(refs.y), ticket, c))) return MET_UNKNOWN;
  met.corners_u.w = ticket;
  *k = met;
  return MET_ILLEGAL;
}

// The references of both sides of an edge by the code of its near one, and its marks.
static inline uint2 faces_from(Mesh mesh, uint code) {
  return (uint2)(mesh.edge_faces[code], mesh.edge_faces[code ^ 1u]);
}
static inline uint marks_of(Queue queue, uint code) { return queue.marks[GCDT_SIDE_EDGE(code)]; }

// Flips k.e, whose faces it owns under `ticket`, then again and again the edge across from v, the newer of the two
// vertices that the first flip made neighbours: first the one that ends where the last one did, at w. Each flip's other
// three edges are queued, or tested, as a flip's edges always are. Ends: each pass flips once, GCDT_SLIDE_FLIPS times
// at most. Returns the number of flips.
static uint slide(Mesh mesh, Claim c, uint ticket, Kept k, Queue queue) {
  uint v = GCDT_NONE, w = GCDT_NONE;
  for (uint flips = 1;; ++flips) {
    const uint b = GCDT_REF_CORNER(k.refs.x), d = GCDT_REF_CORNER(k.refs.y);
    const uint4 t = rotate_to(k.corners_t, b), u = rotate_to(k.corners_u, d);  // (b, x, y) and (d, y, x)
    uint around[4];
    flip_edge_with(mesh, k.e, k.refs, k.corners_t, k.corners_u, k.st, k.su, around);
    if (flips == GCDT_SLIDE_FLIPS) {
      queue_around(queue, around);
      return flips;
    }
    if (v == GCDT_NONE) v = t.x < mesh.n && (u.x >= mesh.n || t.x > u.x) ? t.x : u.x;
    // Now t = (b, x, d) and u = (d, y, b). Across from v are an edge of x, in t, and one of y, in u; the others lead to
    // v.
    const bool at_b = t.x == v, y_first = t.z == w;
    const uint of_x = at_b ? around[0] : around[1], of_y = at_b ? around[3] : around[2];
    const uint spoke = GCDT_SIDE_EDGE(at_b ? around[1] : around[0]),
               other_spoke = GCDT_SIDE_EDGE(at_b ? around[2] : around[3]);
    const uint first = y_first ? of_y : of_x, second = y_first ? of_x : of_y;
    const uint4 now_t = with_element(k.corners_t, previous_corner(b), u.x),
                now_u = with_element(k.corners_u, previous_corner(d), t.x);
    // All that is known to be wanted is asked for before the first answer is waited for.
    const uint2 first_refs = faces_from(mesh, first), second_refs = faces_from(mesh, second);
    const uint first_marks = marks_of(queue, first), second_marks = marks_of(queue, second);
    const uint old = atomic_or(queue.marks + spoke, GCDT_MARK_QUEUED),
               other_old = atomic_or(queue.marks + other_spoke, GCDT_MARK_QUEUED);
    const Met met = meet_edge(mesh, c, ticket, first, first_marks, first_refs, y_first ? now_u : now_t, &k);
    Met next = MET_UNKNOWN;
    if (met != MET_ILLEGAL)
      next = meet_edge(mesh, c, ticket, second, second_marks, second_refs, y_first ? now_t : now_u, &k);
    w = (met == MET_ILLEGAL) == y_first ? t.z : t.y;
    if (!(old & GCDT_MARK_QUEUED)) append(queue.list, spoke);
    if (!(other_old & GCDT_MARK_QUEUED)) append(queue.list, other_spoke);
    if (met == MET_UNKNOWN) queue_edge(queue, GCDT_SIDE_EDGE(first));
    if (next == MET_UNKNOWN) queue_edge(queue, GCDT_SIDE_EDGE(second));
    if (met != MET_ILLEGAL && next != MET_ILLEGAL) return flips;
  }
}

#endif

#endif
