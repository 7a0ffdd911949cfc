// SPDX-License-Identifier: Apache-2.0
// The quality of triangles, exactly. OpenCL C and C++17.
#ifndef GCDT_QUALITY_H
#define GCDT_QUALITY_H

#include "common/int128.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// Of some triangles, or of none (count 0). Areas are doubled, in cells: integers below 2^62, and their sum, over
// triangles that do not overlap, is at most 2 S^2 < 2^63. An angle is kept by its cotangent dot / area, a quotient of
// integers: of two sides from its corner the dot product and the doubled area.
typedef struct Quality {
  u64 count;
  u64 least_area, most_area, area_sum;
  i64 least_dot, most_dot;  // of the least and of the largest angle
  u64 least_angle_area, most_angle_area;
  u32 least_triangle, most_triangle;  // the least triangles with those angles
} Quality;

// Whether the angle with dot a / area p is less than that with b / q: its cotangent is larger. Products are below
// 2^63 * 2^62.
GCDT_INLINE u32 gcdt_angle_less(i64 a, u64 p, i64 b, u64 q) {
  const Int128 left = gcdt_multiply(a, (i64)q), right = gcdt_multiply(b, (i64)p);
  return left.high > right.high || (left.high == right.high && left.low > right.low);
}

GCDT_INLINE Quality gcdt_no_quality(void) {
  Quality q;
  q.count = 0;
  q.least_area = ~(u64)0;
  q.most_area = 0;
  q.area_sum = 0;
  q.least_dot = q.most_dot = 0;
  q.least_angle_area = q.most_angle_area = 0;
  q.least_triangle = q.most_triangle = GCDT_NONE;
  return q;
}

// Of both; equal angles are those of the lesser triangle, so the order of joining does not matter.
GCDT_INLINE Quality gcdt_join_quality(Quality a, Quality b) {
  if (b.count == 0) return a;
  if (a.count == 0) return b;
  a.count += b.count;
  a.area_sum += b.area_sum;
  a.least_area = b.least_area < a.least_area ? b.least_area : a.least_area;
  a.most_area = b.most_area > a.most_area ? b.most_area : a.most_area;
  if (gcdt_angle_less(b.least_dot, b.least_angle_area, a.least_dot, a.least_angle_area) ||
      (b.least_triangle < a.least_triangle &&
       !gcdt_angle_less(a.least_dot, a.least_angle_area, b.least_dot, b.least_angle_area))) {
    a.least_dot = b.least_dot;
    a.least_angle_area = b.least_angle_area;
    a.least_triangle = b.least_triangle;
  }
  if (gcdt_angle_less(a.most_dot, a.most_angle_area, b.most_dot, b.most_angle_area) ||
      (b.most_triangle < a.most_triangle &&
       !gcdt_angle_less(b.most_dot, b.most_angle_area, a.most_dot, a.most_angle_area))) {
    a.most_dot = b.most_dot;
    a.most_angle_area = b.most_angle_area;
    a.most_triangle = b.most_triangle;
  }
  return a;
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(Quality) == 9 * sizeof(u64), "Quality has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif
