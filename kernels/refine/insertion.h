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

// v in the face beyond a side of face t that is across from pq's corner r; then the side is flipped, so that v is
// joined to both p and q (fits_beyond).
static void insert_beyond(Insertion in, uint v, uint code, Vertex x, uint claim) {
  const Mesh mesh = in.mesh;
  uint around[4];
  const uint face = GCDT_REF_FACE(mesh.edge_faces[code ^ 1u]), on = side_under(mesh, face, x);
  if (on == 3u)
    insert_in_face(in, v, face, claim);
  else
    insert_on_edge(in, v, GCDT_SIDE_EDGE(element(mesh.face_data[GCDT_SIDES(face)], on)), claim);
  const uint e = GCDT_SIDE_EDGE(code);
  const uint2 refs = ((global const uint2*)mesh.edge_faces)[e];
  flip_edge(mesh, e, refs, mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.x))],
            mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.y))], around);
}

// v for subsegment e = pq: on it, or beside it. Then the triangle v, p, q takes the label from beyond pq, its sides pv
// and vq are the subsegments, and pq is an edge like others.
static void insert_for_subsegment(Insertion in, uint v, uint e, Vertex x, uint claim) {
  const Mesh mesh = in.mesh;
  const uint piece = in.edge_pieces[e], ref = mesh.edge_faces[2u * e];
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const i64 side = gcdt_orient2d_finite(corner_vertex(mesh, c, next_corner(GCDT_REF_CORNER(ref))),
                                        corner_vertex(mesh, c, previous_corner(GCDT_REF_CORNER(ref))), x);
  if (side == 0) {
    insert_on_edge(in, v, e, claim);
    make_subsegment(in, GCDT_SIDE(new_edge(mesh, v, 0u), 0u), piece);
    return;
  }
  const uint near = GCDT_SIDE(e, side > 0 ? 0u : 1u);
  const uint near_ref = mesh.edge_faces[near], t = GCDT_REF_FACE(near_ref), k = GCDT_REF_CORNER(near_ref);
  const uint4 corners = mesh.face_data[GCDT_CORNERS(t)], s = mesh.face_data[GCDT_SIDES(t)];
  const uint beyond = mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(mesh.edge_faces[near ^ 1u]))].w;
  const Vertex p = corner_vertex(mesh, corners, next_corner(k)), q = corner_vertex(mesh, corners, previous_corner(k)),
               r = corner_vertex(mesh, corners, k);
  atomic_and(in.marks + e, ~GCDT_MARK_CONSTRAINED);
  in.edge_pieces[e] = GCDT_NONE;
  const uint other = code_beyond(mesh, near_ref, x);
  if (other != GCDT_NONE)
    insert_beyond(in, v, other, x, claim);
  else if (gcdt_orient2d(q, r, x) == 0)
    insert_on_edge(in, v, GCDT_SIDE_EDGE(element(s, next_corner(k))), claim);
  else if (gcdt_orient2d(r, p, x) == 0)
    insert_on_edge(in, v, GCDT_SIDE_EDGE(element(s, previous_corner(k))), claim);
  else
    insert_in_face(in, v, t, claim);
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

// Inserts the winner as vertex v, and makes its star Delaunay. Returns the number of flips.
static uint insert_winner(Insertion in, uint number, uint v) {
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
  if (kind == GCDT_IN_FACE) {
    insert_in_face(in, v, candidate.z, claim);
  } else if (kind == GCDT_ON_EDGE) {
    insert_on_edge(in, v, GCDT_SIDE_EDGE(candidate.z), claim);
  } else {
    atomic_inc(&in.report->on_subsegments);
    if (gcdt_orient2d_finite(vertex_at(mesh.points, origin.x), vertex_at(mesh.points, origin.y), x) != 0)
      atomic_inc(&in.report->bent);
    if (kind & GCDT_FAR) atomic_inc(&in.report->far);
    insert_for_subsegment(in, v, candidate.z, x, claim);
  }
  const uint flips = settle_star(in, v, x, claim, of_subsegment, (candidate.w & GCDT_TIED) != 0u);
  if (of_subsegment && leaves_subsegment(mesh, candidate.z, v)) atomic_or(&in.counters->lost, 1u);
  return flips;
}

#endif
