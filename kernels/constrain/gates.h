// SPDX-License-Identifier: Apache-2.0
// What a walk needs of each edge that it crosses, in one place. OpenCL C only.
//
// In the mesh this is in three, each known from the one before: the face behind the edge, that face's corners and
// sides, the point of its corner across from the edge. A GPU's caches give out sectors of 32 bytes; where constraints
// cross many more edges than there are, as many as they can give out is what walks wait for. So there a gate is made
// for each side of each edge before any walk (gates.cl), and both gates of an edge fill one sector.
#ifndef GCDT_GATES_H
#define GCDT_GATES_H

#include "common/mesh.h"

// A vertex in two words, as a walk has it in registers: a coordinate has 31 bits, and where the sign bit of x is set
// the vertex is symbolic, and x its number. That of y says nothing of it.
#define GCDT_GATE_SIGN 0x80000000u

static inline int2 folded_vertex(global const int2* points, uint n, uint v) {
  return v < n ? points[v] : (int2)((int)(GCDT_GATE_SIGN | symbol_of(v, n)), 0);
}
static inline Vertex unfolded(int2 p) {
  return p.x < 0 ? gcdt_symbolic_vertex(p.x & 3) : gcdt_finite_vertex(p.x, p.y & 0x7FFFFFFF);
}

// What lies behind the edge that a walk leaves a face by. The gate belongs to the edge's side in the face behind.
typedef struct Gate {
  int2 apex;           // the corner across from the edge, folded
  uint after, before;  // the side codes across from the corners after and before the apex; GCDT_NONE: no face is there
  uint word;           // the face's claim word if that says that it is a hexagon; else this, or any smaller one
} Gate;

// By side code: the apex, and both sides. The sign bit of the apex's y is of faces whose claim word is to be read.
typedef struct Gates {
  uint made;
  global const int4* at;
} Gates;

#define GCDT_GATE_PARAMETERS uint gates_made, global const int4 *gates_at

static inline Gates make_gates(GCDT_GATE_PARAMETERS) {
  const Gates g = {.made = gates_made, .at = gates_at};
  return g;
}

// From the mesh.
static inline Gate gate_of_side(Mesh mesh, uint side) {
  const uint ref = mesh.edge_faces[side], face = ref == GCDT_NONE ? 0u : GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  const uint4 corners = mesh.face_data[GCDT_CORNERS(face)], sides = mesh.face_data[GCDT_SIDES(face)];
  Gate g;
  g.apex = folded_vertex(mesh.points, mesh.n, element(corners, k));
  g.after = ref == GCDT_NONE ? GCDT_NONE : element(sides, next_corner(k));
  g.before = element(sides, previous_corner(k));
  g.word = corners.w;
  return g;
}

static inline Gate gate_made(Gates gates, Mesh mesh, uint side) {
  const int4 at = gates.at[side];
  Gate g;
  g.apex = at.xy;
  g.after = (uint)at.z;
  g.before = (uint)at.w;
  g.word = at.y < 0 ? *claim_word(mesh.face_data, GCDT_REF_FACE(mesh.edge_faces[side])) : 0u;
  return g;
}

#endif
