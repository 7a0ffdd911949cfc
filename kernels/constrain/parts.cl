// SPDX-License-Identifier: Apache-2.0
// Shares out a pool of parts to pieces in proportion to their weights: their lengths (paper, section 6.2), or the
// crossed faces that cleaning counted.
#include "common/mesh.h"

// To find where a part begins takes as long as to cross some faces: those that have been walked are cut only where they
// are much too long.
#define LEAST_CUT 4u

static inline u64 piece_length(global const int2* points, uint2 ends) {
  const int2 p = points[ends.x], q = points[ends.y];
  return (u64)max(abs_diff(p.x, q.x), abs_diff(p.y, q.y));
}

// One work-item per piece. The weight of a piece is its length along the longer axis, below 2^31. No race: its own
// word.
kernel void parts_lengths(uint pieces, global const int2* points, global const uint2* ends, global uint* weights) {
  FOR_EACH(c, pieces) weights[c] = (uint)piece_length(points, ends[c]);
}

// One work-item per stride of pieces. Adds weights to the 64-bit total, once for
// a group: in digits of 20 bits, so that no local sum overflows (groups have at most 4096 work-items).
// Sums do not depend on order. After: total[0..1] is the total weight.
kernel void parts_total(uint pieces, global const uint* weights, volatile global uint* total) {
  local uint sum;
  u64 mine = 0, whole = 0;
  FOR_EACH(c, pieces) mine += weights[c];
  for (uint digit = 0; digit < 4u; ++digit)
    whole += (u64)sum_of_group(&sum, (uint)(mine >> (20u * digit)) & 0xFFFFFu) << (20u * digit);
  if (get_local_id(0) == 0) add_wide(total, total + 1, whole);
}

// One work-item per piece. Reads the total weight; writes the piece's number of parts, at least 1. The
// pool has one part for about `crossings` crossed faces, `least` to `most`; their number is (total >> shift) * factor,
// exactly or on an evenly filled mesh. A piece that has been walked, if `again`, keeps its parts, whose beginnings
// are known, or each of them is cut in as many. No race: each its own word. After: counts[c] >= 1, their sum is at most
// pieces + most, and `most` more if `again`.
kernel void parts_count(uint pieces, uint least, uint most, uint shift, uint factor, uint crossings,
                        global const uint* weights, global const uint* total, uint again, global const uint2* walked,
                        global uint* counts) {
  const u64 whole = (u64)total[0] | ((u64)total[1] << 32);
  const u64 expected = (whole >> shift) * factor / crossings + (u64)least;
  const u64 pool = expected < most ? expected : most;
  FOR_EACH(c, pieces) {
    // A weight and the pool are below 2^32.
    const uint count = whole == 0 ? 1u : 1u + (uint)(weights[c] * pool / whole), had = again ? walked[c].y : 0u;
    counts[c] = had == 0u ? count : count / had < LEAST_CUT ? had : had * (count / had);
  }
}
