// SPDX-License-Identifier: Apache-2.0
// Shares out a pool of parts to pieces in proportion to their length (paper, section 6.2).
#include "mesh.h"

static inline u64 piece_length(global const int2* points, uint2 ends) {
  const int2 p = points[ends.x], q = points[ends.y];
  return (u64)max(abs_diff(p.x, q.x), abs_diff(p.y, q.y));
}

// One work-item per stride of pieces. Adds lengths (longer axis) to the 64-bit total by atomics;
// sums do not depend on order. After: total[0..1] is the total length.
kernel void parts_total(uint pieces, global const int2* points, global const uint2* ends, volatile global uint* total) {
  for (uint c = get_global_id(0); c < pieces; c += get_global_size(0)) {
    const u64 length = piece_length(points, ends[c]);
    add_wide(total, total + 1, (uint)length);
  }
}

// One work-item per piece. Reads the total length; writes the piece's number of parts, at least 1. The
// pool has one part for about eight crossed faces of an evenly filled mesh, `least` to `most`.
// No race: each its own word. After: counts[c] >= 1, their sum is at most pieces + most.
kernel void parts_count(uint pieces, uint least, uint most, uint root_of_faces, global const int2* points,
                        global const uint2* ends, global const uint* total, global uint* counts) {
  const u64 whole = (u64)total[0] | ((u64)total[1] << 32);
  const u64 expected = (whole >> 31) * root_of_faces / 8u + (u64)least;
  const u64 pool = expected < most ? expected : most;
  for (uint c = get_global_id(0); c < pieces; c += get_global_size(0)) {
    // length < 2^31 and pool < 2^31.
    counts[c] = whole == 0 ? 1u : 1u + (uint)(piece_length(points, ends[c]) * pool / whole);
  }
}
