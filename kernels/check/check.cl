// SPDX-License-Identifier: Apache-2.0
// Proves that a result is the constrained Delaunay triangulation (docs/contract.md, 6), in O(n).
//
// Lemma. If no kernel notes anything, the boundary has exactly one least corner and T = 2n - 2 - h,
// then the triangles cover the convex hull of the n vertices exactly once, edge to edge, and every
// vertex is a corner.
//  1. Every triangle is counter-clockwise, so its corners differ and it has three directed edges, all
//     different. Links join a directed edge to the reversed one and back, so they pair directed edges
//     off; a triangle cannot hold an edge and its reverse, so none is paired with itself. Hence the sum
//     of the triangles' borders is the sum of the unpaired edges, the boundary; and a point on no edge
//     is covered as often as the boundary winds around it.
//  2. A sum of closed curves leaves each vertex as often as it enters. With no fork it is a set of
//     closed chains in which no vertex occurs twice.
//  3. At each boundary vertex the chain goes straight on or turns left by less than a half turn
//     (orient2d > 0, or = 0 and not back; that excludes edges of length zero as well). So a chain's
//     direction only turns left and ends as it began: by k full turns, k >= 1, since with k = 0 it would
//     go straight for ever and not close. Call a direction rising if x, or y with the same x, grows:
//     angles in (-90, 90] degrees; else falling: (90, 270]. Turning by less than 180 it cannot jump over
//     either range. A vertex is a least corner iff a falling edge ends and a rising one begins there,
//     which happens when the direction passes 270 degrees: k times in k turns.
//  4. One least corner over all: one chain, k = 1. From any of its edges on, the direction points to the
//     left of that edge's line for half a turn and back towards it for the other half: the whole chain
//     lies on the left of the line or on it. So the chain is a convex polygon walked once: it winds once
//     around its inside and not around the outside, and by 1. the triangles cover the inside once.
//  5. No vertex v lies inside an edge e: the triangles beside e (one, if e is in the boundary) fill a
//     neighbourhood of v inside the polygon, and a triangle with corner v would cover part of it again.
//     So the triangles meet edge to edge; by Euler V - E + T = 1, and 3T = 2E - h, so T = 2V - 2 - h
//     for V corner vertices. T = 2n - 2 - h then says V = n, and the polygon is the hull of all.
// Further: flagged edges that are all pieces, distinct as the edges of a triangulation are, and as many
// as the pieces, are all pieces. The Delaunay condition of docs/contract.md, 4, is tested edge by edge.
//
// A kernel returns at once if an earlier one noted what it relies on: corners before points are read,
// pairs of boundary edges before they are measured. The host reports the first kind with an offence,
// and atomic_min finds its least number: the report is the same for every schedule.
#include "check/check.h"
#include "common/levels.h"
#include "common/pieces.h"
#include "common/predicates.h"
#include "common/prefetch.h"

// A kind up to `last` was noted by an earlier kernel; the caller notes later kinds only.
GCDT_INLINE int noted(global const CheckReport* report, uint last) {
  for (uint kind = 0; kind <= last; ++kind)
    if (report->first[kind] != GCDT_NONE) return 1;
  return 0;
}

// The corner of triangle u across from its edge from b to a; 3 if it has no such edge. Its corners differ, so at most
// one of the three is it; a branch could not be foretold.
GCDT_INLINE uint corner_across(global const uint* corners, uint u, uint a, uint b) {
  const uint3 c = vload3(u, corners);
  const uint first = (uint)((c.y == b) & (c.z == a)), second = (uint)((c.z == b) & (c.x == a)),
             third = (uint)((c.x == b) & (c.y == a));
  return 3u - 3u * first - 2u * second - third;
}

static void check_corners_of(uint t, uint n, global const int2* points, global const uint* corners,
                             global CheckReport* report) {
  const uint3 c = vload3(t, corners);
  if (max(max(c.x, c.y), c.z) >= n)
    note(report, GCDT_CHECK_CORNER, t);
  else if (gcdt_orient2d_finite(vertex_at(points, c.x), vertex_at(points, c.y), vertex_at(points, c.z)) <= 0)
    note(report, GCDT_CHECK_ORIENT, t);
}

// One work-item per triangle.
// Reads points and corners.
// Writes only notes in report.
// atomic_min decides, in any order the same.
// After this kernel, if nothing is noted, all corners are vertices and all triangles counter-clockwise.
kernel void check_corners(const uint count, const uint n, global const int2* points, global const uint* corners,
                          global CheckReport* report) {
  FOR_EACH(t, count) check_corners_of(t, n, points, corners, report);
}

// Checks the link of half edge h, from a to b, to triangle u < count. Returns the corner of u across
// from the edge, 3 if u does not have it.
GCDT_INLINE uint check_link(uint h, uint u, uint a, uint b, uint flagged, global const uint* corners,
                            global const int* neighbours, global const uchar* constrained, global CheckReport* report) {
  const uint j = corner_across(corners, u, a, b);
  if (j == 3u) {
    note(report, GCDT_CHECK_REVERSED, h);
    return j;
  }
  if (neighbours[3u * u + j] != (int)(h / 3u)) note(report, GCDT_CHECK_BACK, h);
  if (((constrained[u] >> j) & 1u) != flagged) note(report, GCDT_CHECK_FLAG, h);
  return j;
}

// The circle through a triangle's corners: the first, and the ways from there to the others.
typedef struct Circle {
  int2 first;
  Way second, third;
} Circle;

// gcdt_way_finite for points: a Vertex in the Circle would be copied with its padding, and the copy waits for what has
// stored it (a fifth of the kernel's time on CPUs).
GCDT_INLINE Way way_between(int2 a, int2 b) { return gcdt_way((i64)b.x - a.x, (i64)b.y - a.y); }

GCDT_INLINE Circle circle_through(global const int2* points, uint3 c) {
  const int2 first = points[c.x];
  const Circle circle = {
      .first = first, .second = way_between(first, points[c.y]), .third = way_between(first, points[c.z])};
  return circle;
}

GCDT_INLINE u64 tie_key(global const int2* points, uint v) { return gcdt_tie_key(vertex_at(points, v)); }

// Checks the Delaunay condition of docs/contract.md, 4, on half edge h, the diagonal from a to b between its corner p
// and vertex q across. `circle`: that of its triangle. Whichever of its corners p is, q, the third, the second and the
// first corner are an even permutation of a, q, b and p, and an in-circle determinant does not change by one.
GCDT_INLINE void check_delaunay(uint h, global const int2* points, Circle circle, uint p, uint a, uint q, uint b,
                                global CheckReport* report) {
  const int inside = gcdt_incircle_of_ways(way_between(circle.first, points[q]), circle.third, circle.second);
  if (inside > 0)
    note(report, GCDT_CHECK_DELAUNAY, h);
  else if (inside == 0 && min(tie_key(points, p), tie_key(points, q)) < min(tie_key(points, a), tie_key(points, b)))
    note(report, GCDT_CHECK_TIE, h);
}

// Writes first[r] for r = begin .. end - 1. Ends: the range halves; the pieces are run through.
GCDT_APART void find_first_pieces(uint begin, uint end, global const Levels* levels, uint pieces,
                                  global const uint2* ends, global uint* first) {
  uint low = 0, high = pieces;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (gcdt_rank_of_vertex(levels, ends[middle].x) < begin)
      low = middle + 1u;
    else
      high = middle;
  }
  for (uint r = begin; r < end; ++r) {
    while (low < pieces && gcdt_rank_of_vertex(levels, ends[low].x) < r) ++low;
    first[r] = low;
  }
}

#ifdef GCDT_CONTIGUOUS
// Where check_edges finds the pieces of a vertex.
// One work-item per share of the ranks.
// Reads levels and pieces. Writes first[r], r = 0 .. n: the first piece whose lower end has rank r or more.
// A word has one work-item.
// After this kernel the pieces whose lower end has rank r are first[r] up to first[r + 1].
kernel void check_first_pieces(const uint n, global const Levels* levels, const uint pieces, global const uint2* ends,
                               global uint* first) {
  find_first_pieces(share_begin(n + 1u, get_global_id(0), get_global_size(0)),
                    share_begin(n + 1u, get_global_id(0) + 1u, get_global_size(0)), levels, pieces, ends, first);
}
#endif

// Whether there is a piece ab. On CPUs `first` tells where, if there are any; elsewhere it is not read.
GCDT_INLINE bool is_piece(global const Levels* levels, uint pieces, global const uint* first, global const uint2* ends,
                          uint a, uint b) {
  const uint ra = gcdt_rank_of_vertex(levels, a), rb = gcdt_rank_of_vertex(levels, b), lower = min(ra, rb);
#ifdef GCDT_CONTIGUOUS
  if (pieces == 0u) return false;
  const uint low = first[lower], high = first[lower + 1u];
#else
  const uint low = 0, high = pieces;
#endif
  return find_piece_among(levels, low, high, ends, lower, max(ra, rb)) != GCDT_NONE;
}

// What check_edges does with triangle t. Returns how many constrained edges it counts.
static uint check_edges_of(uint t, uint count, global const Levels* levels, global const int2* points,
                           global const uint* corners, global const int* neighbours, global const uchar* constrained,
                           uint pieces, global const uint* first_pieces, global const uint2* ends, global uint* next,
                           global uint* previous, global CheckReport* report) {
  uint constrained_edges = 0;
  uint3 c = vload3(t, corners);
  int3 across = vload3(t, neighbours);
  const Circle circle = circle_through(points, c);
  const uint flags = constrained[t];
  if (flags > 7u) note(report, GCDT_CHECK_FLAG, 3u * t);
  for (uint k = 0; k < 3; ++k, c = c.yzx, across = across.yzx) {
    const uint h = 3u * t + k, flagged = (flags >> k) & 1u;
    const uint p = c.x, a = c.y, b = c.z;
    const int u = across.x;
    if (u < -1 || u >= (int)count) {
      note(report, GCDT_CHECK_NEIGHBOUR, h);
      continue;
    }
    uint j = 3;
    if (u >= 0) {
      j = check_link(h, (uint)u, a, b, flagged, corners, neighbours, constrained, report);
      if (j == 3u || (uint)u < t) continue;
    } else {
      if (atomic_cmpxchg(&next[a], GCDT_NONE, b) != GCDT_NONE) note(report, GCDT_CHECK_FORK, a);
      if (atomic_cmpxchg(&previous[b], GCDT_NONE, a) != GCDT_NONE) note(report, GCDT_CHECK_FORK, b);
    }
    if (flagged) {
      ++constrained_edges;
      if (!is_piece(levels, pieces, first_pieces, ends, a, b)) note(report, GCDT_CHECK_EXTRA, h);
    } else if (u >= 0) {
      check_delaunay(h, points, circle, p, a, corners[3u * (uint)u + j], b, report);
    }
  }
  return constrained_edges;
}

// What triangle t of a share that ends before `end` will ask for of its neighbours.
static inline void prefetch_neighbours(uint t, uint end, global const uint* corners, global const int* neighbours) {
#ifdef GCDT_PREFETCHES
  if (t >= end) return;
  for (uint k = 0; k < 3u; ++k) {
    const uint u = 3u * (uint)neighbours[3u * t + k];
    GCDT_PREFETCH(corners + u);
    GCDT_PREFETCH(neighbours + u);
  }
#else
  (void)t;
  (void)end;
  (void)corners;
  (void)neighbours;
#endif
}

// The same of all `items`.
GCDT_APART uint check_edges_among(Items items, uint count, global const Levels* levels, global const int2* points,
                                  global const uint* corners, global const int* neighbours,
                                  global const uchar* constrained, uint pieces, global const uint* first_pieces,
                                  global const uint2* ends, global uint* next, global uint* previous,
                                  global CheckReport* report) {
  const uint end = count < GCDT_LEAST_PREFETCHED ? 0u : items.y;
  uint constrained_edges = 0;
  FOR_ITEMS(t, items) {
    prefetch_neighbours(t + GCDT_FAR_AHEAD, end, corners, neighbours);
    constrained_edges += check_edges_of(t, count, levels, points, corners, neighbours, constrained, pieces,
                                        first_pieces, ends, next, previous, report);
  }
  return constrained_edges;
}

// One work-item per triangle t.
// Reads levels, points, corners, neighbours, flags and pieces. An edge between two triangles is linked
// from both, but tested and counted by the one with the smaller number only.
// Writes next[a] = b and previous[b] = a for a boundary edge from a to b, notes, and constrained_edges.
// atomic_cmpxchg lets one edge have the word; the vertex is noted if there is another, whichever won.
// atomic_min and atomic_add decide the rest, in any order the same.
// After this kernel, if neither link nor fork is noted, the boundary is a set of chains.
kernel void check_edges(const uint count, global const Levels* levels, global const int2* points,
                        global const uint* corners, global const int* neighbours, global const uchar* constrained,
                        const uint pieces, global const uint* first_pieces, global const uint2* ends, global uint* next,
                        global uint* previous, global CheckReport* report) {
  if (noted(report, GCDT_CHECK_ORIENT)) return;
  const uint constrained_edges = check_edges_among(items_of_this(count), count, levels, points, corners, neighbours,
                                                   constrained, pieces, first_pieces, ends, next, previous, report);
  if (constrained_edges != 0) atomic_add(&report->constrained_edges, constrained_edges);
}

// What check_boundary does with vertex v, which may be inside. Adds 1 to what it counts.
static void check_boundary_at(uint v, global const int2* points, global const uint* next, global const uint* previous,
                              private uint* hull_vertices, private uint* least_corners, global CheckReport* report) {
  const uint before = previous[v], after = next[v];
  if (before == GCDT_NONE && after == GCDT_NONE) return;
  ++*hull_vertices;
  if (before == GCDT_NONE || after == GCDT_NONE) {  // cannot be: see 2. of the lemma
    note(report, GCDT_CHECK_CONVEX, v);
    return;
  }
  const Vertex a = vertex_at(points, before), b = vertex_at(points, v), c = vertex_at(points, after);
  const i64 turn = gcdt_orient2d_finite(a, b, c);
  // The terms of the inner product are below 2^62 each.
  const i64 onward = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
  if (turn < 0 || (turn == 0 && onward <= 0)) note(report, GCDT_CHECK_CONVEX, v);
  if (gcdt_tie_key(b) < gcdt_tie_key(a) && gcdt_tie_key(b) < gcdt_tie_key(c)) ++*least_corners;
}

// One work-item per vertex.
// Reads points and the boundary.
// Writes notes, hull_vertices and least_corners.
// atomic_min and atomic_add decide, in any order the same.
// After this kernel, if nothing is noted, least_corners is the number of turns of the boundary's chains.
kernel void check_boundary(const uint count, global const int2* points, global const uint* next,
                           global const uint* previous, global CheckReport* report) {
  if (noted(report, GCDT_CHECK_FORK)) return;
  uint hull_vertices = 0, least_corners = 0;
  FOR_EACH(v, count) check_boundary_at(v, points, next, previous, &hull_vertices, &least_corners, report);
  if (hull_vertices != 0) atomic_add(&report->hull_vertices, hull_vertices);
  if (least_corners != 0) atomic_add(&report->least_corners, least_corners);
}

// Only if there are no triangles, and at least two vertices; vertices are distinct.
// One work-item per vertex.
// Reads points.
// Writes only notes in report.
// atomic_min decides, in any order the same.
// After this kernel, if nothing is noted, all vertices lie on the line through the first two.
kernel void check_collinear(const uint count, global const int2* points, global CheckReport* report) {
  const Vertex a = vertex_at(points, 0), b = vertex_at(points, 1);
  FOR_EACH(v, count)
  if (gcdt_orient2d_finite(a, b, vertex_at(points, v)) != 0) note(report, GCDT_CHECK_COLLINEAR, v);
}
