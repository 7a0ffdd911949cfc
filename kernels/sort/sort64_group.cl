// SPDX-License-Identifier: Apache-2.0
// The radix sort of keys of 64 bits by whole work-groups, for GPUs; and what puts keys in order that it has sorted by
// their high bits alone.
#define KEY u64
#include "sort/long.h"
#include "sort/sort_group.h"
#include "sort/sort_in_group.h"
#include "sort/verify.h"

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
