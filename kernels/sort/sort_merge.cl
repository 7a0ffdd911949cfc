// SPDX-License-Identifier: Apache-2.0
// Sorts few 64-bit keys by work-groups: blocks in local memory, which are merged.
#include "sort/sort_in_group.h"

// One work-group per block of GCDT_SORT_SMALL pairs, of which the last may have fewer. Sorts it by the bits `mask` of
// the key, stably. Reads, writes: keys, values; a word belongs to one block, so to one group. After: every block is in
// order.
kernel void sort_blocks(u32 count, u64 mask, global u64* keys, global u32* values) {
  local u64 moved[GCDT_SORT_SMALL];
  local u32 indices[GCDT_SORT_SMALL];
  for (u32 begin = get_group_id(0) * GCDT_SORT_SMALL; begin < count; begin += get_num_groups(0) * GCDT_SORT_SMALL)
    sort_in_group(min(count - begin, GCDT_SORT_SMALL), mask, keys + begin, values + begin, moved, indices);
}

// One work-item per pair. Merges each four runs of `width` pairs, a power of two, in order of the bits `mask` of the
// key, stably: a pair goes behind those of its own run that were before it, and behind those of the three others that
// come before it, of equal keys those of the runs before its own. The three are searched at once, so that their loads
// do not wait for one another.
// Reads: keys, values. Writes: the pair's place in the other ones, of which it is the one writer, as places differ.
// After: runs of four times the width are in order. Ends: the step halves.
kernel void merge_runs(u32 count, u32 width, u64 mask, global const u64* keys, global const u32* values,
                       global u64* other_keys, global u32* other_values) {
  FOR_EACH(i, count) {
    const u32 run = i / width, first = run & ~3u;
    const u64 key = keys[i] & mask;
    u32 before[3] = {0u, 0u, 0u};  // of each of the other runs
    for (u32 step = width; step > 0u; step /= 2u)
      for (u32 j = 0; j < 3u; ++j) {
        const u32 other = first + ((run + 1u + j) & 3u), begin = min(other * width, count), reached = before[j] + step;
        if (reached > min(width, count - begin)) continue;
        const u64 met = keys[begin + reached - 1u] & mask;
        if (met < key || (met == key && other < run)) before[j] = reached;
      }
    const u32 place = first * width + (i - run * width) + before[0] + before[1] + before[2];
    other_keys[place] = keys[i];
    other_values[place] = values[i];
  }
}
