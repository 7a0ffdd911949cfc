// SPDX-License-Identifier: Apache-2.0
// How long a piece is, by which it is cut into parts before anybody knows what it crosses. OpenCL C only.
#ifndef GCDT_LENGTH_H
#define GCDT_LENGTH_H

#include "common/mesh.h"

// Along the longer axis: below 2^31.
static inline u64 piece_length(global const int2* points, uint2 ends) {
  const int2 p = points[ends.x], q = points[ends.y];
  return (u64)max(abs_diff(p.x, q.x), abs_diff(p.y, q.y));
}

// Adds every work-item's amount to a total of 64 bits, once for a group: in digits of 20 bits, so that no local sum
// overflows (groups have at most 4096 work-items). Sums do not depend on order. All work-items of the group call it.
GCDT_GIVEN_LOCAL void add_lengths(volatile local uint* sum, volatile global uint* total, u64 amount) {
  u64 whole = 0;
  for (uint digit = 0; digit < 4u; ++digit)
    whole += (u64)sum_of_group(sum, (uint)(amount >> (20u * digit)) & 0xFFFFFu) << (20u * digit);
  if (get_local_id(0) == 0) add_wide(total, total + 1, whole);
}

#endif
