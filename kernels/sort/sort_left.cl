// SPDX-License-Identifier: Apache-2.0
// Pairs of runs and buckets that are too long to be put in order where they stand: they are taken out, sorted by all of
// their keys, and put back (lib/mesh/primitives.cpp). A program of its own, since few calls need it.
#include "common/search.h"
#include "sort/long.h"

// ---- Runs (sort_finish.cl, sort64_serial.cl) ----------------------------------------------------------

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

// ---- Buckets (buckets.cl) -----------------------------------------------------------------------------

// One work-group per listed bucket. Writes: marks, which were 0, of the places of those that are longer than `most`, of
// which each has one group.
kernel void bucket_mark_left(u32 most, global const u32* long_buckets, global const u32* first, global u32* marks) {
  const u32 found = long_buckets[1];
  for (u32 r = get_group_id(0); r < found; r += get_num_groups(0)) {
    const u32 b = long_buckets[LONG_BUCKETS + r], begin = first[b], end = first[b + 1u];
    if (end - begin <= most) continue;
    for (u32 i = begin + get_local_id(0); i < end; i += get_local_size(0)) marks[i] = 1u;
  }
}

// One work-item per place, of `count` in ascending order. Writes the pairs whose entries stand there, one after the
// other.
kernel void bucket_take(u32 count, u32 low, u32 buckets, global const u32* places, global const u32* first,
                        global const u64* entries, global u64* taken_keys, global u32* taken_values) {
  FOR_EACH(i, count) {
    const u64 entry = entries[places[i]];
    taken_keys[i] = (u64)last_begin(first, buckets, places[i]) << low | entry >> 32;
    taken_values[i] = (u32)entry;
  }
}

// One work-item per place. Puts values that were taken and sorted back: buckets are in order, so each bucket's come to
// its own places. No race: places differ.
kernel void bucket_put(u32 count, global const u32* places, global const u32* taken_values, global u32* values) {
  FOR_EACH(i, count) values[places[i]] = taken_values[i];
}
