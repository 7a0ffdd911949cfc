// SPDX-License-Identifier: Apache-2.0
// What the radix sort of 64-bit keys leaves to simpler ways: few keys, sorted by one work-group; keys that a sort by
// their high bits has left nearly in order.
#include "sort/sort_by_one_item.h"
#include "sort/sort_in_group.h"

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

// One work-item per pair, in order of the bits from `low` on. Where a run of keys that agree in these begins, its
// work-item sorts it by insertion, in place and stable; a run longer than `longest` is left as it is, and listed.
// Reads, writes: keys, values. Writes: long_runs: how many, which was 0, then where they begin, in any order.
// A run has one work-item, and nobody looks beyond the neighbours of its own run but at the bits from `low` on, in
// which all keys that may stand there agree. atomic_inc gives each place in the list once.
// After: every run up to `longest` is in order.
kernel void sort_runs(u32 count, u32 low, u32 longest, global u64* keys, global u32* values,
                      volatile global u32* long_runs) {
  FOR_EACH(begin, count) {
    const u64 high = keys[begin] >> low;
    if (begin > 0u && keys[begin - 1u] >> low == high) continue;
    u32 end = begin + 1u;
    while (end < count && end - begin <= longest && keys[end] >> low == high) ++end;
    if (end - begin > longest)
      long_runs[1u + atomic_inc(long_runs)] = begin;
    else
      sort_run(keys, values, begin, end);
  }
}

// The same from one pair of arrays to the other, a work-item for each pair: it comes behind those of its run that have
// smaller keys, and equal ones that stood before it. Runs longer than `longest` are copied as they are.
// Reads: keys, values. Writes: the pair's place in the other arrays, of which it is the one writer, as places differ;
//   long_runs, as above, which the first of a run adds to.
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

// Where the run that begins at `begin` ends, or `outside`, if that is in it. Ends: the range halves.
GCDT_INLINE u32 end_of_run(u32 low, global const u64* keys, u32 begin, u32 outside) {
  const u64 high = keys[begin] >> low;
  u32 inside = begin;
  while (outside - inside > 1u) {
    const u32 middle = inside + (outside - inside) / 2u;
    if (keys[middle] >> low == high)
      inside = middle;
    else
      outside = middle;
  }
  return outside;
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

// One work-group per run that sort_runs or rank_runs has listed.
// Reads: keys. Writes: marks, which were 0, of the pairs of those longer than `most`, of which each is in one run.
kernel void mark_left_runs(u32 count, u32 low, u32 most, global const u32* long_runs, global const u64* keys,
                           global u32* marks) {
  const u32 found = long_runs[0];
  for (u32 r = get_group_id(0); r < found; r += get_num_groups(0)) {
    const u32 begin = long_runs[1u + r], end = end_of_run(low, keys, begin, count);
    for (u32 i = begin + get_local_id(0); i < end && end - begin > most; i += get_local_size(0)) marks[i] = 1u;
  }
}

// One work-item per place. Copies the pairs in these places, one after the other.
kernel void take_pairs(u32 count, global const u32* places, global const u64* keys, global const u32* values,
                       global u64* taken_keys, global u32* taken_values) {
  FOR_EACH(i, count) {
    taken_keys[i] = keys[places[i]];
    taken_values[i] = values[places[i]];
  }
}

// The inverse. No race: places differ.
kernel void put_pairs(u32 count, global const u32* places, global const u64* taken_keys, global const u32* taken_values,
                      global u64* keys, global u32* values) {
  FOR_EACH(i, count) {
    keys[places[i]] = taken_keys[i];
    values[places[i]] = taken_values[i];
  }
}

// One work-item per pair. Writes 1 to *unordered if two neighbours are not in order. No race: all write the same.
kernel void sort_verify(u32 count, global const u64* keys, global u32* unordered) {
  FOR_EACH(i, max(count, 1u) - 1u)
  if (keys[i] > keys[i + 1u]) *unordered = 1u;
}
