// SPDX-License-Identifier: Apache-2.0
// Where pieces have slots of crossed faces and edges: see slots.cl. OpenCL C only.
#ifndef GCDT_SLOTS_H
#define GCDT_SLOTS_H

#include "common/append.h"
#include "common/mesh.h"

// The near words of three sides: those of a face's from their right ends, or, each side ^ 1u, from their left ones.
static inline uint4 near_words(global const uint* near, uint4 s) {
  return (uint4)(near[s.x], near[s.y], near[s.z], 0u);
}

// The piece that a crossed face is listed with, by the near words of its sides: one that crosses a side of it. No face
// is crossed without one, since a piece that begins and ends in the closure of a face is an edge.
static inline uint piece_of_face(uint4 near) {
  return near.x != GCDT_NONE ? near.x : near.y != GCDT_NONE ? near.y : near.z != GCDT_NONE ? near.z : 0u;
}

// A piece's record: x or y, plus a place in its left or right chain, is the number of the triangle there; z plus the
// number of a triangle is the slot of the edge between it and the next one, among the crossed edges, if it is less than
// w, where the slots end that the piece has and uses. Where pieces have no slots of their own, triangles are numbered
// by place, all left ones first: 2c + 1 sentinels stand before them among the left chains, 2 pieces + 2c + 1 among all.
static inline uint4 slots_of_piece(uint grouped, uint pieces, global const uint4* records, uint c) {
  if (grouped) return records[c];
  return (uint4)(0u - (2u * c + 1u), 0u - (2u * (pieces + c) + 1u), 0u, 0u);
}

// Called by the whole group. A spare slot of an edge for each work-item that takes one, GCDT_NONE if none is left.
GCDT_GIVEN_LOCAL uint take_spare(volatile local uint* taken, uint grouped, bool takes, global const uint* spare,
                                 volatile global Counters* counters) {
  const uint place = take_numbers(taken, &counters->new_edges, takes ? 1u : 0u);
  return takes && place < (grouped ? counters->spare_edges : counters->crossed_edges) ? spare[place] : GCDT_NONE;
}

#endif
