// SPDX-License-Identifier: Apache-2.0
// Which slots of crossed faces and edges a piece has: see slots.cl. OpenCL C only.
#ifndef GCDT_SLOTS_H
#define GCDT_SLOTS_H

#include "common/mesh.h"

// The piece that a crossed face with these sides is listed with: one that crosses a side of it. No face is crossed
// without one, since a piece that begins and ends in the closure of a face is an edge.
static inline uint piece_of_face(volatile global const uint* near, uint4 sides) {
  const uint x = near[sides.x], y = near[sides.y], z = near[sides.z];
  return x != GCDT_NONE ? x : y != GCDT_NONE ? y : z != GCDT_NONE ? z : 0u;
}

// A piece's record: (x, y) plus a place in its left or right chain is the number of the triangle there; z plus the number
// of a triangle is the slot of the edge between it and the next one, among the crossed edges, if it is less than w.

#endif
