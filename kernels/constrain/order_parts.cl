// SPDX-License-Identifier: Apache-2.0
// In which order parts are walked where they pass many edges. A program of its own, since few calls want it and a first
// call waits for all that it compiles.
#include "common/shared.h"

// Classes that a block's parts are ordered by, of `unit` edges each.
#define PART_CLASSES 128u

// The class of a part, of which the least passes most: by the edges that cleaning counted, if it is a part of then, or
// by its share of the piece's weight.
static inline uint class_of_part(uint part, global const uint* begins, global const uint* part_piece,
                                 global const uint* weights, global const uint2* walked, global const uint* passed,
                                 uint unit) {
  const uint c = part_piece[part], first = begins[c], count = begins[c + 1u] - first;
  const uint2 before = walked[c];
  const uint edges = before.y == count ? passed[before.x + (part - first)] : weights[c] / count;
  return PART_CLASSES - 1u - min(edges / unit, PART_CLASSES - 1u);
}

// One work-group per block of `span` parts, the last one of fewer. Writes in which order they are walked: those that
// pass about as many edges side by side, so that no lane waits long for another, and all within their block, since
// parts that lie near each other read the same. (Nothing that is found depends on the order.) No race: a block's words
// are one group's; a count or place has one writer between barriers, but for the loops over parts, where atomic_inc
// counts, or gives out each place once.
// After: each block of the order is a permutation of its parts, those beyond the last one behind.
kernel void order_parts(uint pieces, uint capacity, uint span, uint unit, global const uint* begins,
                        global const uint* part_piece, global const uint* weights, global const uint2* walked,
                        global const uint* passed, global uint* order) {
  local uint counts[PART_CLASSES], places[PART_CLASSES];
  const uint lane = get_local_id(0), lanes = get_local_size(0), parts = min(begins[pieces], capacity);
  for (uint block = get_group_id(0) * span; block < capacity; block += get_num_groups(0) * span) {
    const uint end = min(block + span, capacity), known = min(end, parts);
    for (uint i = lane; i < PART_CLASSES; i += lanes) counts[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint part = block + lane; part < known; part += lanes)
      atomic_inc(counts + class_of_part(part, begins, part_piece, weights, walked, passed, unit));
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
        place = atomic_inc(places + class_of_part(part, begins, part_piece, weights, walked, passed, unit));
      order[place] = part;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}
