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

// Where flips propagate, chains need no slides; where records are not read whole, sides are not kept.
#if GCDT_FLIP_CHAIN == 1 && !defined(GCDT_CONTIGUOUS)
#define GCDT_SLIDES
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

#ifdef GCDT_SLIDES

// What became of an edge that a slide came to.
typedef enum Met { MET_LEGAL, MET_ILLEGAL, MET_UNKNOWN } Met;

// A side, the reference of the face behind it, and its edge's marks.
typedef struct Side {
  uint code, behind, marks;
} Side;

static inline Side look_behind(Mesh mesh, Queue queue, uint code) {
  Side s;
  s.code = code;
  s.behind = mesh.edge_faces[code ^ 1u];
  s.marks = queue.marks[GCDT_SIDE_EDGE(code)];
  return s;
}

typedef struct Corner {
  uint number;
  Vertex at;
} Corner;

static inline Corner load_corner(Mesh mesh, uint number) {
  const Corner corner = {.number = number, .at = load_vertex(mesh.points, mesh.n, number)};
  return corner;
}

// A face (p, y, x) behind the edge x-y: its reference there, and its sides across from y and from x.
typedef struct Beyond {
  uint ref;
  Corner p;
  Side of_y, of_x;
} Beyond;

// Tests the edge of side s, whose near face (v, x, y) is owned. Illegal: the face behind it is owned now, too, and
// `met` has it. Unknown: it may be illegal, now or later, and is to be queued (flip.cl). Else it is constrained, or
// legal as long as its faces, both owned here, are not changed.
// The face is locked before it is known whether that is needed, as all that may be wanted is asked for before the
// first answer is waited for. No race: what is read of it, and of who is behind its sides, is right if it can be taken,
// since whoever changes a face in this round has taken it before; else it is not acted on (flip_propagate).
static Met meet_edge(Mesh mesh, Claim c, uint ticket, Queue queue, Side s, Corner v, Corner x, Corner y,
                     private Beyond* met) {
  if ((s.marks & GCDT_MARK_CONSTRAINED) || s.behind == GCDT_NONE) return MET_LEGAL;
  const uint face = GCDT_REF_FACE(s.behind), d = GCDT_REF_CORNER(s.behind);
  const uint4 corners = rotate_to(mesh.face_data[GCDT_CORNERS(face)], d),
              sides = rotate_to(mesh.face_data[GCDT_SIDES(face)], d);
  met->ref = s.behind;
  met->p = load_corner(mesh, corners.x);
  met->of_y = look_behind(mesh, queue, sides.y);
  met->of_x = look_behind(mesh, queue, sides.z);
  if (!own_face(mesh, face, corners.w, ticket, c)) return MET_UNKNOWN;
  return gcdt_must_flip(y.at, v.at, x.at, met->p.at) ? MET_ILLEGAL : MET_LEGAL;
}

// Flips k.e, whose faces it owns under `ticket`, then again and again the edge across from v, the newer of the two
// vertices that the first flip made neighbours: first the one that ends where the last one did, at w. Each flip's other
// three edges are queued, or tested, as a flip's edges always are. Ends: each pass flips once, GCDT_SLIDE_FLIPS times
// at most. Returns the number of flips.
static uint slide(Mesh mesh, Claim c, uint ticket, Kept k, Queue queue) {
  const uint b_of_t = GCDT_REF_CORNER(k.refs.x), b_of_u = GCDT_REF_CORNER(k.refs.y);
  const uint4 t = rotate_to(k.corners_t, b_of_t), u = rotate_to(k.corners_u, b_of_u);
  const bool in_t = t.x < mesh.n && (u.x >= mesh.n || t.x > u.x);
  const uint4 near = in_t ? t : u, side_near = in_t ? rotate_to(k.st, b_of_t) : rotate_to(k.su, b_of_u),
              side_far = in_t ? rotate_to(k.su, b_of_u) : rotate_to(k.st, b_of_t);
  // The edge to be flipped is x-y, between the face a = (v, x, y) and the one beyond.
  uint ref_a = in_t ? k.refs.x : k.refs.y, code = side_near.x, of_x = side_near.y, of_y = side_near.z;
  const Corner v = load_corner(mesh, near.x);
  Corner x = load_corner(mesh, near.y), y = load_corner(mesh, near.z);
  Beyond beyond;
  beyond.ref = in_t ? k.refs.y : k.refs.x;
  beyond.p = load_corner(mesh, in_t ? u.x : t.x);
  beyond.of_y = look_behind(mesh, queue, side_far.y);
  beyond.of_x = look_behind(mesh, queue, side_far.z);
  uint spoke = GCDT_SIDE_EDGE(of_x);
  bool around_x = true;  // it turns around x, if it goes on as it did
  queue_edge(queue, GCDT_SIDE_EDGE(of_y));
  for (uint flips = 1;; ++flips) {
    // a becomes (v, x, p), and the face beyond, f = (p, y, x), becomes (p, y, v), as in flip_edge_with.
    const uint a = GCDT_REF_FACE(ref_a), b = GCDT_REF_CORNER(ref_a), f = GCDT_REF_FACE(beyond.ref),
               d = GCDT_REF_CORNER(beyond.ref);
    global uint* at = (global uint*)(mesh.face_data + GCDT_CORNERS(a));
    global uint* af = (global uint*)(mesh.face_data + GCDT_CORNERS(f));
    const uint old = atomic_or(queue.marks + spoke, GCDT_MARK_QUEUED);
    at[previous_corner(b)] = beyond.p.number;
    af[previous_corner(d)] = v.number;
    set_side(mesh.face_data, a, b, beyond.of_y.code);
    set_side(mesh.face_data, a, next_corner(b), code);
    set_side(mesh.face_data, f, d, of_x);
    set_side(mesh.face_data, f, next_corner(d), code ^ 1u);
    mesh.edge_faces[code] = GCDT_FACE_REF(a, next_corner(b));
    mesh.edge_faces[code ^ 1u] = GCDT_FACE_REF(f, next_corner(d));
    mesh.edge_faces[beyond.of_y.code] = ref_a;
    mesh.edge_faces[of_x] = beyond.ref;
    // Across from v are x-p, in a, and p-y, in f.
    const Side of_a = beyond.of_y, of_f = beyond.of_x;
    const Corner p = beyond.p;
    Met met_a = MET_UNKNOWN, met_f = MET_UNKNOWN;
    if (flips < GCDT_SLIDE_FLIPS) {
      if (around_x) met_a = meet_edge(mesh, c, ticket, queue, of_a, v, x, p, &beyond);
      if (met_a != MET_ILLEGAL) met_f = meet_edge(mesh, c, ticket, queue, of_f, v, p, y, &beyond);
      if (!around_x && met_f != MET_ILLEGAL) met_a = meet_edge(mesh, c, ticket, queue, of_a, v, x, p, &beyond);
    }
    if (!(old & GCDT_MARK_QUEUED)) append(queue.list, spoke);
    if (met_a == MET_UNKNOWN) queue_edge(queue, GCDT_SIDE_EDGE(of_a.code));
    if (met_f == MET_UNKNOWN) queue_edge(queue, GCDT_SIDE_EDGE(of_f.code));
    if (met_a != MET_ILLEGAL && met_f != MET_ILLEGAL) return flips;
    // What was flipped is one of the next flip's edges, and the one from v to the vertex that it turns around is
    // queued.
    spoke = GCDT_SIDE_EDGE(code);
    around_x = met_a == MET_ILLEGAL;
    if (around_x) {
      of_x = code;
      code = of_a.code;
      y = p;
    } else {
      ref_a = GCDT_FACE_REF(f, previous_corner(d));
      of_y = code ^ 1u;
      code = of_f.code;
      x = p;
    }
  }
}

#endif

#endif
