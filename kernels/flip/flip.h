// SPDX-License-Identifier: Apache-2.0
// A flip: its test, the exchange of an edge, and how a work-item gets hold of faces. OpenCL C only.
#ifndef GCDT_FLIP_H
#define GCDT_FLIP_H

#include "common/mesh.h"

#ifndef GCDT_FLIP_WORKLIST
#define GCDT_FLIP_WORKLIST 8  // edges remembered by a propagating work-item (paper, 7.2: 8 is enough)
#endif
// Flips of one work-item in one round at most, which bounds the launch. A GPU has more edges than work-items to flip
// them, and a work-item that flips on makes its group wait: no propagation is fastest there (bench/NOTES.md). A CPU
// wins by the rounds that propagation saves.
#ifndef GCDT_FLIP_CHAIN
#ifdef GCDT_GPU
#define GCDT_FLIP_CHAIN 1
#else
#define GCDT_FLIP_CHAIN 32
#endif
#endif

typedef struct Claim {
  u32 stamp, bits;
} Claim;

static inline Claim make_claim(uint stamp, uint bits) {
  Claim c;
  c.stamp = stamp;
  c.bits = bits;
  return c;
}

static inline bool claimed_now(uint word, Claim c) { return (word >> c.bits) == c.stamp; }

// The face references on both sides of edge e.
static inline uint2 faces_of_edge(Mesh mesh, uint e) { return ((global const uint2*)mesh.edge_faces)[e]; }

// Is the edge with these face references, whose faces have these corners, illegal?
static inline bool is_illegal_between(Mesh mesh, uint near, uint far, uint4 corners, uint4 opposite) {
  const uint4 r = rotate_to(corners, GCDT_REF_CORNER(near));
  const uint d = element(opposite, GCDT_REF_CORNER(far));
  return gcdt_must_flip(load_vertex(mesh.points, mesh.n, r.z), load_vertex(mesh.points, mesh.n, r.x),
                        load_vertex(mesh.points, mesh.n, r.y), load_vertex(mesh.points, mesh.n, d));
}

// Is the edge with face references `near` and `far` illegal? Reads of a far face that another
// work-item is changing give a worthless answer: the caller must own the face before acting on it.
static bool is_illegal(Mesh mesh, uint near, uint far) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(near))],
              opposite = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(far))];
  return is_illegal_between(mesh, near, far, c, opposite);
}

//   before: t = (b, x, y), u = (d, y, x)        after: t = (b, x, d), u = (d, y, b)
//        b                                            b
//      / t \        edges of t: e, ex (y-b), ey (b-x)   /|\      t: (f_y, e, e_y)
//     x-----y       edges of u: e, fy (x-d), fx (d-y)  x t|u y    u: (e_x, e, f_x)
//      \ u /                                            \|/
//        d                                              d
// b keeps its place in t and d in u, so that e_y and f_x stay where they are: scattered words are what a flip costs.
// Writes only words of the two faces, which the caller owns (L1). The claim words stay.
// `code`: the edge's side that t has, either of the two. `refs`, `corners_t`, `corners_u`, `st`, `su`: the faces, their
// corners and sides. `around` gets the owned sides' codes of the four edges around.
static void flip_side_with(Mesh mesh, uint code, uint2 refs, uint4 corners_t, uint4 corners_u, uint4 st, uint4 su,
                           private uint* around) {
  const uint t = GCDT_REF_FACE(refs.x), u = GCDT_REF_FACE(refs.y);
  const uint b = GCDT_REF_CORNER(refs.x), d = GCDT_REF_CORNER(refs.y);
  const uint x = next_corner(b), y = previous_corner(b), y_of_u = next_corner(d), x_of_u = previous_corner(d);
#ifdef GCDT_CONTIGUOUS
  // Word by word: no corner is picked by branches that cannot be foretold, and no record is read whole while words of
  // it are still on their way to memory. A third of a flip's time (bench/NOTES.md).
  global uint* at = (global uint*)(mesh.face_data + GCDT_CORNERS(t));
  global uint* au = (global uint*)(mesh.face_data + GCDT_CORNERS(u));
  const uint ex = at[4u + x], fy = au[4u + y_of_u];
  around[0] = fy;
  around[1] = at[4u + y];
  around[2] = ex;
  around[3] = au[4u + x_of_u];
  at[y] = au[d];
  au[x_of_u] = at[b];
  at[4u + b] = fy;
  at[4u + x] = code;
  au[4u + d] = ex;
  au[4u + y_of_u] = code ^ 1u;
  mesh.edge_faces[code] = GCDT_FACE_REF(t, x);
  mesh.edge_faces[code ^ 1u] = GCDT_FACE_REF(u, y_of_u);
  mesh.edge_faces[fy] = GCDT_FACE_REF(t, b);
  mesh.edge_faces[ex] = GCDT_FACE_REF(u, d);
#else
  const uint ex = element(st, x), fy = element(su, y_of_u);
  mesh.face_data[GCDT_CORNERS(t)] = with_element(corners_t, y, element(corners_u, d));
  mesh.face_data[GCDT_CORNERS(u)] = with_element(corners_u, x_of_u, element(corners_t, b));
  mesh.face_data[GCDT_SIDES(t)] = with_element(with_element(st, b, fy), x, code);
  mesh.face_data[GCDT_SIDES(u)] = with_element(with_element(su, d, ex), y_of_u, code ^ 1u);
  const uint2 links = (uint2)(GCDT_FACE_REF(t, x), GCDT_FACE_REF(u, y_of_u));
  ((global uint2*)mesh.edge_faces)[GCDT_SIDE_EDGE(code)] = code & 1u ? links.yx : links;
  mesh.edge_faces[fy] = GCDT_FACE_REF(t, b);
  mesh.edge_faces[ex] = GCDT_FACE_REF(u, d);
  around[0] = fy;
  around[1] = element(st, y);
  around[2] = ex;
  around[3] = element(su, x_of_u);
#endif
}

// The same where the sides have not been read. (Where words are taken one by one, they are not read at once.)
static inline void flip_side(Mesh mesh, uint code, uint2 refs, uint4 corners_t, uint4 corners_u, private uint* around) {
#ifdef GCDT_CONTIGUOUS
  const uint4 st = (uint4)(0u), su = (uint4)(0u);
#else
  const uint4 st = mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(refs.x))],
              su = mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(refs.y))];
#endif
  flip_side_with(mesh, code, refs, corners_t, corners_u, st, su, around);
}

// Flips edge e, whose faces are `refs` in the order of its sides.
static inline void flip_edge(Mesh mesh, uint e, uint2 refs, uint4 corners_t, uint4 corners_u, private uint* around) {
  flip_side(mesh, GCDT_SIDE(e, 0u), refs, corners_t, corners_u, around);
}

// Takes the face for this round. Fails if anyone has claimed or locked it in this round; a claim is
// never given back within a round, so a face taken here was not changed since the round began.
static bool try_lock(Mesh mesh, uint face, uint ticket, Claim c) {
  volatile global uint* word = claim_word(mesh.face_data, face);
  const uint old = *word;
  return !claimed_now(old, c) && atomic_cmpxchg(word, old, ticket) == old;
}

// Whether the face, whose claim word was read as `seen`, is or now becomes the one's who has `ticket`: the same where
// words of the face are asked for together with it.
static inline bool own_face(Mesh mesh, uint face, uint seen, uint ticket, Claim c) {
  if (seen == ticket) return true;
  return !claimed_now(seen, c) && atomic_cmpxchg(claim_word(mesh.face_data, face), seen, ticket) == seen;
}

#endif
