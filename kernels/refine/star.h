// SPDX-License-Identifier: Apache-2.0
// The star of a new vertex, made Delaunay by the work-item that has inserted it. OpenCL C only.
//
// A winner has the faces of its cavity to itself (L1), and its vertex changes no others but for ties on a circle (R2).
// So Lawson's flips there need no rounds: the work-item goes round its vertex, and flips each side across from it that
// is illegal. What is left for the rounds of flips is the sides beyond which another winner has changed the face, or
// has the vertex on its circle.
#ifndef GCDT_STAR_H
#define GCDT_STAR_H

#include "common/prefetch.h"
#include "flip/flip.h"
#include "refine/candidates.h"

// Flips of one work-item at most; sides that are left go to the rounds of flips. A cavity of hundreds of faces would
// make a GPU wait for one work-item (bench/NOTES.md).
#ifndef GCDT_STAR_FLIPS
#ifdef GCDT_GPU
#define GCDT_STAR_FLIPS 32u
#else
#define GCDT_STAR_FLIPS 1024u
#endif
#endif

typedef struct Insertion {
  Mesh mesh;
  volatile global uint* marks;
  global uint* edge_pieces;
  global uint* queue;  // of edges to be tested: flip.cl
  volatile global Counters* counters;
  uint old_faces;              // faces from here on are new in this launch
  Claim round;                 // what claims of this round begin with
  global const uint* numbers;  // of candidates in order
  global const uint* before;   // the scan of winners by number
  global const uint* ranks;    // by number
  global const uint4* candidates;
  global int2* points;
  uint inputs;  // the first vertex with a word in `origins`
  global uint4* origins;
  uint sized;
  global uint* sizes;
  volatile global RefineReport* report;
} Insertion;

// The edge, which is no constraint, may be illegal from now on. One between two winners is queued once: the mark
// decides.
static inline void queue_side(Insertion in, uint code) {
  const uint e = GCDT_SIDE_EDGE(code);
  if (!(atomic_or(in.marks + e, GCDT_MARK_QUEUED) & GCDT_MARK_QUEUED))
    in.queue[atomic_inc(&in.counters->list_test[0])] = e;
}

// Whose face it is, by its number and its claim word. In this launch nobody writes the claim word of a face that was
// there before it but its winner, who leaves it as it is; and a side leads to an old or a new face of one winner,
// whichever it is.
#define OF_NOBODY 0u  // not changed in this launch
#define OF_ANOTHER 1u
#define OF_OWN 2u
static inline uint owner_of(Insertion in, uint face, uint word, uint claim) {
  if (face >= in.old_faces) return OF_ANOTHER;
  if (word == claim) return OF_OWN;
  if (!claimed_now(word, in.round)) return OF_NOBODY;
  const uint number = in.numbers[word & ((1u << in.round.bits) - 1u)];
  return in.before[number + 1u] > in.before[number] ? OF_ANOTHER : OF_NOBODY;
}

// Makes the sides around v legal, or queues them. Returns the number of flips. A flip leaves the face with v where it
// is, with its side after the other's: a tour counter-clockwise over the spokes, which are not flipped, meets each side
// once. A face of its own that is not in the star yet has x strictly inside its circle, if it is of a cavity: all that
// a vertex in a face or on an edge claims is. For a subsegment more is claimed, and faces beside the cavities may have
// x inside their circles, or on them. Ends: a flip takes one of the faces claimed into the star, and the tour is back
// at the first spoke after the others; `steps` stops a mesh that is wrong.
//
// A step is a chain of loads, and the longest tour is what others wait for. So the face's corners c and sides s are
// kept, and what can be loaded at once is.
static uint settle_star(Insertion in, uint v, Vertex x, uint claim, bool of_subsegment, bool tied) {
  const Mesh mesh = in.mesh;
  uint face = new_face(mesh, v, 0u), k = 0u, flips = 0u, around[4];
  uint4 c = mesh.face_data[GCDT_CORNERS(face)], s = mesh.face_data[GCDT_SIDES(face)];
  const uint first = GCDT_SIDE_EDGE(element(s, previous_corner(k)));
  for (uint steps = 2u * gcdt_forest_faces(mesh.n, 1u); steps > 0u; --steps) {
    const uint code = element(s, k), over = element(s, next_corner(k));
    const uint far = mesh.edge_faces[code ^ 1u], next = mesh.edge_faces[over ^ 1u];
    GCDT_PREFETCH(mesh.face_data + GCDT_CORNERS(GCDT_REF_FACE(next)));
    if (far != GCDT_NONE && !is_constrained(in.marks, code)) {
      const uint4 opposite = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(far))];
      const uint owner = owner_of(in, GCDT_REF_FACE(far), opposite.w, claim);
      const uint apex = element(opposite, GCDT_REF_CORNER(far));
      const bool owns = owner == OF_OWN && flips < GCDT_STAR_FLIPS;
      bool illegal = owns || owner != OF_NOBODY;
      if ((owns && of_subsegment) || (owner == OF_NOBODY && (of_subsegment || tied)))
        illegal = gcdt_must_flip(corner_vertex(mesh, c, previous_corner(k)), x, corner_vertex(mesh, c, next_corner(k)),
                                 load_vertex(mesh.points, mesh.n, apex));
      if (owns && illegal) {
        flip_side(mesh, code, (uint2)(GCDT_FACE_REF(face, k), far), c, opposite, around);
        c = with_element(c, previous_corner(k), apex);
        s = with_element(with_element(s, k, around[0]), next_corner(k), code);
        GCDT_PREFETCH(mesh.edge_faces + (around[1] ^ 1u));
        ++flips;
        continue;
      }
      if (illegal) queue_side(in, code);
    }
    if (GCDT_SIDE_EDGE(over) == first) return flips;
    face = GCDT_REF_FACE(next);
    k = next_corner(GCDT_REF_CORNER(next));
    c = mesh.face_data[GCDT_CORNERS(face)];
    s = mesh.face_data[GCDT_SIDES(face)];
  }
  atomic_or(&in.counters->failed, 1u);
  return flips;
}

#endif
