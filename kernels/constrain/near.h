// SPDX-License-Identifier: Apache-2.0
// The first constraint met from each end of a crossed edge (kernels/README.md, L6, the edge rule: exact and equal to
// the paper's closest constraints of section 6.4). OpenCL C only.
#ifndef GCDT_NEAR_H
#define GCDT_NEAR_H

#include "constrain/walk.h"

// near(u, v) for edge e = {u, v}: two words per edge. Word 0 belongs to the end that
// side 0 of the edge sees first counter-clockwise (its corner k+1), word 1 to the other. So the word of side code s
// belongs to the right end, seen from s, and the word of s ^ 1 to the left end.
static inline volatile global uint* near_right(volatile global uint* near, uint code) { return near + code; }
static inline volatile global uint* near_left(volatile global uint* near, uint code) { return near + (code ^ 1u); }

// An edge's words, of its left (x) and right (y) end seen from a side.
static inline uint2 seen_from(uint code, uint2 words) { return (code & 1u) ? words : words.yx; }

// Both words of the edge that a side code belongs to, of its left (x) and right (y) end, in one load.
static inline uint2 near_both(volatile global uint* near, uint code) {
  return seen_from(code, ((volatile global uint2*)near)[GCDT_SIDE_EDGE(code)]);
}

// The same once all near words of crossed edges are complete, so that a GPU may keep them in the cache of a unit.
static inline uint2 near_complete(global const uint* near, uint code) {
  return seen_from(code, ((global const uint2*)near)[GCDT_SIDE_EDGE(code)]);
}

// Of a side that is not crossed, and whose edge a chain is known to run along (constrain.cl).
#define NEAR_CHAIN (GCDT_NONE - 1u)

#define SAME_PLACE 0
#define FIRST_NEARER 1
#define SECOND_NEARER 2
#define PIECES_CROSS 3

// Where a piece lies beside the line of the walk's own.
#define PLACE_ON 0
#define PLACE_LEFT 1
#define PLACE_RIGHT -1
#define PLACE_ASTRIDE 2

// The sign bit of `either` is set if that of one of both is.
static inline int place_beside(const private Walk* w, int4 line) {
  const Vertex from = line_begin(w->line), to = line_end(w->line);
  const i64 a = gcdt_orient2d_finite(from, to, line_begin(line)), b = gcdt_orient2d_finite(from, to, line_end(line)),
            either = a | b;
  if (either >= 0) return either == 0 ? PLACE_ON : PLACE_LEFT;
  return a <= 0 && b <= 0 ? PLACE_RIGHT : PLACE_ASTRIDE;
}

// A piece crosses the edge that the walk leaves by; which is met first, it or the walk's own, from the end u of the
// edge on `side` of the walk's line (PLACE_LEFT or PLACE_RIGHT)? Of two pieces that do not cross, one lies on one side
// of the other's line, so signs of orient2d of vertices decide; a shared end gives one zero and the other sign decides.
// The walk's line is asked first, since it is known where u lies. Crossing pieces set the failure bit.
static int compare_with_walk(int4 line, const private Walk* w, int side, Vertex u, volatile global Counters* counters) {
  const int place = place_beside(w, line);
  if (place != PLACE_ASTRIDE) return place == PLACE_ON ? SAME_PLACE : place == side ? FIRST_NEARER : SECOND_NEARER;
  const Vertex p = line_begin(line), q = line_end(line);
  const int s = gcdt_sign64(gcdt_orient2d(p, q, u)),
            x = s * gcdt_sign64(gcdt_orient2d_finite(p, q, line_begin(w->line))),
            y = s * gcdt_sign64(gcdt_orient2d_finite(p, q, line_end(w->line)));
  if (x >= 0 && y >= 0) return SECOND_NEARER;
  if (x <= 0 && y <= 0) return FIRST_NEARER;
  atomic_or(&counters->failed, GCDT_FAILED_CROSSING);
  return PIECES_CROSS;
}

static inline bool is_nearer(uint current, int4 line, uint c, const private Walk* w, int side, Vertex u,
                             volatile global Counters* counters) {
  if (current == c) return false;
  if (current == GCDT_NONE) return true;
  const int order = compare_with_walk(line, w, side, u, counters);
  return order == SAME_PLACE ? c < current : order == SECOND_NEARER;
}

// At the edge that the walk crosses: makes the words of its ends, which were `at_left` and `at_right`, the pieces
// nearest to these, of themselves and c; equal places go to the smaller number. A total order if no pieces cross, so
// the order of work-items cannot matter. Both exchanges are asked for before either is waited for. Ends: a word changes
// only to nearer pieces, so each exchange that fails does so for another of finitely many, and a word that has become
// c or is nearer stays as it is.
static void reduce_near(volatile global uint* near, uint at_left, uint at_right, uint c, const private Walk* w,
                        global const int4* lines, volatile global Counters* counters) {
  for (;;) {
    const int4 line_left = lines[at_left == GCDT_NONE ? c : at_left],
               line_right = lines[at_right == GCDT_NONE ? c : at_right];
    const bool nearer_left = is_nearer(at_left, line_left, c, w, PLACE_LEFT, unfolded(w->point_left), counters),
               nearer_right = is_nearer(at_right, line_right, c, w, PLACE_RIGHT, unfolded(w->point_right), counters);
    uint seen_left = at_left, seen_right = at_right;
    if (nearer_left) seen_left = atomic_cmpxchg(near_left(near, w->code), at_left, c);
    if (nearer_right) seen_right = atomic_cmpxchg(near_right(near, w->code), at_right, c);
    if (seen_left == at_left && seen_right == at_right) return;
    at_left = nearer_left && seen_left == at_left ? c : seen_left;
    at_right = nearer_right && seen_right == at_right ? c : seen_right;
  }
}

// The same for the piece that is farthest from the corner that the walk cuts off, an end of the edge that it leaves by,
// in one word. Ends as that.
static void reduce_far(volatile global uint* word, uint c, const private Walk* w, global const int4* lines,
                       volatile global Counters* counters) {
  const bool cuts_right = w->third_side > 0;
  for (uint current = *word; current != c;) {
    if (current != GCDT_NONE) {
      const int order = compare_with_walk(lines[current], w, cuts_right ? PLACE_RIGHT : PLACE_LEFT,
                                          unfolded(cuts_right ? w->point_right : w->point_left), counters);
      if (order == SAME_PLACE ? c > current : order != FIRST_NEARER) return;
    }
    const uint seen = atomic_cmpxchg(word, current, c);
    if (seen == current) return;
    current = seen;
  }
}

// ---- What a walk says at each edge that it crosses --------------------------------------------------
// Record: the walk leaves its face through (right, left); third is the corner behind. third_side = 1:
// it came in through (right, third), so `left` is new and the corner at `right` is cut off; -1: the
// mirror image; 0: it started at `third`, both are new and no corner is cut.

static inline bool owns_left(const private Walk* w, uint2 near_both, uint c) {
  return w->third_side >= 0 && near_both.x == c;
}
static inline bool owns_right(const private Walk* w, uint2 near_both, uint c) {
  return w->third_side <= 0 && near_both.y == c;
}

// The corner number cut off in the face, valid if third_side != 0.
static inline uint cut_corner(const private Walk* w, Mesh mesh) {
  const uint third = GCDT_REF_CORNER(left_face(w, mesh));
  return w->third_side > 0 ? next_corner(third) : previous_corner(third);
}

#endif
