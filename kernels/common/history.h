// SPDX-License-Identifier: Apache-2.0
// The history tree of one level (paper, section 5, figure 3) and the walk in its top layer.
//
// Top layer: the mesh of the levels before, frozen before the level's first split. Below each of its
// faces hangs a tree of splits. A split by vertex m makes a node in m's own record; the triangle's
// slot is used again by its first child (kernels/insert/insert.cl), and each child keeps m as corner 0, so
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

// A coarser vertex close to vertex v: before or after it on the curve; GCDT_NONE if v's triangulation has none.
static inline uint coarse_vertex_near(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint n,
                                      History h, uint v) {
  if (level == 0u) return GCDT_NONE;
  const uint2 units = coarse_units(levels, level, points, n, v);
  if (units.x == units.y) return GCDT_NONE;
  const uint unit = max(gcdt_rank_of_vertex(levels, v) / levels->stride[level - 1u], units.x);
  return nearer_coarse_vertex(levels, level, points, units.y, unit, points[v]);
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
  int sx = germ_side(g, y, z);
  for (uint step = 0; step < limit; ++step) {
    const int sy = germ_side(g, z, x), sz = germ_side(g, x, y);
    ++*steps;
    if (sx >= 0 && sy >= 0 && sz >= 0) {
      *zero = sx == 0 ? k : sy == 0 ? next_corner(k) : sz == 0 ? previous_corner(k) : 3u;
      return t;
    }
    // The edge that the walk leaves through becomes y-z, seen from behind.
    const uint from = t;
    if (sy < 0 && (sz >= 0 || germ_side(g, origin, x) < 0)) {
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
    sx = 1;
    c = h.top[GCDT_CORNERS(t)];
    across = h.top[GCDT_SIDES(t)];
    k = across.x == from ? 0u : across.y == from ? 1u : 2u;
    x = load_vertex(points, n, element(c, k));
  }
  return GCDT_NONE;
}

// The coarser vertex of vertex a's triangulation close to a grid point: of its neighbours on the curve, found by
// bisection, the nearer; GCDT_NONE if there is none.
static inline uint coarse_vertex_at(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint n,
                                    History h, uint a, int2 at) {
  const u64 code = gcdt_morton((uint)at.x, (uint)at.y);
  const uint2 units = coarse_units(levels, level, points, n, a);
  if (units.x == units.y) return GCDT_NONE;
  const uint before = last_on_curve(levels, level - 1u, points, units.x, units.y, code);
  return nearer_coarse_vertex(levels, level, points, units.y, before, at);
}

// The same where the neighbours on the curve may be far: a vertex or a narrow strip of the domain beyond a border of
// large cells has few neighbours in its own cell, hundreds of edges apart, and many just across the border. `near`
// is the nearest on the curve: looks beyond the four sides of the largest cell that holds the point and not `near`.
static uint coarse_vertex_around(GCDT_LEVELS_POINTER levels, uint level, global const int2* points, uint n, History h,
                                 uint a, int2 at, uint near) {
  const int2 p = points[near];
  const uint differing = (uint)((at.x ^ p.x) | (at.y ^ p.y));
  if (differing == 0u) return near;
  const int size = 1 << (31u - clz(differing));
  const int2 cell = (int2)(at.x & ~(size - 1), at.y & ~(size - 1));
  // The sides beyond which there is grid. The loop's length is data: PoCL 5 puts a barrier into a loop whose length is
  // the same for all work-items, also where only some of them run it, if the kernel has barriers at all.
  uint sides = (cell.x > 0 ? 1u : 0u) | ((uint)cell.x + (uint)size <= 0x7FFFFFFFu ? 2u : 0u) | (cell.y > 0 ? 4u : 0u) |
               ((uint)cell.y + (uint)size <= 0x7FFFFFFFu ? 8u : 0u);
  uint best = near;
  while (sides != 0u) {  // ends: a side less each time
    const uint side = 31u - clz(sides);
    sides ^= 1u << side;
    const int x = side == 0u ? cell.x - 1 : side == 1u ? cell.x + size : at.x;
    const int y = side == 2u ? cell.y - 1 : side == 3u ? cell.y + size : at.y;
    const uint v = coarse_vertex_at(levels, level, points, n, h, a, (int2)(x, y));
    if (distance_squared(at, points[v]) < distance_squared(at, points[best])) best = v;
  }
  return best;
}

// Steps that nearly all walks do with.
#define SHORT_WALK 24u

// A face of the top layer that holds the germ, of vertex a's triangulation, in its closure, or GCDT_NONE; `from` is a
// coarser vertex of it near the germ, or GCDT_NONE if there is none. A walk that gets long is begun again from a better
// vertex, since a launch lasts as long as its longest walk; one that passes `limit` faces is given up.
static uint find_in_top_layer(GCDT_LEVELS_POINTER levels, uint level, Mesh mesh, History h, Germ g, uint a, uint from,
                              uint limit, private uint* steps, private uint* zero) {
  const uint root = root_of(mesh.points, mesh.n, a), faces = min(limit, gcdt_forest_faces(h.begin, mesh.roots));
  for (bool again = false;; again = true) {  // twice at most: its text is compiled once
    const uint top =
        walk_top_layer(mesh.points, mesh.n, h, g, from, root, again ? faces : min(faces, SHORT_WALK), steps, zero);
    if (top != GCDT_NONE || from == GCDT_NONE || again) return top;
    const Vertex goal = near_germ(g);
    const int2 at = (int2)((int)goal.x, (int)goal.y);
    const uint near = coarse_vertex_at(levels, level, mesh.points, mesh.n, h, a, at);
    from = coarse_vertex_around(levels, level, mesh.points, mesh.n, h, a, at, near);
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
    const Vertex vm = vertex_at(points, m);
    ++*steps;
    if (kind == HISTORY_FACE) {
      // The germ lies in child k, left of m -> p[k+1] and not left of m -> p[k+2]; along a spoke either
      // child of it does.
      const int s0 = germ_side(g, vm, load_vertex(points, n, c.x));
      const int s1 = germ_side(g, vm, load_vertex(points, n, c.y));
      const int s2 = germ_side(g, vm, load_vertex(points, n, c.z));
      const uint k = (s1 >= 0 && s2 < 0) ? 0u : (s2 >= 0 && s0 < 0) ? 1u : 2u;
      const uint4 r = rotate_to(c, k);
      c = (uint4)(m, r.y, r.z, 0u);
      ref = k == 0u ? next.x : k == 1u ? next.y : next.z;
    } else {
      const uint side = kind - HISTORY_SIDE0;
      const uint4 r = rotate_to(c, (h.shape[m - h.begin] >> (2u + 2u * side)) & 3u);
      const int s = germ_side(g, vm, load_vertex(points, n, r.x));
      if (s >= 0) {
        c = (uint4)(m, r.x, r.y, 0u);
        ref = side == 0u ? next.x : next.z;
      } else {
        c = (uint4)(m, r.z, r.x, 0u);
        ref = side == 0u ? next.y : next.w;
      }
    }
  }
  return ref >> 2;
}

#endif
