// SPDX-License-Identifier: Apache-2.0
// Rounding crossings to the grid, and which pixels a segment meets (docs/splitting.md). OpenCL C and C++17.
//
// The pixel of grid point (x, y) is the half-open square [x - 1/2, x + 1/2) x [y - 1/2, y + 1/2): pixels cover the
// plane once, and rounding a point half up, coordinate by coordinate, gives the centre of its pixel.
#ifndef GCDT_SNAP_H
#define GCDT_SNAP_H

#include "common/predicates.h"

// The key of a pixel: x above y, 31 bits each.
#define GCDT_PIXEL_KEY_BITS 62u

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// The coordinate of a point that divides from -> to as s : r, rounded half up; 0 <= from, to < 2^31; s, r > 0, both
// < 2^62. With d = |to - from|, D = s + r < 2^63 it is from + floor((2 s d + D) / 2D) or, downwards,
// from - floor((2 s d + D - 1) / 2D). The quotient, at most d, is found bit by bit; numbers are below 2^63 * 2^33.
GCDT_INLINE i64 gcdt_round_division(i64 from, i64 to, i64 s, i64 r) {
  const int down = to < from;
  const i64 d = down ? from - to : to - from, whole = s + r;
  Int128 rest;
  rest.low = (u64)(whole - down);
  rest.high = 0;
  rest = gcdt_add(rest, gcdt_multiply(s, 2 * d));
  i64 q = 0;
  for (int bit = 30; bit >= 0; --bit) {
    const i64 more = q | ((i64)1 << bit);
    if (gcdt_sign128(gcdt_add(rest, gcdt_multiply(-whole, 2 * more))) >= 0) q = more;
  }
  return down ? from - q : from + q;
}

// Do the segments a1-b1 and a2-b2 cross inside both? Then *s, *r > 0 are in proportion to the parts into which the
// crossing divides a1-b1. Doubled areas: below 2^62.
GCDT_INLINE int gcdt_segments_cross(Vertex a1, Vertex b1, Vertex a2, Vertex b2, i64* s, i64* r) {
  const i64 from = gcdt_orient2d_finite(a2, b2, a1), to = gcdt_orient2d_finite(a2, b2, b1);
  if (!((from > 0 && to < 0) || (from < 0 && to > 0))) return 0;
  if (gcdt_sign64(gcdt_orient2d_finite(a1, b1, a2)) * gcdt_sign64(gcdt_orient2d_finite(a1, b1, b2)) >= 0) return 0;
  *s = from < 0 ? -from : from;
  *r = to < 0 ? -to : to;
  return 1;
}

// One axis of a segment: where, in halves of a cell along the segment's direction, a block begins and ends.
typedef struct SnapAxis {
  i64 length;      // of the segment on this axis, >= 0, in cells
  i64 begin, end;  // odd: never where the segment begins or ends
  i32 begin_in;    // the block's side at `begin` belongs to it; the one at `end` does if not
} SnapAxis;

GCDT_INLINE SnapAxis gcdt_snap_axis(i64 a, i64 b, i64 low, i64 size) {
  SnapAxis axis;
  const i64 below = 2 * (low - a) - 1, above = 2 * (low + size - a) - 1;
  axis.begin_in = b >= a;
  axis.length = b >= a ? b - a : a - b;
  axis.begin = b >= a ? below : -above;
  axis.end = b >= a ? above : -below;
  return axis;
}

// Does the closed segment a-b, of positive length, meet the pixels of the block [x, x + size) x [y, y + size)? The
// segment is on the block's strip for begin / 2 length <= t < end / 2 length (or <, <=) on each axis, and for t in
// [0, 1]; three intervals have a point in common if each two have. Products: (2^32 - 1) (2^31 - 1) < 2^63.
GCDT_INLINE int gcdt_meets_block(Vertex a, Vertex b, i64 x, i64 y, i64 size) {
  const SnapAxis u = gcdt_snap_axis(a.x, b.x, x, size), v = gcdt_snap_axis(a.y, b.y, y, size);
  if (u.begin > 2 * u.length || u.end < 0 || v.begin > 2 * v.length || v.end < 0) return 0;
  if (u.length == 0 || v.length == 0) return 1;
  const i64 u_begin = u.begin * v.length, v_end = v.end * u.length;
  if (u_begin > v_end || (u_begin == v_end && !(u.begin_in && !v.begin_in))) return 0;
  const i64 v_begin = v.begin * u.length, u_end = u.end * v.length;
  return v_begin < u_end || (v_begin == u_end && v.begin_in && !u.begin_in);
}

#ifndef __OPENCL_VERSION__
}  // namespace gcdt::device
#endif

#endif
