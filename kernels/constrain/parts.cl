// SPDX-License-Identifier: Apache-2.0
// Shares out a pool of parts to pieces in proportion to their weights: their lengths (paper, section 6.2), or the
// crossed faces that cleaning counted.
#include "constrain/length.h"

// To find where a part begins takes as long as to cross some faces: those that have been walked are cut only where they
// are much too long.
#define LEAST_CUT 4u

// A piece is long whose share of the pool has so many parts: few pieces are, so that they may have more than that.
#define LONG_SHARE 8u

// Parts of a piece that a list says whose they are: nearly all there are, since few pieces are long.
#define LISTED_PARTS 16u

// One work-item per piece. The weight of a piece is its length. No race: its own word.
kernel void parts_lengths(uint pieces, global const int2* points, global const uint2* ends, global uint* weights) {
  FOR_EACH(c, pieces) weights[c] = (uint)piece_length(points, ends[c]);
}

// One work-item per piece in the list. Copies what cleaning knows of it. No race: its own words.
kernel void parts_pick(uint count, global const uint* list, global const uint2* ends, global const uint* weights,
                       global const uint2* walked, global uint2* to_ends, global uint* to_weights,
                       global uint2* to_walked) {
  FOR_EACH(i, count) {
    const uint c = list[i];
    to_ends[i] = ends[c];
    to_weights[i] = weights[c];
    to_walked[i] = walked[c];
  }
}

// One work-item per stride of pieces. Adds lengths to the 64-bit total, by atomics (add_lengths). After: total[0..1] is
// the length of all, if it was 0.
kernel void parts_total(uint pieces, global const uint* lengths, volatile global uint* total) {
  local uint sum;
  u64 mine = 0;
  FOR_EACH(c, pieces) mine += lengths[c];
  add_lengths(&sum, total, mine);
}

// Of the parts that a piece of this weight has beyond one, its share. A weight and the pool are below 2^32.
static inline uint share_of(uint pool, uint weight, ulong whole) {
  return whole == 0 ? 0u : (uint)min((u64)pool, (u64)weight * pool / whole);
}

// One work-item per piece. Writes the piece's number of parts: one, and of a pool of parts its share by weight; of a
// larger pool if that is a long piece's share, since what long pieces cross may lie in few of their parts. `whole` is
// at least the sum of all weights. A piece that has been walked, if `again`, keeps its parts, whose beginnings are
// known, or each of them is cut in as many. No race: each its own word. After: counts[c] >= 1, their sum is at most
// pieces + long_pool, and the pool of before more if `again`.
kernel void parts_count(uint pieces, ulong whole, uint pool, uint long_pool, global const uint* weights, uint again,
                        global const uint2* walked, global uint* counts) {
  FOR_EACH(c, pieces) {
    const uint share = share_of(pool, weights[c], whole),
               count = 1u + (share < LONG_SHARE ? share : share_of(long_pool, weights[c], whole)),
               had = again ? walked[c].y : 0u;
    counts[c] = had == 0u ? count : count / had < LEAST_CUT ? had : had * (count / had);
  }
}

// One work-item per piece. Writes whose its first parts are. No race: each its own words. Ends: LISTED_PARTS at most.
kernel void parts_list(uint pieces, uint capacity, global const uint* begins, global uint* part_piece) {
  FOR_EACH(c, pieces) {
    const uint first = begins[c], last = min(min(begins[c + 1u], capacity), first + LISTED_PARTS);
    for (uint part = first; part < last; ++part) part_piece[part] = c;
  }
}
