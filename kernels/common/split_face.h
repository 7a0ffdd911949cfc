// SPDX-License-Identifier: Apache-2.0
// Splits of faces and edges by a vertex: three or four faces in place of one or two. OpenCL C only.
// Only words of faces that the caller owns and of the vertex's own faces and edges are written (L1). All
// of these get the claim word `claim`.
#ifndef GCDT_SPLIT_FACE_H
#define GCDT_SPLIT_FACE_H

#include "common/mesh.h"

// Where others walk through the mesh while it changes (`walked`: grow.cl), new faces and edges are whole before they
// are linked: by an atomic that gives face t the claim that it has. It is the only order there is on PoCL 5, whose
// fences are empty functions, so that its compiler moves stores across them. It waits for all stores before it, so
// nobody else pays for it.
static inline void before_links(Mesh mesh, uint t, uint claim, bool walked) {
#ifndef GCDT_ALONE
  if (walked) atomic_xchg(claim_word(mesh.face_data, t), claim);
#endif
}

// A vertex brings exactly three edges. new_edge(mesh, m, j) of a face split by m is the spoke that joins m and p_j; of
// an edge split: 0 the second half of the edge, 1 and 2 the spokes to the apex of side 0 and 1. It brings two faces:
// f1 = new_face(mesh, m, 0) and f2 = new_face(mesh, m, 1).

//  v inside t:  child 0 = (v, p1, p2) in slot t, child 1 = (v, p2, p0) in f1, child 2 = (v, p0, p1) in f2.
//  Side s.x stays where it is, opposite corner 0 of slot t.
//  Spoke j has side 0 in child j+2 (opposite its corner 2) and side 1 in child j+1 (its corner 1).
static void split_face(Mesh mesh, uint v, uint t, uint claim, bool walked) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(t)], s = mesh.face_data[GCDT_SIDES(t)];
  const uint slot1 = new_face(mesh, v, 0u), slot2 = new_face(mesh, v, 1u);
  const uint e0 = new_edge(mesh, v, 0u), e1 = new_edge(mesh, v, 1u), e2 = new_edge(mesh, v, 2u);
  mesh.face_data[GCDT_CORNERS(slot1)] = (uint4)(v, c.z, c.x, claim);
  mesh.face_data[GCDT_CORNERS(slot2)] = (uint4)(v, c.x, c.y, claim);
  mesh.face_data[GCDT_SIDES(slot1)] = (uint4)(s.y, GCDT_SIDE(e0, 1u), GCDT_SIDE(e2, 0u), 0u);
  mesh.face_data[GCDT_SIDES(slot2)] = (uint4)(s.z, GCDT_SIDE(e1, 1u), GCDT_SIDE(e0, 0u), 0u);
  global uint2* spokes = (global uint2*)mesh.edge_faces + e0;
  spokes[0] = (uint2)(GCDT_FACE_REF(slot2, 2u), GCDT_FACE_REF(slot1, 1u));
  spokes[1] = (uint2)(GCDT_FACE_REF(t, 2u), GCDT_FACE_REF(slot2, 1u));
  spokes[2] = (uint2)(GCDT_FACE_REF(slot1, 2u), GCDT_FACE_REF(t, 1u));
  before_links(mesh, t, claim, walked);
  mesh.face_data[GCDT_CORNERS(t)] = (uint4)(v, c.y, c.z, claim);
  mesh.face_data[GCDT_SIDES(t)] = (uint4)(s.x, GCDT_SIDE(e2, 1u), GCDT_SIDE(e1, 0u), 0u);
  mesh.edge_faces[s.y] = GCDT_FACE_REF(slot1, 0u);
  mesh.edge_faces[s.z] = GCDT_FACE_REF(slot2, 0u);
}

// One side of an edge split: face t with apex a at corner k becomes (v, a, b) in slot t and (v, c, a)
// in `slot`. half_b and half_c are this side's codes of the edge's halves, whose faces the caller writes; spoke joins
// v and a.
static void split_side(Mesh mesh, uint v, uint t, uint k, uint slot, uint half_b, uint half_c, uint spoke, uint claim,
                       bool walked) {
  const uint4 c = rotate_to(mesh.face_data[GCDT_CORNERS(t)], k), s = rotate_to(mesh.face_data[GCDT_SIDES(t)], k);
  mesh.face_data[GCDT_CORNERS(slot)] = (uint4)(v, c.z, c.x, claim);
  mesh.face_data[GCDT_SIDES(slot)] = (uint4)(s.y, GCDT_SIDE(spoke, 1u), half_c, 0u);
  mesh.edge_faces[GCDT_SIDE(spoke, 0u)] = GCDT_FACE_REF(t, 2u);
  mesh.edge_faces[GCDT_SIDE(spoke, 1u)] = GCDT_FACE_REF(slot, 1u);
  before_links(mesh, t, claim, walked);
  mesh.face_data[GCDT_CORNERS(t)] = (uint4)(v, c.x, c.y, claim);
  mesh.face_data[GCDT_SIDES(t)] = (uint4)(s.z, half_b, GCDT_SIDE(spoke, 0u), 0u);
  mesh.edge_faces[s.z] = GCDT_FACE_REF(t, 0u);
  mesh.edge_faces[s.y] = GCDT_FACE_REF(slot, 0u);
}

// v on edge e between side 0 (a, b, c) in slot t and side 1 (d, c, b) in slot u:
//        a                 e keeps the half b-v, the new edge is v-c:
//       /|\                side 0: (v, a, b) in t, (v, c, a) in f1
//      b-v-c               side 1: (v, d, c) in u, (v, b, d) in f2
//       \|/
//        d
static void split_edge(Mesh mesh, uint v, uint e, uint claim, bool walked) {
  const uint ref0 = mesh.edge_faces[2u * e], ref1 = mesh.edge_faces[2u * e + 1u];
  const uint t = GCDT_REF_FACE(ref0), u = GCDT_REF_FACE(ref1);
  const uint far_half = new_edge(mesh, v, 0u), slot1 = new_face(mesh, v, 0u), slot2 = new_face(mesh, v, 1u);
  mesh.edge_faces[GCDT_SIDE(far_half, 0u)] = GCDT_FACE_REF(slot1, 2u);
  mesh.edge_faces[GCDT_SIDE(far_half, 1u)] = GCDT_FACE_REF(u, 1u);
  split_side(mesh, v, t, GCDT_REF_CORNER(ref0), slot1, GCDT_SIDE(e, 0u), GCDT_SIDE(far_half, 0u), new_edge(mesh, v, 1u),
             claim, walked);
  split_side(mesh, v, u, GCDT_REF_CORNER(ref1), slot2, GCDT_SIDE(far_half, 1u), GCDT_SIDE(e, 1u), new_edge(mesh, v, 2u),
             claim, walked);
  mesh.edge_faces[GCDT_SIDE(e, 0u)] = GCDT_FACE_REF(t, 1u);
  mesh.edge_faces[GCDT_SIDE(e, 1u)] = GCDT_FACE_REF(slot2, 2u);
}

#endif
