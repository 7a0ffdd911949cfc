// SPDX-License-Identifier: Apache-2.0
// The faces that a vertex would destroy, and the way to a point. OpenCL C only.
//
// The cavity of a point x: the face or faces that hold it, and what is joined to them over unconstrained edges by faces
// whose circles have x strictly inside. Lemmas (proofs in docs/refinement.md):
//   R1  Each face of a cavity is seen from x through the edge by which it was reached. So the cavity's faces, joined by
//       the edges between them, form a tree, and a tour around that tree needs no memory.
//   R2  Insertion of x and Lawson's flips change faces of the cavity alone, but for ties on a circle.
#ifndef GCDT_CAVITY_H
#define GCDT_CAVITY_H

#include "common/mesh.h"
#include "refine/refine.h"

static inline bool is_constrained(volatile global const uint* marks, uint code) {
  return (marks[GCDT_SIDE_EDGE(code)] & GCDT_MARK_CONSTRAINED) != 0u;
}

static inline Vertex corner_vertex(Mesh mesh, uint4 corners, uint k) {
  return load_vertex(mesh.points, mesh.n, element(corners, k));
}

static inline bool in_circle_of(Mesh mesh, uint face, Vertex x) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
  return gcdt_incircle(load_vertex(mesh.points, mesh.n, c.x), load_vertex(mesh.points, mesh.n, c.y),
                       load_vertex(mesh.points, mesh.n, c.z), x) > 0;
}

// A tour around the tree of a cavity. At each step it looks over side `corner` of `face`: if the cavity goes on there,
// it crosses, and looks over the next side there; else it stays, and looks over the next side here. These steps are a
// permutation of the sides of the cavity's faces, and go through all of them (R1): each side is looked over once.
typedef struct Tour {
  Mesh mesh;
  volatile global const uint* marks;
  Vertex x;
  uint face, corner, root;
  uint4 corners;
  uint code;  // of the side looked over
  bool constrained;
  uint steps;
} Tour;

static inline void look(Tour* tour) {
  tour->corners = tour->mesh.face_data[GCDT_CORNERS(tour->face)];
  tour->code = element(tour->mesh.face_data[GCDT_SIDES(tour->face)], tour->corner);
  tour->constrained = is_constrained(tour->marks, tour->code);
}

// `root` is a face of the cavity of x.
static inline Tour begin_tour(Mesh mesh, volatile global const uint* marks, uint root, Vertex x) {
  Tour tour;
  tour.mesh = mesh;
  tour.marks = marks;
  tour.x = x;
  tour.face = tour.root = root;
  tour.corner = 0u;
  tour.steps = 3u * gcdt_forest_faces(mesh.n, 1u);
  look(&tour);
  return tour;
}

// To the next side; false when all have been looked over. Ends: the steps are a permutation; `steps` stops a mesh that
// is wrong.
static inline bool go_on(Tour* tour) {
  const uint far = tour->constrained ? GCDT_NONE : tour->mesh.edge_faces[tour->code ^ 1u];
  if (far != GCDT_NONE && in_circle_of(tour->mesh, GCDT_REF_FACE(far), tour->x)) {
    tour->face = GCDT_REF_FACE(far);
    tour->corner = next_corner(GCDT_REF_CORNER(far));
  } else {
    tour->corner = next_corner(tour->corner);
  }
  if ((tour->face == tour->root && tour->corner == 0u) || --tour->steps == 0u) return false;
  look(tour);
  return true;
}

// ---- Walks --------------------------------------------------------------------------------------------

#define GCDT_AT_NOTHING 0u  // a vertex
#define GCDT_AT_FACE 1u     // inside a face
#define GCDT_AT_EDGE 2u     // inside an unconstrained edge
#define GCDT_AT_SUBSEGMENT 3u
#define GCDT_AT_FAILED 4u

typedef struct Arrival {
  uint kind;
  uint face;    // where the target is; of an edge one of its two
  uint corner;  // across from the edge or subsegment, which is a side of `face`
} Arrival;

// Has the side across from corner k lesser ends, in (x, y), than the one across from corner j?
static inline bool has_lesser_ends(Vertex* v, uint k, uint j) {
  const u64 a = gcdt_tie_key(v[next_corner(k)]), b = gcdt_tie_key(v[previous_corner(k)]),
            c = gcdt_tie_key(v[next_corner(j)]), d = gcdt_tie_key(v[previous_corner(j)]);
  const u64 k_least = min(a, b), j_least = min(c, d);
  return k_least < j_least || (k_least == j_least && max(a, b) < max(c, d));
}

// From a face of finite corners towards a target, over unconstrained sides that have it beyond them; of two over the
// one with lesser ends. Where all sides that have it beyond them are subsegments, one of these stops it. Ends: the
// target's power to the faces' circles falls with each step (docs/refinement.md, R3); `steps` stops a mesh that is
// wrong.
static Arrival walk_to(Mesh mesh, volatile global const uint* marks, uint face, Vertex target) {
  Arrival at;
  for (uint steps = gcdt_forest_faces(mesh.n, 1u); steps > 0u; --steps) {
    const uint4 c = mesh.face_data[GCDT_CORNERS(face)], s = mesh.face_data[GCDT_SIDES(face)];
    Vertex v[3];
    for (uint k = 0; k < 3u; ++k) v[k] = corner_vertex(mesh, c, k);
    uint free = 3u, stop = 3u, on = 3u, zeros = 0u;
    for (uint k = 0; k < 3u; ++k) {
      const int side = gcdt_orient2d_target(v[next_corner(k)], v[previous_corner(k)], target);
      if (side == 0) {
        ++zeros;
        on = k;
      } else if (side < 0) {
        if (is_constrained(marks, element(s, k)))
          stop = stop == 3u || has_lesser_ends(v, k, stop) ? k : stop;
        else
          free = free == 3u || has_lesser_ends(v, k, free) ? k : free;
      }
    }
    at.face = face;
    if (free == 3u) {
      at.corner = stop != 3u ? stop : on;
      at.kind = stop != 3u                              ? GCDT_AT_SUBSEGMENT
                : zeros == 2u                           ? GCDT_AT_NOTHING
                : zeros == 0u                           ? GCDT_AT_FACE
                : is_constrained(marks, element(s, on)) ? GCDT_AT_SUBSEGMENT
                                                        : GCDT_AT_EDGE;
      return at;
    }
    face = GCDT_REF_FACE(mesh.edge_faces[element(s, free) ^ 1u]);
  }
  at.kind = GCDT_AT_FAILED;
  at.face = face;
  at.corner = 0u;
  return at;
}

#endif
