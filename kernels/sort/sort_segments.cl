// SPDX-License-Identifier: Apache-2.0
// Many sorts of few keys each: of batches alone, and so a program of its own.
#include "sort/sort_in_group.h"

// One work-group per segment, first[s] .. first[s + 1] - 1, of up to GCDT_SORT_SMALL pairs. Sorts it by the key,
// stably.
// Reads, writes: keys, values; a word belongs to one segment, so to one group.
// After: every segment is in order.
kernel void sort_segments(u32 segments, global const u32* first, global u64* keys, global u32* values) {
  local u64 moved[GCDT_SORT_SMALL];
  local u32 indices[GCDT_SORT_SMALL];
  for (u32 s = get_group_id(0); s < segments; s += get_num_groups(0)) {
    const u32 begin = first[s];
    sort_in_group(first[s + 1u] - begin, ~(u64)0, keys + begin, values + begin, moved, indices);
  }
}
