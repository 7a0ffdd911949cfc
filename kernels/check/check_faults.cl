// SPDX-License-Identifier: Apache-2.0
// After check.cl has counted wrong: which vertex is no corner, which piece no flagged edge? A program of its own, since
// a call that ends well does not need it.
#include "check/check.h"
#include "common/levels.h"
#include "common/pieces.h"

// One work-item per corner.
// Reads corners.
// Writes used[corners[i]] = 1.
// atomic_xchg: all write the same value.
// After this kernel used[v] is 1 for every vertex that is a corner.
kernel void mark_used(const uint count, global const uint* corners, global uint* used) {
  FOR_EACH(i, count) atomic_xchg(&used[corners[i]], 1u);
}

// One work-item per triangle.
// Reads levels, corners, flags and pieces.
// Writes marks of pieces: 1: is an edge, 2: is flagged.
// atomic_or decides, in any order the same.
// After this kernel a piece that is a flagged edge has mark 3.
kernel void mark_pieces(const uint count, global const Levels* levels, global const uint* corners,
                        global const uchar* constrained, const uint pieces, global const uint2* ends,
                        global uint* marks) {
  FOR_EACH(t, count) {
    uint3 c = vload3(t, corners);
    for (uint k = 0; k < 3; ++k, c = c.yzx) {
      const uint piece = find_piece(levels, pieces, ends, c.y, c.z);
      if (piece != GCDT_NONE) atomic_or(&marks[piece], (constrained[t] >> k) & 1u ? 3u : 1u);
    }
  }
}

// One work-item per mark.
// Reads marks.
// Writes notes: number i under kind `kind` + marks[i] if marks[i] < wanted.
// atomic_min decides, in any order the same.
// After this kernel the first vertex that is no corner, or the first pieces with mark 0 and 1, are noted.
kernel void find_unmarked(const uint count, const uint wanted, const uint kind, global const uint* marks,
                          global CheckReport* report) {
  FOR_EACH(i, count)
  if (marks[i] < wanted) note(report, kind + marks[i], i);
}
