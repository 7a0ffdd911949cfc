// SPDX-License-Identifier: Apache-2.0
// Which bad triangles wait for worse ones near them (docs/refinement.md). OpenCL C only.
//
// Bad triangles stand in clusters, and what mends the worst one mends most of the others, or changes what they aim at.
// So a sharp face waits as long as one within three steps over unconstrained sides goes before it: the one with the
// shorter side, by powers of two of its square, then the sharper one. Of needles, which are sharper than all that the
// measure tells apart, the sharper one by powers of two, then one that a hash of its corners chooses: dense outlines
// with nothing between them are full of them, and next to none of their aims comes to anything. Other equal ones do not
// wait for each other, nor do faces that are only too large, which mend nothing but themselves. A face whose aim was in
// vain stays in no one's way until its triangle changes, so a round without candidates leaves fewer that do, or has
// none that waits.
//
// Around a dense outline most triangles are slivers whose cavities have hundreds or thousands of faces, and share them:
// one of these wins. So who may go through a large cavity is drawn by lot (Lots, below).
//
// Of a sharp face the upper 29 bits of its word of `urgency` are its place in that order, above 0, of others 0. Bit 0:
// it is in the way of others, as it has not aimed in vain. Bits 1 and 2: its handicap in the next draw.
#ifndef GCDT_WAIT_H
#define GCDT_WAIT_H

#include "refine/judge.h"

#define URGENCY_BITS 3u
#define URGENCY_IN_THE_WAY 1u
#define URGENCY_HANDICAP_BIT 1u
#define URGENCY_MOST_HANDICAP 3u

#define URGENCY_LOT_BITS 7u

// A number that is the same for the same three corners, on every device.
static inline u64 hash_of_corners(Mesh mesh, uint4 corners, u64 seed) {
  for (uint k = 0; k < 3u; ++k) seed += gcdt_mix(gcdt_tie_key(vertex_at(mesh.points, element(corners, k))));
  return gcdt_mix(seed);
}

static inline uint urgency_of(Mesh mesh, Judged j) {
  const u64 badness = gcdt_badness(j.shape);
  const uint order = (gcdt_precedence(j.shape.shortest, badness) << GCDT_NEEDLE_BITS) | gcdt_needle(j.shape),
             lot = badness < GCDT_MOST_BADNESS
                       ? 0u
                       : (uint)(hash_of_corners(mesh, j.corners, 0u) >> (64u - URGENCY_LOT_BITS));
  return (order << URGENCY_LOT_BITS) | lot;
}

static inline uint in_the_way(uint word) { return word & URGENCY_IN_THE_WAY ? word >> URGENCY_BITS : 0u; }

// ---- Lots ---------------------------------------------------------------------------------------------------
// In each round a triangle draws a number: 0 or more, 1 or more in one of two draws, 2 or more in one of four, and so
// on. With number k it may go through a cavity of `most` 2^k faces; if that has more, it sits this round out. So of
// triangles that share a large cavity about `most` are left to claim it, whatever its size, and they look at about as
// many faces each. The number comes from the corners' places and the round: it is the same on every device, and anew in
// each round.

static inline uint draw(Mesh mesh, uint4 corners, uint round) {
  const uint lot = (uint)(hash_of_corners(mesh, corners, gcdt_mix(round + 1u)) >> 32) | (1u << 20);
  return popcount((lot & (~lot + 1u)) - 1u);
}

// One whose cavity was too large needs a greater number than that time to look again: a cavity mostly stays as large.
// The handicap is small, so that one that has shrunk is looked at in some rounds.
static inline uint handicap_of(uint word) { return word >> URGENCY_HANDICAP_BIT & URGENCY_MOST_HANDICAP; }

static inline uint with_handicap(uint word, uint number) {
  return (word & ~(URGENCY_MOST_HANDICAP << URGENCY_HANDICAP_BIT)) | min(number + 1u, URGENCY_MOST_HANDICAP)
                                                                         << URGENCY_HANDICAP_BIT;
}

// The face beyond an unconstrained side; GCDT_NONE beyond others.
static inline uint ref_beyond(Mesh mesh, volatile global const uint* marks, uint code) {
  return is_constrained(marks, code) ? GCDT_NONE : mesh.edge_faces[code ^ 1u];
}

// Most slivers between slivers have large cavities, so these have a handicap before they have aimed at all: by powers
// of two of the least angle's cotangent, from about 8 on (the tangent is rounded down to 2^-8). One with fewer such
// neighbours stands apart, or at the end of a row, from where the row is mended.
static inline uint estimated_handicap(uint word) {
  const uint badness = word >> (URGENCY_BITS + URGENCY_LOT_BITS + GCDT_NEEDLE_BITS) & GCDT_MOST_BADNESS,
             tangent = GCDT_MOST_BADNESS - badness, least = 1u << GCDT_TANGENT_BITS;
  return tangent > least / 8u ? 0u : tangent > least / 16u ? 1u : tangent > least / 32u ? 2u : URGENCY_MOST_HANDICAP;
}

static bool is_among_slivers(Mesh mesh, volatile global const uint* marks, uint face, global const uint* urgency) {
  const uint4 s = mesh.face_data[GCDT_SIDES(face)];
  uint slivers = 0u;
  for (uint k = 0; k < 3u; ++k) {
    const uint ref = ref_beyond(mesh, marks, element(s, k));
    slivers += ref != GCDT_NONE && estimated_handicap(urgency[GCDT_REF_FACE(ref)]) > 0u;
  }
  return slivers >= 2u;
}

static inline uint other_side(Mesh mesh, uint ref, uint number) {
  const uint k = GCDT_REF_CORNER(ref);
  return element(mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(ref))], number == 0u ? next_corner(k) : previous_corner(k));
}

// Does a triangle lose this round's draw? Its handicap is the one that its last aim has given it, or else what is to be
// expected.
static bool loses(Mesh mesh, volatile global const uint* marks, uint face, uint round, global const uint* urgency) {
  const uint word = urgency[face], given = handicap_of(word), handicap = given > 0u ? given : estimated_handicap(word);
  return handicap > 0u && draw(mesh, mesh.face_data[GCDT_CORNERS(face)], round) < handicap &&
         (given > 0u || is_among_slivers(mesh, marks, face, urgency));
}

// A way from a face to one beyond at most three sides: the number of sides, the side of the face, and of each face
// entered then the side after that of the entry (0) or before it (1). GCDT_NO_WAY: none.
#define GCDT_NO_WAY 0u
static inline uint way(uint sides, uint k, uint a, uint b) { return sides | k << 2 | a << 4 | b << 5; }
static inline uint first_side(uint w) { return w >> 2 & 3u; }

static inline bool goes_before(uint ref, uint own, global const uint* urgency) {
  return ref != GCDT_NONE && in_the_way(urgency[GCDT_REF_FACE(ref)]) > own;
}

// Leads the way to a face that goes before it?
static inline bool leads_to_worse(Mesh mesh, volatile global const uint* marks, uint face, uint w, uint own,
                                  global const uint* urgency) {
  const uint sides = w & 3u;
  if (sides == 0u) return false;
  uint ref = ref_beyond(mesh, marks, element(mesh.face_data[GCDT_SIDES(face)], first_side(w)));
  if (sides > 1u && ref != GCDT_NONE) ref = ref_beyond(mesh, marks, other_side(mesh, ref, w >> 4 & 1u));
  if (sides > 2u && ref != GCDT_NONE) ref = ref_beyond(mesh, marks, other_side(mesh, ref, w >> 5 & 1u));
  return goes_before(ref, own, urgency);
}

// The way to a face that goes before it two or three steps over the side with reference `one`, number k, and there over
// side a, or none.
static uint way_beyond(Mesh mesh, volatile global const uint* marks, uint one, uint k, uint a, uint own,
                       global const uint* urgency) {
  const uint two = ref_beyond(mesh, marks, other_side(mesh, one, a));
  if (two == GCDT_NONE) return GCDT_NO_WAY;
  if (goes_before(two, own, urgency)) return way(2u, k, a, 0u);
  for (uint b = 0; b < 2u; ++b)
    if (goes_before(ref_beyond(mesh, marks, other_side(mesh, two, b)), own, urgency)) return way(3u, k, a, b);
  return GCDT_NO_WAY;
}

// The way to one over side k and, if there are more, side a: all six find all that there is.
static inline uint way_by(Mesh mesh, volatile global const uint* marks, uint face, uint k, uint a, uint own,
                          global const uint* urgency) {
  const uint one = ref_beyond(mesh, marks, face_side(mesh, face, k));
  if (one == GCDT_NONE) return GCDT_NO_WAY;
  if (goes_before(one, own, urgency)) return way(1u, k, 0u, 0u);
  return way_beyond(mesh, marks, one, k, a, own, urgency);
}

// The way to a face for which it must wait, or none. Looks at 21 others at most, and first where `last` leads, the way
// that it found when it was asked before: most still have to wait for the same one. Then at its neighbours, where what
// is worse mostly is. Whether there is a way depends on neither.
static uint way_to_worse(Mesh mesh, volatile global const uint* marks, uint face, uint last,
                         global const uint* urgency) {
  const uint own = urgency[face] >> URGENCY_BITS;
  if (own == 0u) return GCDT_NO_WAY;
  if (leads_to_worse(mesh, marks, face, last, own, urgency)) return last;
  const uint4 s = mesh.face_data[GCDT_SIDES(face)];
  for (uint k = 0; k < 3u; ++k)
    if (goes_before(ref_beyond(mesh, marks, element(s, k)), own, urgency)) return way(1u, k, 0u, 0u);
  for (uint k = 0; k < 3u; ++k) {
    const uint one = ref_beyond(mesh, marks, element(s, k));
    for (uint a = 0; a < 2u && one != GCDT_NONE; ++a) {
      const uint found = way_beyond(mesh, marks, one, k, a, own, urgency);
      if (found != GCDT_NO_WAY) return found;
    }
  }
  return GCDT_NO_WAY;
}

#endif
