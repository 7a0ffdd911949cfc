// SPDX-License-Identifier: Apache-2.0
// Shares out a pool of parts to pieces in proportion to their weights: their lengths (paper, section 6.2), or the
// crossed faces that cleaning counted.
#include "constrain/length.h"

// To find where a part begins takes as long as to cross some faces: those that have been walked are cut only where they
// are much too long.
#define LEAST_CUT 4u

// Parts of a piece that a list says whose they are: nearly all there are, since few pieces are long.
#define LISTED_PARTS 16u

// Classes that a block's parts are ordered by, of `unit` edges each.
#define PART_CLASSES 128u

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

// One work-item per piece. Writes the piece's number of parts: one, and of a pool of parts its share by weight. `whole`
// is at least the sum of all weights. A piece that has been walked, if `again`, keeps its parts, whose beginnings are
// known, or each of them is cut in as many. No race: each its own word. After: counts[c] >= 1, their sum is at most
// pieces + pool, and the pool of before more if `again`.
kernel void parts_count(uint pieces, ulong whole, uint pool, global const uint* weights, uint again,
                        global const uint2* walked, global uint* counts) {
  FOR_EACH(c, pieces) {
    // A weight and the pool are below 2^32.
    const uint count = whole == 0 ? 1u : 1u + (uint)min((u64)pool, (u64)weights[c] * pool / whole),
               had = again ? walked[c].y : 0u;
    counts[c] = had == 0u ? count : count / had < LEAST_CUT ? had : had * (count / had);
  }
}

// The class of a part, of which the least passes most: by the edges that cleaning counted, if it is a part of then, or
// by its share of the piece's weight.
static inline uint class_of_part(uint part, global const uint* begins, global const uint* part_piece,
                                 global const uint* weights, uint again, global const uint2* walked,
                                 global const uint* passed, uint unit) {
  const uint c = part_piece[part], first = begins[c], count = begins[c + 1u] - first;
  const uint2 before = again ? walked[c] : (uint2)(0u, 0u);
  const uint edges = before.y == count ? passed[before.x + (part - first)] : weights[c] / count;
  return PART_CLASSES - 1u - min(edges / unit, PART_CLASSES - 1u);
}

// One work-group per block of `span` parts, the last one of fewer. Writes in which order they are walked: those that
// pass about as many edges side by side, so that no lane waits long for another, and all within their block, since
// parts that lie near each other read the same. (Nothing that is found depends on the order.) No race: a block's words
// are one group's; a count or place has one writer between barriers, but for the loops over parts, where atomic_inc
// counts, or gives out each place once.
// After: each block of the order is a permutation of its parts, those beyond the last one behind.
kernel void parts_order(uint pieces, uint capacity, uint span, uint unit, global const uint* begins,
                        global const uint* part_piece, global const uint* weights, uint again,
                        global const uint2* walked, global const uint* passed, global uint* order) {
  local uint counts[PART_CLASSES], places[PART_CLASSES];
  const uint lane = get_local_id(0), lanes = get_local_size(0), parts = min(begins[pieces], capacity);
  for (uint block = get_group_id(0) * span; block < capacity; block += get_num_groups(0) * span) {
    const uint end = min(block + span, capacity), known = min(end, parts);
    for (uint i = lane; i < PART_CLASSES; i += lanes) counts[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint part = block + lane; part < known; part += lanes)
      atomic_inc(counts + class_of_part(part, begins, part_piece, weights, again, walked, passed, unit));
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = lane; i < PART_CLASSES; i += lanes) {
      uint before = block;
      for (uint j = 0; j < i; ++j) before += counts[j];
      places[i] = before;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint part = block + lane; part < end; part += lanes) {
      uint place = part;
      if (part < known)
        place = atomic_inc(places + class_of_part(part, begins, part_piece, weights, again, walked, passed, unit));
      order[place] = part;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// One work-item per piece. Writes whose its first parts are. No race: each its own words. Ends: LISTED_PARTS at most.
kernel void parts_list(uint pieces, uint capacity, global const uint* begins, global uint* part_piece) {
  FOR_EACH(c, pieces) {
    const uint first = begins[c], last = min(min(begins[c + 1u], capacity), first + LISTED_PARTS);
    for (uint part = first; part < last; ++part) part_piece[part] = c;
  }
}
