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

// Of a side that is not crossed, and whose edge a chain is known to run along (constrain.cl).
#define NEAR_CHAIN (GCDT_NONE - 1u)

#define SAME_PLACE 0
#define FIRST_NEARER 1
#define SECOND_NEARER 2
#define PIECES_CROSS 3

// Pieces 1 and 2 cross the same edge, or cut the same corner; which is met first from u? Pieces that
// do not cross lie on one side of each other's line, so signs of orient2d of vertices decide; a shared
// end gives one zero and the other sign decides.
static int compare_pieces(Vertex a1, Vertex b1, Vertex a2, Vertex b2, Vertex u) {
  int s = gcdt_sign64(gcdt_orient2d(a1, b1, u));
  int x = s * gcdt_sign64(gcdt_orient2d(a1, b1, a2)), y = s * gcdt_sign64(gcdt_orient2d(a1, b1, b2));
  if (x == 0 && y == 0) return SAME_PLACE;
  if (x >= 0 && y >= 0) return SECOND_NEARER;
  if (x <= 0 && y <= 0) return FIRST_NEARER;
  s = gcdt_sign64(gcdt_orient2d(a2, b2, u));
  x = s * gcdt_sign64(gcdt_orient2d(a2, b2, a1));
  y = s * gcdt_sign64(gcdt_orient2d(a2, b2, b1));
  if (x >= 0 && y >= 0) return FIRST_NEARER;
  if (x <= 0 && y <= 0) return SECOND_NEARER;
  return PIECES_CROSS;
}

// Which is met first from u: `current`, along `line`, or the walk's own piece? Crossing ones set the failure bit.
static inline int compare_with_walk(int4 line, const private Walk* w, Vertex u, volatile global Counters* counters) {
  const int order = compare_pieces(line_begin(line), line_end(line), w->va, w->vb, u);
  if (order == PIECES_CROSS) atomic_or(&counters->failed, GCDT_FAILED_CROSSING);
  return order;
}

static inline bool is_nearer(uint current, int4 line, uint c, const private Walk* w, Vertex u,
                             volatile global Counters* counters) {
  if (current == c) return false;
  if (current == GCDT_NONE) return true;
  const int order = compare_with_walk(line, w, u, counters);
  return order == SAME_PLACE ? c < current : order == SECOND_NEARER;
}

// At the edge that the walk crosses: makes the words of its ends, which were `at_left` and `at_right`, the pieces
// nearest to these, of themselves and c; equal places go to the smaller number. A total order if no pieces cross, so
// the order of work-items cannot matter. Both exchanges are asked for before either is waited for. Ends: a word changes
// only to nearer pieces, so each exchange that fails does so for another of finitely many, and a word that has become
// c or is nearer stays as it is.
static void reduce_near(volatile global uint* left, uint at_left, volatile global uint* right, uint at_right, uint c,
                        const private Walk* w, global const int4* lines, volatile global Counters* counters) {
  for (;;) {
    const int4 line_left = lines[at_left == GCDT_NONE ? c : at_left],
               line_right = lines[at_right == GCDT_NONE ? c : at_right];
    const bool nearer_left = is_nearer(at_left, line_left, c, w, w->point_left, counters),
               nearer_right = is_nearer(at_right, line_right, c, w, w->point_right, counters);
    uint seen_left = at_left, seen_right = at_right;
    if (nearer_left) seen_left = atomic_cmpxchg(left, at_left, c);
    if (nearer_right) seen_right = atomic_cmpxchg(right, at_right, c);
    if (seen_left == at_left && seen_right == at_right) return;
    at_left = nearer_left && seen_left == at_left ? c : seen_left;
    at_right = nearer_right && seen_right == at_right ? c : seen_right;
  }
}

// The same for the piece that is farthest from u, in one word. Ends as that.
static void reduce_far(volatile global uint* word, uint c, const private Walk* w, Vertex u, global const int4* lines,
                       volatile global Counters* counters) {
  for (uint current = *word; current != c;) {
    if (current != GCDT_NONE) {
      const int order = compare_with_walk(lines[current], w, u, counters);
      if (order == SAME_PLACE ? c > current : order != FIRST_NEARER) return;
    }
    const uint seen = atomic_cmpxchg(word, current, c);
    if (seen == current) return;
    current = seen;
  }
}

// ---- What a walk says at each edge that it crosses --------------------------------------------------
// Record: the walk leaves its face through (right, left); `third` is the corner behind. third_side = 1:
// it came in through (right, third), so `left` is new and the corner at `right` is cut off; -1: the
// mirror image; 0: it started at `third`, both are new and no corner is cut.

static inline bool owns_left(const private Walk* w, volatile global uint* near, uint c) {
  return w->third_side >= 0 && *near_left(near, w->code) == c;
}
static inline bool owns_right(const private Walk* w, volatile global uint* near, uint c) {
  return w->third_side <= 0 && *near_right(near, w->code) == c;
}

// The corner number cut off in the face, valid if third_side != 0.
static inline uint cut_corner(const private Walk* w) {
  return w->third_side > 0 ? next_corner(w->third) : previous_corner(w->third);
}

#endif
