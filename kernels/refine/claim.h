// SPDX-License-Identifier: Apache-2.0
// Claims of faces by candidates. OpenCL C only.
#ifndef GCDT_CLAIM_H
#define GCDT_CLAIM_H

#include "refine/candidates.h"

typedef struct Ticket {
  uint stamp, bits, place;     // of the candidate in the order
  global const uint* numbers;  // of candidates in order
  volatile global uint* won;   // by number
} Ticket;

// Claims the face. Of two that claim one face the lesser loses, and is told by whichever comes second: it finds the
// other in the word, or its own value there is replaced by the other. So all but the greatest are told, in any order.
static inline void claim_face(Mesh mesh, uint face, Ticket t) {
  const uint ticket = (t.stamp << t.bits) | t.place, old = atomic_max(claim_word(mesh.face_data, face), ticket);
  if (old == ticket || old >> t.bits != t.stamp) return;
  atomic_xchg(t.won + t.numbers[old > ticket ? t.place : old & ((1u << t.bits) - 1u)], 0u);
}

#endif
