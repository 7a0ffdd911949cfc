// SPDX-License-Identifier: Apache-2.0
// Walking along a straight piece through the mesh (paper, section 6.2): each work-item takes one part
// of a piece, between two exact division points, and goes from face to face, beginning with the one that
// kernels/constrain/first.cl has found. OpenCL C only.
#ifndef GCDT_WALK_H
#define GCDT_WALK_H

#include "common/search.h"
#include "constrain/fan.h"
#include "constrain/gates.h"

// What a walk comes to in the current face.
#define WALK_CROSS 0u   // an edge, through which it leaves strictly between its ends
#define WALK_HIT 1u     // a vertex on the piece
#define WALK_END 2u     // the part ends in this face, or before what lies ahead (end_of_part)
#define WALK_FAILED 3u  // the face does not hold the walk: the mesh or the location is wrong

typedef struct Walk {
  u32 b;                         // the end that the walk goes to
  int4 line;                     // from a to b
  u32 k, parts;                  // from division point k to k + 1 of `parts`
  u32 face;                      // in which it began, or has come to a vertex; else see left_face
  i32 third_side;                // of the line, the corner across from the exit edge: 1 left, -1 right, 0 on it
  u32 code;                      // side code of the exit edge in this face, or of the edge walked along, or GCDT_NONE
  int2 point_left, point_right;  // the ends of an exit edge, folded (gates.h)
  i32 at_left, at_right;         // how far they are along the piece: way_along
  i32 until;                     // the next division point is that far at least
  u32 hit;                       // WALK_HIT: the vertex
} Walk;

// Walks start at the finer end: its location is a leaf below a face of the top layer, found without
// turning around a vertex of high degree.
static inline uint2 walk_ends(uint2 ends) { return ends.x > ends.y ? ends : ends.yx; }

// A piece's ends as points, from where it is walked to where: at hand in one load instead of two that wait for a third.
static inline int4 line_of(global const int2* points, uint2 ends) { return (int4)(points[ends.x], points[ends.y]); }
static inline Vertex line_begin(int4 line) { return gcdt_finite_vertex(line.x, line.y); }
static inline Vertex line_end(int4 line) { return gcdt_finite_vertex(line.z, line.w); }

// What a walk goes through, and how many faces it may pass around a vertex that has no fan.
typedef struct Walked {
  Mesh mesh;
  Fans fans;
  uint patience;
} Walked;

// Until fans are made, patience has an end where `hasty`. Else all faces are enough, since a turn comes to each once.
static inline Walked make_walked(Mesh mesh, Fans fans, uint hasty) {
  Walked w;
  w.mesh = mesh;
  w.fans = fans;
  w.patience = hasty && !fans.made ? GCDT_FAN_LEAST : gcdt_face_count(mesh.n);
  return w;
}

// A work-item whose walk took too long is less patient with the next: fans will be made, with which walks are short.
static inline void lose_patience(private Walked* w) { w->patience = max(w->patience / 2u, GCDT_LEAST_PATIENCE); }

// ---- What lies ahead -----------------------------------------------------------------------------

static inline int side_of_point(const private Walk* w, Vertex v) {
  return gcdt_sign64(gcdt_orient2d_from(line_begin(w->line), line_end(w->line), v));
}
static inline int side_of(const private Walk* w, Mesh mesh, uint v) {
  return side_of_point(w, load_vertex(mesh.points, mesh.n, v));
}

// How far a vertex is from a along the longer axis of a-b, counted towards b. Below 2^31; of a symbolic vertex nothing
// is said: it is as far as the next division point.
static inline i32 way_along(const private Walk* w, Vertex v) {
  if (v.symbol != 0) return w->until;
  const int dx = w->line.z - w->line.x, dy = w->line.w - w->line.y;
  const bool along_x = abs(dx) >= abs(dy);
  const int way = along_x ? (int)v.x - w->line.x : (int)v.y - w->line.y;
  return (along_x ? dx : dy) < 0 ? -way : way;
}

// Does vertex z, on the piece, come after division point k + 1? 31 bits times parts < 2^31.
static inline bool after_next_division(const private Walk* w, Vertex z) {
  return (i64)way_along(w, z) * (i64)w->parts > (i64)way_along(w, line_end(w->line)) * (i64)(w->k + 1u);
}

static uint come_to_vertex(private Walk* w, uint z, uint code) {
  w->hit = z;
  w->code = code;
  return WALK_HIT;
}

// The face that the walk leaves through its exit edge, as a reference with the corner across from the edge.
static inline uint left_face(const private Walk* w, Mesh mesh) { return mesh.edge_faces[w->code]; }

// Whether the part ends before what the walk has come to: at the piece's end, or if the next division point lies on
// this side of it. (The line leaves an exit edge from its right to its left end. An edge both of whose ends are not as
// far as the point is before it, which few need to be asked exactly.) Each walk has one place that asks, since its text
// is compiled as often as it stands; not in a loop's condition, which costs a GPU registers (bench/NOTES.md).
static uint end_of_part(const private Walk* w, Mesh mesh, uint event) {
  if (event == WALK_HIT && w->hit == w->b) return WALK_END;
  if (event == WALK_FAILED || w->k + 1u >= w->parts) return event;
  if (event == WALK_HIT) return after_next_division(w, vertex_at(mesh.points, w->hit)) ? WALK_END : event;
  const bool ends = (w->at_left >= w->until || w->at_right >= w->until) &&
                    gcdt_orient2d_division(unfolded(w->point_right), unfolded(w->point_left), line_begin(w->line),
                                           line_end(w->line), w->k + 1u, w->parts) > 0;
  return ends ? WALK_END : event;
}

// The exit edge is opposite corner k of the face, whose rotated corners are c = (third, right, left), and whose sides
// are `sides`.
static uint come_to_first_edge(private Walk* w, Mesh mesh, uint k, uint4 c, uint4 sides, int third_side) {
  w->third_side = third_side;
  w->code = element(sides, k);
  w->point_right = folded_vertex(mesh.points, mesh.n, c.y);
  w->point_left = folded_vertex(mesh.points, mesh.n, c.z);
  w->at_right = way_along(w, unfolded(w->point_right));
  w->at_left = way_along(w, unfolded(w->point_left));
  return WALK_CROSS;
}

// Of the signs of three corners that of corner k.
static inline int sign_at(int s0, int s1, int s2, uint k) { return k == 0u ? s0 : k == 1u ? s1 : s2; }

// The face holds the walk's point, moved a little towards b. Signs of the corners tell all:
//   no corner on the line        the edge from a right to a left corner is the exit
//   one: right, left after it    that corner lies behind, the edge opposite it is the exit
//   one: left, right after it    that corner lies ahead
//   two                          the walk runs along their edge, in the direction that has the third corner on
//                                the side where it is
static uint look_ahead_in_face(private Walk* w, Mesh mesh) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(w->face)], sides = mesh.face_data[GCDT_SIDES(w->face)];
  const int s0 = side_of(w, mesh, c.x), s1 = side_of(w, mesh, c.y), s2 = side_of(w, mesh, c.z);
  const int zeros = (s0 == 0) + (s1 == 0) + (s2 == 0);
  if (zeros == 3) return WALK_FAILED;
  // The corner that decides: across from the exit; the one on the line; the one that is not.
  uint k;
  if (zeros == 0)
    k = (s1 < 0 && s2 > 0) ? 0u : (s2 < 0 && s0 > 0) ? 1u : 2u;
  else
    k = (s0 == 0) == (zeros == 1) ? 0u : (s1 == 0) == (zeros == 1) ? 1u : 2u;
  const uint4 r = rotate_to(c, k);
  const int behind = sign_at(s0, s1, s2, k), right = sign_at(s0, s1, s2, next_corner(k)),
            left = sign_at(s0, s1, s2, previous_corner(k));
  // Each call stands once, since its text is compiled as often as it stands.
  if (zeros < 2 && right < 0 && left > 0) return come_to_first_edge(w, mesh, k, r, sides, behind);
  if (zeros == 0 || (zeros == 1 && !(right > 0 && left < 0))) return WALK_FAILED;
  return come_to_vertex(w, zeros == 1 ? r.x : behind > 0 ? r.z : r.y, zeros == 1 ? GCDT_NONE : element(sides, k));
}

// Starts part k of `parts` of the piece a-b in `face`, which holds division point k, moved a little towards b, or is
// GCDT_NONE.
static uint walk_begin(private Walk* w, Mesh mesh, uint face, uint2 ends, int4 line, uint k, uint parts) {
  w->b = ends.y;
  w->line = line;
  w->k = k;
  w->parts = parts;
  w->face = face;
  w->until = (i32)((i64)way_along(w, line_end(line)) * (i64)(k + 1u) / (i64)parts);
  return face == GCDT_NONE ? WALK_FAILED : look_ahead_in_face(w, mesh);
}

// What lies behind the exit edge. Loaded before anything is done at the edge, so that a GPU waits for all at once.
static inline Gate look_behind(const private Walk* w, Mesh mesh, Gates gates) {
  return gates.made ? gate_made(gates, mesh, w->code ^ 1u) : gate_of_side(mesh, w->code ^ 1u);
}

// Crosses the exit edge. In the face behind it, (apex, left, right) counter-clockwise, the sign of the apex alone
// decides: left of the line, the exit is right -> apex; right of it, apex -> left.
static uint walk_cross(private Walk* w, Mesh mesh, Gate gate) {
  if (gate.after == GCDT_NONE) return WALK_FAILED;
  const Vertex apex = unfolded(gate.apex);
  w->third_side = side_of_point(w, apex);
  if (w->third_side == 0) {
    const uint ref = mesh.edge_faces[w->code ^ 1u];
    w->face = GCDT_REF_FACE(ref);
    return come_to_vertex(w, face_corner(mesh, w->face, GCDT_REF_CORNER(ref)), GCDT_NONE);
  }
  const i32 at = way_along(w, apex);
  if (w->third_side > 0) {
    w->point_left = gate.apex;
    w->at_left = at;
    w->code = gate.after;
  } else {
    w->point_right = gate.apex;
    w->at_right = at;
    w->code = gate.before;
  }
  return WALK_CROSS;
}

// Goes on from the vertex z just hit, a corner of the face: turns counter-clockwise around z to the
// face into which the piece continues, from where the fan says if z has one. Ends: `patience` faces at most; the faces
// around z cover all directions, and exactly one direction is right. Fails if it is not found among them.
static uint walk_turn(private Walk* w, Walked walked, uint z, private uint* steps) {
  const Mesh mesh = walked.mesh;
  if (has_fan(walked.fans, z))
    w->face = face_of_fan(walked.fans, mesh.points, mesh.n, z, vertex_at(mesh.points, z), line_end(w->line), steps);
  for (uint step = 0; step < walked.patience; ++step) {
    ++*steps;
    const uint4 c = mesh.face_data[GCDT_CORNERS(w->face)], sides = mesh.face_data[GCDT_SIDES(w->face)];
    const uint k = c.x == z ? 0u : c.y == z ? 1u : 2u;
    const uint4 r = rotate_to(c, k);
    const int right = side_of(w, mesh, r.y), left = side_of(w, mesh, r.z);
    if (right < 0 && left > 0) return come_to_first_edge(w, mesh, k, r, sides, 0);
    if ((right == 0 && left > 0) || (right < 0 && left == 0))
      return come_to_vertex(w, right == 0 ? r.y : r.z,
                            element(sides, right == 0 ? previous_corner(k) : next_corner(k)));
    const uint ref = mesh.edge_faces[element(sides, next_corner(k)) ^ 1u];
    if (ref == GCDT_NONE) return WALK_FAILED;
    w->face = GCDT_REF_FACE(ref);
  }
  return WALK_FAILED;
}

#endif
