// SPDX-License-Identifier: Apache-2.0
// The history tree of one level (paper, section 5, figure 3) and the walk in its top layer.
//
// Top layer: the mesh of the levels before, frozen before the level's first split. Below each of its
// faces hangs a tree of splits. A split by vertex m makes a node in m's own record; the triangle's
// slot is used again by its first child (kernels/insert/insert.h), and each child keeps m as corner 0, so
// the corners of a node can be carried along while descending and are not stored.
//
//   face split by m, corners p            edge split by m on the edge opposite corner a
//                p0                       two nodes, one for each side; with (a, b, c) = the corners
//               /|\                       from a on:        a
//              / | \                                       /|\      child 0 = (m, a, b)
//             /  m  \                                     / | \     child 1 = (m, c, a)
//            / /   \ \      child k =                    b--m--c
//          p1---------p2    (m, p[k+1], p[k+2])
//
// Reference to a node or leaf: (number << 2) | kind.
#ifndef GCDT_HISTORY_H
#define GCDT_HISTORY_H

#include "common/levels.h"
#include "common/mesh.h"
#include "common/search.h"

#define HISTORY_LEAF 0u   // number = face
#define HISTORY_FACE 1u   // number = vertex: children next[0], next[1], next[2]
#define HISTORY_SIDE0 2u  // number = vertex: children next[0], next[1]
#define HISTORY_SIDE1 3u  // number = vertex: children next[2], next[3]
#define HISTORY_REF(number, kind) (((number) << 2) | (kind))

// shape[i], i = vertex - first vertex of the level:
//   31 ................ 8   7 6   5 4     3 2     1 0
//   round of its insertion  -     corner  corner  kind: 0 not inserted, 1 face split, 2 edge split
//                                 a of    a of
//                                 side 1  side 0
#define SHAPE_FACE 1u
#define SHAPE_EDGE 2u

typedef struct History {
  u32 begin, end;            // the level's vertices
  global uint4* top;         // for each face of the top layer its corners (w: reference to node or leaf), then
                             // the faces across from them, or GCDT_NONE
  global uint* vertex_face;  // for each vertex of the top layer: one of its faces
  global uint4* nodes;       // per vertex of the level: children; before insertion: (location, depth, -, -)
  global uint* shape;        // per vertex of the level
} History;

#define GCDT_HISTORY_PARAMETERS \
  uint begin, uint end, global uint4 *top, global uint *vertex_face, global uint4 *nodes, global uint *shape

static inline History make_history(GCDT_HISTORY_PARAMETERS) {
  const History h = {
      .begin = begin, .end = end, .top = top, .vertex_face = vertex_face, .nodes = nodes, .shape = shape};
  return h;
}

// A point to be located: the k-th of `parts` division points of segment pq, moved infinitely little
// towards q ("germ"); k = 0 and parts = 1 with p = q is the plain vertex p.
typedef struct Germ {
  Vertex p, q;
  u32 k, parts;
} Germ;

// Sign of the germ's side of the line a -> b: > 0 left. If the division point lies on the line, q's
// side decides, since the point moves towards q; 0 only if the whole segment lies on the line (or the
// plain vertex does).
static inline int germ_side(Germ g, Vertex a, Vertex b) {
  const i64 p = gcdt_orient2d_from(g.p, a, b);
  if (g.k == 0u && p != 0) return gcdt_sign64(p);
  const i64 q = gcdt_orient2d_from(g.q, a, b);
  const int s = gcdt_division_sign(p, q, g.k, g.parts);
  return s != 0 ? s : gcdt_sign64(q);
}

// A grid point near the germ. Rounding does not matter. |difference| * k < 2^31 * 2^31.
static inline Vertex near_germ(Germ g) {
  if (g.k == 0u) return g.p;
  return gcdt_finite_vertex(g.p.x + (g.q.x - g.p.x) * (i64)g.k / (i64)g.parts,
                            g.p.y + (g.q.y - g.p.y) * (i64)g.k / (i64)g.parts);
}

// Straight walk in the top layer from coarser vertex `from_vertex`, or, if that is GCDT_NONE, from face `root`, to a
// face that holds the germ in its closure: it turns around the vertex in one direction, then goes through the faces
// that the segment to the germ crosses. So it visits no face twice in any triangulation (L5); `limit` faces at most,
// else GCDT_NONE. `zero` gets the corner whose opposite edge holds a plain vertex, or 3. A launch lasts as long as its
// longest walk, and at the hull a face of the vertex can reach far away: so where two edges lead on, it takes the one
// that the segment crosses.
static inline uint walk_top_layer(global const int2* points, uint n, History h, Germ g, uint from_vertex, uint root,
                                  uint limit, private uint* steps, private uint* zero) {
  uint t = from_vertex == GCDT_NONE ? root : h.vertex_face[from_vertex];
  uint4 c = h.top[GCDT_CORNERS(t)], across = h.top[GCDT_SIDES(t)];
  uint k = c.y == from_vertex ? 1u : c.z == from_vertex ? 2u : 0u;
  c = rotate_to(c, k);
  Vertex x = load_vertex(points, n, c.x), y = load_vertex(points, n, c.y), z = load_vertex(points, n, c.z);
  const Vertex origin = x;
  // k: corner x; but in the first face, the walk came in across from it
  for (uint step = 0; step < limit; ++step) {
    const int sy = germ_side(g, z, x), sz = germ_side(g, x, y);
    const bool inside = sy >= 0 && sz >= 0, beyond_both = sy < 0 && sz < 0;
    // Of the first face's third edge, or which of two edges the segment crosses: one call, since its text is long.
    int third = 1;
    if (beyond_both || (inside && step == 0u)) third = germ_side(g, beyond_both ? origin : y, beyond_both ? x : z);
    ++*steps;
    if (inside && third >= 0) {
      *zero = third == 0 ? k : sy == 0 ? next_corner(k) : sz == 0 ? previous_corner(k) : 3u;
      return t;
    }
    // The edge that the walk leaves through becomes y-z, seen from behind.
    const uint from = t;
    if (sy < 0 && (sz >= 0 || third < 0)) {
      t = element(across, next_corner(k));
      y = x;
    } else if (sz < 0) {
      t = element(across, previous_corner(k));
      z = x;
    } else {
      t = element(across, k);
      const Vertex swap = y;
      y = z;
      z = swap;
    }
    if (t == GCDT_NONE) return t;
    c = h.top[GCDT_CORNERS(t)];
    across = h.top[GCDT_SIDES(t)];
    k = across.x == from ? 0u : across.y == from ? 1u : 2u;
    x = load_vertex(points, n, element(c, k));
  }
  return GCDT_NONE;
}

// A coarser vertex of vertex a's triangulation close to a grid point, or GCDT_NONE if there is none: of the point's
// neighbours on the curve the nearer. Where the point is a, `by_rank` finds these without a search. They may be far: a
// vertex or a narrow strip of the domain beyond a border of large cells has few neighbours in its own cell, hundreds of
// edges apart, and many just across the border. So `around` looks beyond the four sides of the largest cell that holds
// the point and not the first vertex found, too.
static inline uint coarse_vertex_at(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint n, uint a,
                                    int2 at, bool by_rank, bool around) {
  if (level == 0u) return GCDT_NONE;
  const uint2 units = coarse_units(levels, level, points, n, a);
  if (units.x == units.y) return GCDT_NONE;
  uint best = GCDT_NONE;
  int2 cell = at;
  int size = 0;
  // Where to look from: a bit for the point itself, then one for each side beyond which there is grid. The loop's
  // length is data: PoCL 5 puts a barrier into a loop whose length is the same for all work-items, also where only some
  // of them run it, if the kernel has barriers at all.
  for (uint places = 16u; places != 0u;) {  // ends: the point is taken once, and then a side less each time
    const uint place = 31u - clz(places);
    places ^= 1u << place;
    const int x = place == 0u ? cell.x - 1 : place == 1u ? cell.x + size : at.x;
    const int y = place == 2u ? cell.y - 1 : place == 3u ? cell.y + size : at.y;
    const int2 from = (int2)(x, y);
    const uint unit = by_rank ? max(gcdt_rank_of_vertex(levels, a) / levels->stride[level - 1u], units.x)
                              : last_on_curve(levels, level - 1u, points, units.x, units.y, from);
    const uint v = nearer_coarse_vertex(levels, level, points, units.y, unit, from);
    if (place == 4u || distance_squared(at, points[v]) < distance_squared(at, points[best])) best = v;
    if (place == 4u && around) {
      const uint differing = (uint)((at.x ^ points[v].x) | (at.y ^ points[v].y));
      if (differing != 0u) {
        size = 1 << (31u - clz(differing));
        cell = (int2)(at.x & ~(size - 1), at.y & ~(size - 1));
        places = (cell.x > 0 ? 1u : 0u) | ((uint)cell.x + (uint)size <= 0x7FFFFFFFu ? 2u : 0u) |
                 (cell.y > 0 ? 4u : 0u) | ((uint)cell.y + (uint)size <= 0x7FFFFFFFu ? 8u : 0u);
      }
    }
  }
  return best;
}

// Steps that nearly all walks do with.
#define SHORT_WALK 24u

// A face of the top layer that holds the germ, of vertex a's triangulation, in its closure, or GCDT_NONE; the germ's
// place is a if `at_a`. A walk that gets long is begun again from a better vertex, since a launch lasts as long as its
// longest walk; one that passes `limit` faces is given up.
static uint find_in_top_layer(GCDT_LEVELS_POINTER levels, uint level, Mesh mesh, History h, Germ g, uint a, bool at_a,
                              uint limit, private uint* steps, private uint* zero) {
  const uint root = root_of(mesh.points, mesh.n, a), faces = min(limit, gcdt_forest_faces(h.begin, mesh.roots));
  const Vertex goal = near_germ(g);
  const int2 at = (int2)((int)goal.x, (int)goal.y);
  for (bool again = false;; again = true) {  // twice at most: its text is compiled once
    const uint from = at_a && !again && a < h.begin
                          ? a
                          : coarse_vertex_at(levels, level, mesh.points, mesh.n, a, at, at_a && !again, again);
    const uint top =
        walk_top_layer(mesh.points, mesh.n, h, g, from, root, again ? faces : min(faces, SHORT_WALK), steps, zero);
    if (top != GCDT_NONE || from == GCDT_NONE || again) return top;
  }
}

// From a face of the top layer that holds the germ down to the leaf that does: a face of the mesh as it
// is after the level's last split and before any flip. Ends: each step goes one node deeper.
static inline uint descend_history(global const int2* points, uint n, History h, Germ g, uint top,
                                   private uint* steps) {
  uint4 c = h.top[GCDT_CORNERS(top)];
  uint ref = c.w;
  while ((ref & 3u) != HISTORY_LEAF) {
    const uint m = ref >> 2, kind = ref & 3u;
    const uint4 next = h.nodes[m - h.begin];
    const Vertex vm = vertex_at(points, m), x = load_vertex(points, n, c.x), y = load_vertex(points, n, c.y),
                 z = load_vertex(points, n, c.z);
    const uint a = kind == HISTORY_FACE ? 0u : (h.shape[m - h.begin] >> (2u + 2u * (kind - HISTORY_SIDE0))) & 3u;
    ++*steps;
    // Sides of the lines from m to the corners, of an edge's only to a. (The loop's length is data, see above.)
    int s0 = 0, s1 = 0, s = 0;
#pragma unroll 1
    for (uint i = a; i < (kind == HISTORY_FACE ? 3u : a + 1u); ++i) {
      s = germ_side(g, vm, i == 0u ? x : i == 1u ? y : z);
      s0 = i == 0u ? s : s0;
      s1 = i == 1u ? s : s1;
    }
    // The germ lies in child (m, p[j], p[j+1]): in a face left of m -> p[j] and not left of m -> p[j+1]; along a spoke
    // either child of it does.
    uint child, j;
    if (kind == HISTORY_FACE) {
      child = (s1 >= 0 && s < 0) ? 0u : (s >= 0 && s0 < 0) ? 1u : 2u;
      j = next_corner(child);
    } else {
      child = 2u * (kind - HISTORY_SIDE0) + (s < 0 ? 1u : 0u);
      j = s < 0 ? previous_corner(a) : a;
    }
    const uint4 r = rotate_to(c, j);
    c = (uint4)(m, r.x, r.y, 0u);
    ref = child == 0u ? next.x : child == 1u ? next.y : child == 2u ? next.z : next.w;
  }
  return ref >> 2;
}

#endif
