// SPDX-License-Identifier: Apache-2.0
// What the radix sort of 64-bit keys leaves to simpler ways, by work-groups: few keys; keys that a sort by their high
// bits has left nearly in order.
#include "sort/long.h"
#include "sort/sort_in_group.h"
#include "sort/verify.h"

// ---- In local memory ----------------------------------------------------------------------------------

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

// ---- Runs ---------------------------------------------------------------------------------------------

// One work-item per pair, in order of the bits from `low` on. Of a run of keys that agree in these it comes, in the
// other pair of arrays, behind those that have smaller keys, and equal ones that stood before it. A run longer than
// `longest` is copied as it is, and listed.
// Reads: keys, values. Writes: the pair's place in the other arrays, of which it is the one writer, as places differ;
//   long_runs: how many, which was 0, then where they begin, in any order; the first of a run adds to it by atomic_inc,
//   which gives each place in the list once.
// All pairs of a run agree on whether it is longer: each looks at up to `longest` before it, and on until it has seen
// more than that, or the end. Ends: either loop takes a step each time, `longest` at most.
kernel void rank_runs(u32 count, u32 low, u32 longest, global const u64* keys, global const u32* values,
                      volatile global u32* long_runs, global u64* ranked_keys, global u32* ranked_values) {
  FOR_EACH(i, count) {
    const u64 key = keys[i], high = key >> low;
    u32 begin = i, end = i + 1u, smaller = 0;
    for (; begin > 0u && i - begin < longest; --begin) {
      const u64 met = keys[begin - 1u];
      if (met >> low != high) break;
      if (met <= key) ++smaller;
    }
    for (; end < count && end - begin <= longest; ++end) {
      const u64 met = keys[end];
      if (met >> low != high) break;
      if (met < key) ++smaller;
    }
    const bool is_long = end - begin > longest;
    const u32 place = is_long ? i : begin + smaller;
    ranked_keys[place] = key;
    ranked_values[place] = values[i];
    if (is_long && begin == i) long_runs[1u + atomic_inc(long_runs)] = i;
  }
}

// One work-group per run that rank_runs has listed. Sorts those of up to GCDT_SORT_SMALL pairs, stably.
// Reads, writes: keys, values. A run has one group, and nobody looks beyond its own run but at the bits from `low` on.
// After: every run up to GCDT_SORT_SMALL is in order.
kernel void sort_long_runs(u32 count, u32 low, global const u32* long_runs, global u64* keys, global u32* values) {
  local u64 moved[GCDT_SORT_SMALL];
  local u32 indices[GCDT_SORT_SMALL];
  local u32 size;
  const u32 found = long_runs[0];
  for (u32 r = get_group_id(0); r < found; r += get_num_groups(0)) {
    const u32 begin = long_runs[1u + r];
    if (get_local_id(0) == 0)
      size = end_of_run(low, keys, begin, begin + min(count - begin, GCDT_SORT_SMALL + 1u)) - begin;
    barrier(CLK_LOCAL_MEM_FENCE);
    sort_in_group(size > GCDT_SORT_SMALL ? 0u : size, ~(u64)0, keys + begin, values + begin, moved, indices);
  }
}
