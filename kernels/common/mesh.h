// SPDX-License-Identifier: Apache-2.0
// The triangulation as kernels see it: accessors, rotation, claims. OpenCL C only.
#ifndef GCDT_MESH_H
#define GCDT_MESH_H

#include "common/corners.h"
#include "common/forest.h"
#include "common/predicates.h"

// Layout and ownership: shared.h.
typedef struct Mesh {
  u32 n, roots;
  global const int2* points;
  global uint4* face_data;
  global uint* edge_faces;
} Mesh;

#define GCDT_MESH_PARAMETERS uint n, global const int2 *points, global uint4 *face_data, global uint *edge_faces

static inline Mesh make_mesh(GCDT_MESH_PARAMETERS) {
  const Mesh mesh = {
      .n = n, .roots = root_count(points, n), .points = points, .face_data = face_data, .edge_faces = edge_faces};
  return mesh;
}

static inline Vertex load_vertex(global const int2* points, uint n, uint v) {
  if (v >= n) return gcdt_symbolic_vertex((int)symbol_of(v, n));
  return vertex_at(points, v);
}

// Corner k of face t, and the side across from it: one load, where picking it from all three would take branches.
static inline uint face_corner(Mesh mesh, uint t, uint k) {
  return ((global const uint*)(mesh.face_data + GCDT_CORNERS(t)))[k];
}
static inline uint face_side(Mesh mesh, uint t, uint k) {
  return ((global const uint*)(mesh.face_data + GCDT_SIDES(t)))[k];
}
static inline void set_side(global uint4* face_data, uint t, uint k, uint code) {
  ((global uint*)(face_data + GCDT_SIDES(t)))[k] = code;
}

// Both words of a link: side k of face t is the side code.
static inline void join(global uint4* face_data, global uint* edge_faces, uint t, uint k, uint code) {
  set_side(face_data, t, k, code);
  edge_faces[code] = GCDT_FACE_REF(t, k);
}

// The faces and edges that vertex v brings: two and three.
static inline uint new_face(Mesh mesh, uint v, uint i) { return gcdt_forest_faces(v, mesh.roots) + i; }
static inline uint new_edge(Mesh mesh, uint v, uint j) { return gcdt_forest_edges(v, mesh.roots) + j; }

// Writes the symbolic triangle of root p: face p with edges 3p, 3p+1, 3p+2 that have no other side.
static inline void make_root(Mesh mesh, uint p) {
  const uint v = mesh.n + 3u * p, e = 3u * p;
  mesh.face_data[GCDT_CORNERS(p)] = (uint4)(v, v + 1u, v + 2u, 0u);
  mesh.face_data[GCDT_SIDES(p)] = (uint4)(GCDT_SIDE(e, 0u), GCDT_SIDE(e + 1u, 0u), GCDT_SIDE(e + 2u, 0u), 0u);
  for (uint k = 0; k < 3u; ++k) {
    mesh.edge_faces[2u * (e + k)] = GCDT_FACE_REF(p, k);
    mesh.edge_faces[2u * (e + k) + 1u] = GCDT_NONE;
  }
}

// ---- Claims ---------------------------------------------------------------------------------------
// corners[t].w is the face's claim word. In a round every candidate (a vertex to be inserted, an edge
// to be flipped) has a ticket = (stamp << bits) | permuted number, with `bits` wide enough for all
// numbers, so tickets of one round differ, and atomic_max leaves the best candidate of the newest
// round: words of older rounds need no clearing until the stamps are used up. The permutation is the
// same for every face: the best of all candidates wins every face that it claims, so a round with a
// candidate has a winner.

// A bijection on [0, 2^bits): multiplications by odd numbers and shifted self-differences are.
static inline uint permute_number(uint number, uint bits) {
  const uint mask = bits >= 32u ? 0xFFFFFFFFu : (1u << bits) - 1u;
  const uint shift = (bits >> 1) + 1u;
  uint x = (number * 0x9E3779B1u) & mask;
  x ^= x >> shift;
  x = (x * 0x85EBCA6Bu) & mask;
  x ^= x >> shift;
  return (x * 0xC2B2AE35u) & mask;
}

static inline uint make_ticket(uint stamp, uint bits, uint number) {
  return (stamp << bits) | permute_number(number, bits);
}

static inline volatile global uint* claim_word(global uint4* face_data, uint face) {
  return (volatile global uint*)(face_data + GCDT_CORNERS(face)) + 3;
}

// ---- Counters -------------------------------------------------------------------------------------
// Adds to a 64-bit count kept in two words: the add that wraps the low word carries. Atomics at one
// address queue up (a nanosecond each on a large GPU), so kernels add once for a work-group.
static inline void add_wide(volatile global uint* low, volatile global uint* high, u64 amount) {
  if (amount == 0) return;
  const uint amount_low = (uint)amount, old = atomic_add(low, amount_low);
  const uint amount_high = (uint)(amount >> 32) + (old + amount_low < old ? 1u : 0u);
  if (amount_high > 0u) atomic_add(high, amount_high);
}

// The sum of every work-item's amount, below 2^32, valid on work-item 0 of the group. All work-items of the
// group call it; `sum` is one word of local memory.
GCDT_GIVEN_LOCAL uint sum_of_group(volatile local uint* sum, uint amount) {
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0) *sum = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (amount > 0u) atomic_add(sum, amount);
  barrier(CLK_LOCAL_MEM_FENCE);
  return *sum;
}

GCDT_GIVEN_LOCAL void add_for_group(volatile local uint* sum, volatile global uint* low, volatile global uint* high,
                                    uint amount) {
  const uint total = sum_of_group(sum, amount);
  if (get_local_id(0) == 0) add_wide(low, high, total);
}

#endif
