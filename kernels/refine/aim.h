// SPDX-License-Identifier: Apache-2.0
// By which vertices triangles and subsegments are mended (docs/refinement.md, A). OpenCL C only.
#ifndef GCDT_AIM_H
#define GCDT_AIM_H

#include "refine/judge.h"

// ---- Places on subsegments ------------------------------------------------------------------------------

// Is m in the closed face beyond an unconstrained side, no corner, and on no constrained side? Outside the domain,
// where faces are as good as any other cover, a vertex may be there, if the side can be flipped then: r and the vertex
// are on either side of the line on which the side's ends are. So what is beside a border does not hide its places, nor
// do the rays that bound symbolic faces.
static bool fits_beyond(Mesh mesh, volatile global const uint* marks, uint code, Vertex m) {
  if (is_constrained(marks, code)) return false;
  const uint face = GCDT_REF_FACE(mesh.edge_faces[code ^ 1u]), on = side_under(mesh, face, m);
  if (on == GCDT_NONE) return false;
  return on == 3u || !is_constrained(marks, element(mesh.face_data[GCDT_SIDES(face)], on));
}

// m on the side of directed edge p -> q that face (p, q, r) lies on, strictly: is it in the closed face, no corner, and
// on no constrained side? `ref` is the face with its corner r.
static bool fits_face(Mesh mesh, volatile global const uint* marks, uint ref, Vertex m) {
  const uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)], s = mesh.face_data[GCDT_SIDES(face)];
  const Vertex p = corner_vertex(mesh, c, next_corner(k)), q = corner_vertex(mesh, c, previous_corner(k)),
               r = corner_vertex(mesh, c, k);
  const i64 beside_p = gcdt_orient2d(q, r, m), beside_q = gcdt_orient2d(r, p, m);
  const bool beyond_qr = beside_p < 0 && beside_q > 0, beyond_rp = beside_q < 0 && beside_p > 0;
  if (s.w == 0u && (beyond_qr || beyond_rp))
    return gcdt_orient2d(beyond_qr ? p : m, beyond_qr ? m : q, r) > 0 &&
           fits_beyond(mesh, marks, element(s, beyond_qr ? next_corner(k) : previous_corner(k)), m);
  if (beside_p < 0 || beside_q < 0 || (beside_p == 0 && beside_q == 0)) return false;
  // The side across from p ends in q and r.
  if (beside_p == 0) return !is_constrained(marks, element(s, next_corner(k)));
  if (beside_q == 0) return !is_constrained(marks, element(s, previous_corner(k)));
  return true;
}

// May subsegment pq, the edge e, be split at m? Its near face is that of side 0, on which p -> q runs forward.
static bool is_valid_place(Mesh mesh, volatile global const uint* marks, uint e, Vertex p, Vertex q, Vertex m) {
  const i64 side = gcdt_orient2d_finite(p, q, m);
  if (side == 0) return gcdt_dot(m, p, q) < 0;
  return fits_face(mesh, marks, mesh.edge_faces[2u * e + (side > 0 ? 0u : 1u)], m);
}

// The h-th of five attempts around place k: k, k + h, k - h, k + 2h, k - 2h.
static inline i64 attempt(i64 k, i64 step, uint number) {
  const i64 away = (number + 1u) / 2u * step;
  return number % 2u == 1u ? k + away : k - away;
}

typedef struct Place {
  bool found, far;  // far: rounded the other way
  Vertex at;
  u64 squared;  // the length of the subsegment
} Place;

// Where subsegment e can be split.
GCDT_APART Place find_place(Judge judge, uint e) {
  const Mesh mesh = judge.mesh;
  const uint ref = mesh.edge_faces[2u * e], number = judge.edge_pieces[e];
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const uint vp = element(c, next_corner(GCDT_REF_CORNER(ref))), vq = element(c, previous_corner(GCDT_REF_CORNER(ref)));
  const Vertex p = vertex_at(mesh.points, vp), q = vertex_at(mesh.points, vq);
  Place place;
  place.found = place.far = false;
  place.at = p;
  place.squared = gcdt_squared_length(p, q);
  const uint2 ends = judge.pieces[number];
  const Piece piece = gcdt_piece(vertex_at(mesh.points, ends.x), vertex_at(mesh.points, ends.y));
  const i64 kp = gcdt_place_of(piece, p), kq = gcdt_place_of(piece, q), low = min(kp, kq), high = max(kp, kq);
  const uint sharp_ends = judge.sharp[number];
  const bool p_sharp = (vp == ends.x && (sharp_ends & 1u)) || (vp == ends.y && (sharp_ends & 2u)),
             q_sharp = (vq == ends.x && (sharp_ends & 1u)) || (vq == ends.y && (sharp_ends & 2u));
  i64 k = (low + high) / 2;
  if (p_sharp != q_sharp) {
    const i64 shell = gcdt_shell(piece, place.squared);
    k = (p_sharp ? kp : kq) == 0 ? shell : piece.along - shell;
  }
  const i64 step = max((i64)1, (high - low) / 16);
  const bool border =
      label_of(mesh, GCDT_REF_FACE(ref)) == 0u || label_of(mesh, GCDT_REF_FACE(mesh.edge_faces[2u * e + 1u])) == 0u;
  // Not shorter than wanted: refused. Else five places, and beside a border five that are rounded the other way.
  const uint attempts = place.squared / 4u < judge.rules.least_squared ? 0u : border ? 10u : 5u;
  for (uint at = 0; at < attempts && !place.found; ++at) {
    const i64 tried = attempt(k, step, at % 5u);
    if (tried <= low || tried >= high) continue;
    place.far = at >= 5u;
    place.at = gcdt_at_place(piece, tried, place.far);
    place.found = is_valid_place(mesh, judge.marks, e, p, q, place.at);
  }
  return place;
}

// ---- Aims -----------------------------------------------------------------------------------------------

// What comes of a triangle that is to be mended.
typedef struct Aim {
  Vertex target;
  Arrival at;
  bool wanted;  // a candidate
  bool failed;
  bool sits_out;  // its cavity has more faces than it may look at in this round
  bool tied;      // with a face beside the cavity (Tour)
  uint in_way;    // subsegments that must be split first
  uint open;      // of these, if it explains, that have a place to be split at
  uint fixed;     // that may not be split
} Aim;

// A subsegment is in the way. `looks`: for a place to split it at.
static void meet(Judge judge, uint code, Aim* aim, bool looks) {
  if (!may_split(judge.mesh, judge.rules, code)) {
    ++aim->fixed;
    return;
  }
  ++aim->in_way;
  if (looks && find_place(judge, GCDT_SIDE_EDGE(code)).found) ++aim->open;
}

// Asks for the subsegments that are in the way of an aim: when it is known that it does not sit out. Ends: go_on.
static void ask_for_way(Judge judge, Aim aim, Lists lists) {
  const Mesh mesh = judge.mesh;
  if (aim.at.kind == GCDT_AT_SUBSEGMENT) {
    ask(lists, GCDT_SIDE_EDGE(element(mesh.face_data[GCDT_SIDES(aim.at.face)], aim.at.corner)));
    return;
  }
  Tour tour = begin_tour(mesh, judge.marks, aim.at.face, aim.target);
  do {
    if (tour.constrained &&
        gcdt_in_lens(judge.rules, corner_vertex(mesh, tour.corners, next_corner(tour.corner)),
                     corner_vertex(mesh, tour.corners, previous_corner(tour.corner)), aim.target) &&
        may_split(mesh, judge.rules, tour.code))
      ask(lists, GCDT_SIDE_EDGE(tour.code));
  } while (go_on(&tour));
}

// The target of a triangle, and the walk to it. A subsegment that stops the walk must be split first. `explains`: to
// tell the reason.
static Aim begin_aim(Judge judge, uint face, Judged j, bool explains) {
  Aim aim;
  const Mesh mesh = judge.mesh;
  const uint k = j.shape.corner;
  aim.wanted = aim.failed = aim.sits_out = aim.tied = false;
  aim.in_way = aim.open = aim.fixed = 0u;
  aim.target =
      gcdt_aim(corner_vertex(mesh, j.corners, next_corner(k)), corner_vertex(mesh, j.corners, previous_corner(k)),
               corner_vertex(mesh, j.corners, k), j.shape, judge.rules);
  aim.at = walk_to(mesh, judge.marks, face, aim.target);
  if (aim.at.kind == GCDT_AT_SUBSEGMENT)
    meet(judge, element(mesh.face_data[GCDT_SIDES(aim.at.face)], aim.at.corner), &aim, explains);
  aim.failed = aim.at.kind == GCDT_AT_FAILED;
  return aim;
}

static inline bool has_cavity(Aim aim) { return aim.at.kind == GCDT_AT_FACE || aim.at.kind == GCDT_AT_EDGE; }

// Is the target too near a vertex? Then it is given up: a circumcentre has R >= s / (2 sin theta), so up to 39 degrees
// sqrt(5/8) s around it are free unless rounding or a subsegment has been at work.
static inline bool is_too_near(Judged j, Vertex vertex, Vertex target) {
  const bool sharp = j.verdict == VERDICT_SHARP;
  return gcdt_product_less(sharp ? 8u : 4u, gcdt_squared_length(vertex, target), sharp ? 5u : 1u, j.shape.shortest);
}

// A tour of the target's cavity. A subsegment that has the target in its lens must be split first. A cavity of more
// than `most` faces is given up for this round, before anything has come of it.
static void tour_cavity(Judge judge, Judged j, Aim* aim, bool explains, ulong most, CavityList* cavity, Lists lists) {
  const Mesh mesh = judge.mesh;
  ulong entered = 0u;
  bool near = false;
  Tour tour = begin_ordered_tour(mesh, judge.marks, aim->at.face, aim->target);
  do {
    if (tour.entered) {
      if (++entered > most) {
        aim->sits_out = true;
        return;
      }
      if (cavity) add_to_list(cavity, tour.face, lists.report);
    }
    const Vertex p = corner_vertex(mesh, tour.corners, next_corner(tour.corner)),
                 q = corner_vertex(mesh, tour.corners, previous_corner(tour.corner));
    // Each corner of the cavity begins one of the sides that are looked over.
    if (is_too_near(j, p, aim->target)) near = true;
    if (tour.constrained && gcdt_in_lens(judge.rules, p, q, aim->target)) meet(judge, tour.code, aim, explains);
  } while (go_on(&tour));
  aim->failed = tour.steps == 0u;
  aim->tied = tour.tied;
  aim->wanted = !near && aim->in_way == 0u && aim->fixed == 0u;
}

#endif
