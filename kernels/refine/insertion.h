// SPDX-License-Identifier: Apache-2.0
// The insertion of winners, each by one work-item. OpenCL C only.
#ifndef GCDT_INSERTION_H
#define GCDT_INSERTION_H

#include "common/split_face.h"
#include "refine/star.h"

// ---- Insertion ----------------------------------------------------------------------------------------------

static inline void set_label(Mesh mesh, uint face, uint label) { mesh.face_data[GCDT_SIDES(face)].w = label; }

static inline void make_subsegment(Insertion in, uint code, uint piece) {
  atomic_or(in.marks + GCDT_SIDE_EDGE(code), GCDT_MARK_CONSTRAINED);
  in.edge_pieces[GCDT_SIDE_EDGE(code)] = piece;
}

// v in face t.
static void insert_in_face(Insertion in, uint v, uint t, uint claim) {
  const uint4 s = in.mesh.face_data[GCDT_SIDES(t)];
  split_face(in.mesh, v, t, claim, false);
  set_label(in.mesh, t, s.w);
  for (uint i = 0; i < 2u; ++i) set_label(in.mesh, new_face(in.mesh, v, i), s.w);
}

// v on edge e.
static void insert_on_edge(Insertion in, uint v, uint e, uint claim) {
  uint face[2], label[2];
  for (uint side = 0; side < 2u; ++side) {
    const uint ref = in.mesh.edge_faces[2u * e + side];
    face[side] = GCDT_REF_FACE(ref);
    label[side] = label_of(in.mesh, face[side]);
  }
  split_edge(in.mesh, v, e, claim, false);
  for (uint side = 0; side < 2u; ++side) {
    set_label(in.mesh, face[side], label[side]);
    set_label(in.mesh, new_face(in.mesh, v, side), label[side]);
  }
}

// Where a vertex goes in.
typedef struct Spot {
  bool on_edge;
  uint what;     // the edge, or the face
  uint flipped;  // a side code: then that edge is flipped (fits_beyond); else GCDT_NONE
} Spot;

static inline Spot make_spot(bool on_edge, uint what) {
  Spot spot;
  spot.on_edge = on_edge;
  spot.what = what;
  spot.flipped = GCDT_NONE;
  return spot;
}

static void insert_at(Insertion in, uint v, Spot spot, uint claim) {
  const Mesh mesh = in.mesh;
  if (spot.on_edge)
    insert_on_edge(in, v, spot.what, claim);
  else
    insert_in_face(in, v, spot.what, claim);
  if (spot.flipped == GCDT_NONE) return;
  uint around[4];
  const uint e = GCDT_SIDE_EDGE(spot.flipped);
  const uint2 refs = ((global const uint2*)mesh.edge_faces)[e];
  flip_edge(mesh, e, refs, mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.x))],
            mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.y))], around);
}

// The side of subsegment e that x is beside; GCDT_NONE: x is on it.
static uint side_beside(Mesh mesh, uint e, Vertex x) {
  const uint ref = mesh.edge_faces[2u * e];
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const i64 side = gcdt_orient2d_finite(corner_vertex(mesh, c, next_corner(GCDT_REF_CORNER(ref))),
                                        corner_vertex(mesh, c, previous_corner(GCDT_REF_CORNER(ref))), x);
  return side == 0 ? GCDT_NONE : GCDT_SIDE(e, side > 0 ? 0u : 1u);
}

// For x beside a subsegment, in the face (p, q, r) of its side `near`, on one of that face's other sides, or in the
// face beyond one of these. In the last case that side is flipped, so that the vertex is joined to both p and q.
static Spot spot_beside(Mesh mesh, uint near, Vertex x) {
  const uint ref = mesh.edge_faces[near], t = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(t)], s = mesh.face_data[GCDT_SIDES(t)];
  const Vertex p = corner_vertex(mesh, c, next_corner(k)), q = corner_vertex(mesh, c, previous_corner(k)),
               r = corner_vertex(mesh, c, k);
  const uint other = code_beyond(mesh, ref, x);
  if (other != GCDT_NONE) {
    const uint face = GCDT_REF_FACE(mesh.edge_faces[other ^ 1u]), on = side_under(mesh, face, x);
    Spot spot = make_spot(on != 3u, on == 3u ? face : GCDT_SIDE_EDGE(element(mesh.face_data[GCDT_SIDES(face)], on)));
    spot.flipped = other;
    return spot;
  }
  if (gcdt_orient2d(q, r, x) == 0) return make_spot(true, GCDT_SIDE_EDGE(element(s, next_corner(k))));
  if (gcdt_orient2d(r, p, x) == 0) return make_spot(true, GCDT_SIDE_EDGE(element(s, previous_corner(k))));
  return make_spot(false, t);
}

// v where its candidate is. For a subsegment pq that is on it, or beside it: then the triangle v, p, q takes the label
// from beyond pq, its sides pv and vq are the subsegments, and pq is an edge like others. There is one place in the
// text where meshes are changed: compilers put a function's text wherever it is called, and take long over long
// kernels.
static void insert_in_place(Insertion in, uint v, uint4 candidate, uint claim) {
  const Mesh mesh = in.mesh;
  const uint kind = kind_of_candidate(candidate), e = candidate.z;
  const Vertex x = candidate_point(candidate);
  const bool of_subsegment = (kind & GCDT_ON_SUBSEGMENT) != 0u;
  const uint near = of_subsegment ? side_beside(mesh, e, x) : GCDT_NONE, piece = of_subsegment ? in.edge_pieces[e] : 0u;
  uint beyond = 0u;
  Spot spot;
  if (near != GCDT_NONE) {
    beyond = label_of(mesh, GCDT_REF_FACE(mesh.edge_faces[near ^ 1u]));
    spot = spot_beside(mesh, near, x);
  } else {
    spot = make_spot(kind != GCDT_IN_FACE, kind == GCDT_ON_EDGE ? GCDT_SIDE_EDGE(candidate.z) : candidate.z);
  }
  insert_at(in, v, spot, claim);
  if (!of_subsegment) return;
  if (near == GCDT_NONE) {
    make_subsegment(in, GCDT_SIDE(new_edge(mesh, v, 0u), 0u), piece);
    return;
  }
  atomic_and(in.marks + e, ~GCDT_MARK_CONSTRAINED);
  in.edge_pieces[e] = GCDT_NONE;
  const uint between = mesh.edge_faces[near], at = GCDT_REF_CORNER(between);
  const uint4 sides = mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(between))];
  set_label(mesh, GCDT_REF_FACE(between), beyond);
  make_subsegment(in, element(sides, next_corner(at)), piece);
  make_subsegment(in, element(sides, previous_corner(at)), piece);
}

// What a new vertex is put on: the corners of its face, counter-clockwise from the least in (x, y), or the ends of its
// edge in that order, so that it is the same whatever corner the face begins with, and whatever face the walk came
// from; and the piece.
static uint4 origin_of(Mesh mesh, uint4 candidate, global const uint* edge_pieces) {
  if (kind_of_candidate(candidate) == GCDT_IN_FACE) {
    const uint4 c = mesh.face_data[GCDT_CORNERS(candidate.z)];
    const u64 x = gcdt_tie_key(vertex_at(mesh.points, c.x)), y = gcdt_tie_key(vertex_at(mesh.points, c.y)),
              z = gcdt_tie_key(vertex_at(mesh.points, c.z));
    const uint4 from = rotate_to(c, x < y ? (x < z ? 0u : 2u) : (y < z ? 1u : 2u));
    return (uint4)(from.x, from.y, from.z, GCDT_NONE);
  }
  const bool on_edge = kind_of_candidate(candidate) == GCDT_ON_EDGE;
  const uint ref = mesh.edge_faces[on_edge ? candidate.z : 2u * candidate.z], k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const uint p = element(c, next_corner(k)), q = element(c, previous_corner(k));
  const bool first = gcdt_tie_key(vertex_at(mesh.points, p)) < gcdt_tie_key(vertex_at(mesh.points, q));
  return (uint4)(first ? p : q, first ? q : p, GCDT_NONE, on_edge ? GCDT_NONE : edge_pieces[candidate.z]);
}

// The wanted length at a new vertex.
static uint wanted_at(Mesh mesh, uint4 origin, Vertex x, global const uint* sizes) {
  const Vertex a = vertex_at(mesh.points, origin.x), b = vertex_at(mesh.points, origin.y);
  if (origin.z == GCDT_NONE) return gcdt_length_on_edge(a, b, x, sizes[origin.x], sizes[origin.y]);
  return gcdt_length_on_face(a, b, vertex_at(mesh.points, origin.z), x, sizes[origin.x], sizes[origin.y],
                             sizes[origin.z]);
}

// Does pq, the subsegment that was split, stay as an edge between v's star and a kept face without v? That face is
// another one now for how it is judged, though its corners are the same.
static bool leaves_subsegment(Mesh mesh, uint e, uint v) {
  for (uint side = 0; side < 2u; ++side) {
    const uint ref = mesh.edge_faces[2u * e + side], face = GCDT_REF_FACE(ref);
    const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
    if (c.x != v && c.y != v && c.z != v && label_of(mesh, face) != 0u) return true;
  }
  return false;
}

// What insertions of one round after the other have in common.
static Insertion make_insertion(Mesh mesh, volatile global uint* marks, global uint* edge_pieces, global uint* queue,
                                volatile global Counters* counters, volatile global RefineReport* report) {
  Insertion in;
  in.mesh = mesh;
  in.marks = marks;
  in.edge_pieces = edge_pieces;
  in.queue = queue;
  in.counters = counters;
  in.report = report;
  return in;
}

// The candidates of a round: `before` is the scan of its winners.
static inline void set_candidates(Insertion* in, global const uint* numbers, global const uint* before,
                                  global const uint* ranks, global const uint4* candidates) {
  in->numbers = numbers;
  in->before = before;
  in->ranks = ranks;
  in->candidates = candidates;
}

// Where what is known of new vertices is put; `origins` from vertex `inputs` on.
static inline void set_vertices(Insertion* in, global int2* points, uint inputs, global uint4* origins, uint sized,
                                global uint* sizes) {
  in->points = points;
  in->inputs = inputs;
  in->origins = origins;
  in->sized = sized;
  in->sizes = sizes;
}

// Whose faces are claimed by which words, and which faces are new: those of vertices from `first` on.
static inline void begin_insertion(Insertion* in, uint first, Claim round) {
  in->old_faces = new_face(in->mesh, first, 0u);
  in->round = round;
}

// The face of the candidate with that number, if it is a winner's in a face; else GCDT_NONE.
static inline uint winner_in_face(Insertion in, uint number) {
  if (in.before[number + 1u] == in.before[number]) return GCDT_NONE;
  const uint4 candidate = in.candidates[number];
  return kind_of_candidate(candidate) == GCDT_IN_FACE ? candidate.z : GCDT_NONE;
}

// What winners of the same share will ask for, from `number` on: their faces; then these faces' sides, and what is
// beyond them. Until they are inserted their faces are as they were, since nobody else changes these (L1); of what is
// beyond it is read what settle_star reads.
static inline void prefetch_winners(Insertion in, uint number, uint end) {
#ifdef GCDT_PREFETCHES
  const Mesh mesh = in.mesh;
  uint face = number + GCDT_FAR_AHEAD < end ? winner_in_face(in, number + GCDT_FAR_AHEAD) : GCDT_NONE;
  if (face != GCDT_NONE) GCDT_PREFETCH(mesh.face_data + GCDT_CORNERS(face));
  face = number + GCDT_AHEAD < end ? winner_in_face(in, number + GCDT_AHEAD) : GCDT_NONE;
  for (uint k = 0; k < 3u && face != GCDT_NONE; ++k) {
    const uint code = face_side(mesh, face, k);
    GCDT_PREFETCH(mesh.edge_faces + (code ^ 1u));
    GCDT_PREFETCH(in.marks + GCDT_SIDE_EDGE(code));
  }
  face = number + GCDT_AHEAD / 2u < end ? winner_in_face(in, number + GCDT_AHEAD / 2u) : GCDT_NONE;
  for (uint k = 0; k < 3u && face != GCDT_NONE; ++k)
    GCDT_PREFETCH(mesh.face_data + GCDT_CORNERS(GCDT_REF_FACE(mesh.edge_faces[face_side(mesh, face, k) ^ 1u])));
#else
  (void)in;
  (void)number;
  (void)end;
#endif
}

// Inserts the winner as vertex v, and makes its star Delaunay. Returns the number of flips.
GCDT_APART uint insert_winner(Insertion in, uint number, uint v) {
  const Mesh mesh = in.mesh;
  const uint claim = (in.round.stamp << in.round.bits) | in.ranks[number];
  const uint4 candidate = in.candidates[number];
  const Vertex x = candidate_point(candidate);
  const uint4 origin = origin_of(mesh, candidate, in.edge_pieces);
  in.origins[v - in.inputs] = origin;
  in.points[v] = (int2)((int)x.x, (int)x.y);
  if (in.sized) in.sizes[v] = wanted_at(mesh, origin, x, in.sizes);
  for (uint j = 0; j < 3u; ++j) {
    in.marks[new_edge(mesh, v, j)] = 0u;
    in.edge_pieces[new_edge(mesh, v, j)] = GCDT_NONE;
  }
  const uint kind = kind_of_candidate(candidate);
  const bool of_subsegment = (kind & GCDT_ON_SUBSEGMENT) != 0u;
  if (of_subsegment) {
    atomic_inc(&in.report->on_subsegments);
    if (gcdt_orient2d_finite(vertex_at(mesh.points, origin.x), vertex_at(mesh.points, origin.y), x) != 0)
      atomic_inc(&in.report->bent);
    if (kind & GCDT_FAR) atomic_inc(&in.report->far);
  }
  insert_in_place(in, v, candidate, claim);
  const uint flips = settle_star(in, v, x, claim, of_subsegment, (candidate.w & GCDT_TIED) != 0u);
  if (of_subsegment && leaves_subsegment(mesh, candidate.z, v)) atomic_or(&in.counters->lost, 1u);
  return flips;
}

#endif
