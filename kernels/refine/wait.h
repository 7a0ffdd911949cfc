// SPDX-License-Identifier: Apache-2.0
// Which bad triangles wait for worse ones near them (docs/refinement.md). OpenCL C only.
//
// Bad triangles stand in clusters, and what mends the worst one mends most of the others, or changes what they aim at.
// So a sharp face waits as long as one within three steps over unconstrained sides goes before it: the one with the
// shorter side, by powers of two of its square, then the sharper one. Equal ones do not wait for each other, nor do
// faces that are only too large, which mend nothing but themselves. A face whose aim was in vain stays in no one's way
// until its triangle changes, so a round without candidates leaves fewer that do, or has none that waits.
//
// Of a sharp face the upper half of its word of `urgency` is its place in that order, above 0; the lower half is that,
// too, unless it has aimed in vain. All other words are 0.
#ifndef GCDT_WAIT_H
#define GCDT_WAIT_H

#include "refine/cavity.h"

#define URGENCY_BITS 16u

static inline uint urgency_of(Shape s) { return gcdt_precedence(s.shortest, gcdt_badness(s)); }

static inline uint in_the_way(uint word) { return word & ((1u << URGENCY_BITS) - 1u); }

// The face beyond an unconstrained side; GCDT_NONE beyond others.
static inline uint ref_beyond(Mesh mesh, volatile global const uint* marks, uint code) {
  return is_constrained(marks, code) ? GCDT_NONE : mesh.edge_faces[code ^ 1u];
}

static inline uint other_side(Mesh mesh, uint ref, uint number) {
  const uint k = GCDT_REF_CORNER(ref);
  return element(mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(ref))], number == 0u ? next_corner(k) : previous_corner(k));
}

// Is there a face that goes before it two or three steps over the side?
static bool is_worse_beyond(Mesh mesh, volatile global const uint* marks, uint code, uint own,
                            global const uint* urgency) {
  const uint one = ref_beyond(mesh, marks, code);
  if (one == GCDT_NONE) return false;
  for (uint a = 0; a < 2u; ++a) {
    const uint two = ref_beyond(mesh, marks, other_side(mesh, one, a));
    if (two == GCDT_NONE) continue;
    if (in_the_way(urgency[GCDT_REF_FACE(two)]) > own) return true;
    for (uint b = 0; b < 2u; ++b) {
      const uint three = ref_beyond(mesh, marks, other_side(mesh, two, b));
      if (three != GCDT_NONE && in_the_way(urgency[GCDT_REF_FACE(three)]) > own) return true;
    }
  }
  return false;
}

// Must the face wait? Looks at 21 others at most, and first at its neighbours, where what is worse mostly is.
static bool must_wait(Mesh mesh, volatile global const uint* marks, uint face, global const uint* urgency) {
  const uint own = urgency[face] >> URGENCY_BITS;
  if (own == 0u) return false;
  const uint4 s = mesh.face_data[GCDT_SIDES(face)];
  for (uint k = 0; k < 3u; ++k) {
    const uint one = ref_beyond(mesh, marks, element(s, k));
    if (one != GCDT_NONE && in_the_way(urgency[GCDT_REF_FACE(one)]) > own) return true;
  }
  return is_worse_beyond(mesh, marks, s.x, own, urgency) || is_worse_beyond(mesh, marks, s.y, own, urgency) ||
         is_worse_beyond(mesh, marks, s.z, own, urgency);
}

#endif
