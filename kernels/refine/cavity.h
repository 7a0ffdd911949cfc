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

// Above 0 if x is strictly inside the face's circle, 0 if on it.
static inline int side_of_circle(Mesh mesh, uint face, Vertex x) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
  return gcdt_incircle(load_vertex(mesh.points, mesh.n, c.x), load_vertex(mesh.points, mesh.n, c.y),
                       load_vertex(mesh.points, mesh.n, c.z), x);
}

// A tour around the tree of a cavity, depth first. At each step it looks over side `corner` of `face`: if the cavity
// goes on there, it crosses, and looks over the other two sides there; else it goes on to the next side here. When a
// face has none left it goes back over the side by which it came. So each face is entered once, and each side but those
// is looked over once (R1).
//
// How many sides are left in the faces above stands in `left_above`, two bits each, for the last 32. Where the tree is
// deeper, the tour goes on from there without: it looks over the side by which it came as over the others, and crosses
// it. These steps are a permutation of all sides of the cavity's faces, which leads back to the first one.
typedef struct Tour {
  Mesh mesh;
  volatile global const uint* marks;
  Vertex x;
  uint face, corner, root, first;
  uint4 corners, sides;
  uint code;  // of the side looked over
  bool constrained;
  bool entered;  // the face is looked at for the first time
  bool tied;     // x is on the circle of a face that was not entered
  bool forgets;
  uint left, depth, known;
  u64 left_above;
  uint steps;
} Tour;

#define GCDT_TOUR_KNOWN 32u

static inline void look(Tour* tour) {
  tour->corners = tour->mesh.face_data[GCDT_CORNERS(tour->face)];
  tour->code = element(tour->sides, tour->corner);
  tour->constrained = is_constrained(tour->marks, tour->code);
}

static inline void enter(Tour* tour, uint face, uint corner) {
  tour->face = face;
  tour->corner = corner;
  tour->sides = tour->mesh.face_data[GCDT_SIDES(face)];
}

// `root` is a face of the cavity of x, `first` the corner whose side is looked over first. All that follows is the same
// whatever corners the faces begin with.
static inline Tour begin_tour_at(Mesh mesh, volatile global const uint* marks, uint root, uint first, Vertex x) {
  Tour tour;
  tour.mesh = mesh;
  tour.marks = marks;
  tour.x = x;
  tour.root = root;
  tour.first = first;
  tour.entered = true;
  tour.tied = tour.forgets = false;
  tour.left = 3u;
  tour.depth = tour.known = 0u;
  tour.left_above = 0u;
  tour.steps = 6u * gcdt_forest_faces(mesh.n, 1u);
  enter(&tour, root, first);
  look(&tour);
  return tour;
}

static inline Tour begin_tour(Mesh mesh, volatile global const uint* marks, uint root, Vertex x) {
  return begin_tour_at(mesh, marks, root, 0u, x);
}

// The same from the corner that is the least in (x, y): a tour that does not depend on where the face begins.
static inline Tour begin_ordered_tour(Mesh mesh, volatile global const uint* marks, uint root, Vertex x) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(root)];
  const u64 p = gcdt_tie_key(corner_vertex(mesh, c, 0u)), q = gcdt_tie_key(corner_vertex(mesh, c, 1u)),
            r = gcdt_tie_key(corner_vertex(mesh, c, 2u));
  return begin_tour_at(mesh, marks, root, p < q ? (p < r ? 0u : 2u) : (q < r ? 1u : 2u), x);
}

// Back over the side by which the tour came, which is the one after those that it looked over.
static inline void go_back(Tour* tour) {
  const uint above = tour->mesh.edge_faces[element(tour->sides, tour->corner) ^ 1u];
  enter(tour, GCDT_REF_FACE(above), next_corner(GCDT_REF_CORNER(above)));
  tour->forgets = tour->known == 0u;
  tour->left = (uint)(tour->left_above & 3u);
  tour->left_above >>= 2;
  --tour->depth;
  if (tour->known > 0u) --tour->known;
}

// Does the tour, which has forgotten by which sides it came, go back over its side? It does if x, which sees a face
// through the side by which it is reached (R1), is beyond it. (Only the root's sides have x on them.)
static inline bool leads_back(const Tour* tour, uint face) {
  return face == tour->root ||
         gcdt_orient2d(corner_vertex(tour->mesh, tour->corners, next_corner(tour->corner)),
                       corner_vertex(tour->mesh, tour->corners, previous_corner(tour->corner)), tour->x) < 0;
}

// To the next side; false when all have been looked over. Ends: see above; `steps` stops a mesh that is wrong.
static inline bool go_on(Tour* tour) {
  const uint far = tour->constrained ? GCDT_NONE : tour->mesh.edge_faces[tour->code ^ 1u];
  const int side = far == GCDT_NONE ? -1 : side_of_circle(tour->mesh, GCDT_REF_FACE(far), tour->x);
  tour->entered = side > 0 && !(tour->forgets && leads_back(tour, GCDT_REF_FACE(far)));
  tour->tied |= side == 0;
  if (side > 0) {
    enter(tour, GCDT_REF_FACE(far), next_corner(GCDT_REF_CORNER(far)));
    tour->left_above = (tour->left_above << 2) | (tour->left - 1u);
    tour->known = min(tour->known + 1u, GCDT_TOUR_KNOWN);
    ++tour->depth;
    tour->left = 2u;
  } else {
    tour->corner = next_corner(tour->corner);
    --tour->left;
  }
  while (!tour->forgets && tour->left == 0u) {
    if (tour->depth == 0u || --tour->steps == 0u) return false;
    go_back(tour);
  }
  if (--tour->steps == 0u || (tour->forgets && tour->face == tour->root && tour->corner == tour->first)) return false;
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
