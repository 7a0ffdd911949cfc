// SPDX-License-Identifier: Apache-2.0
// The radix sort of keys of 64 bits by single work-items, for CPUs, and what it leaves where it has looked at their
// high bits only.
#define KEY u64
#include "sort/long.h"
#include "sort/sort_by_one_item.h"
#include "sort/sort_serial.h"
#include "sort/verify.h"

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

// One work-item per listed bucket (buckets.cl). Sorts those of up to `most` entries, by the `low` bits of keys in them.
// Reads: long_buckets, first. Reads, writes: entries and other; writes: values: a bucket's places are its work-item's
// in all of them.
// After: the values of these buckets are in order.
kernel void bucket_sort_each(u32 low, u32 most, global const u32* long_buckets, global const u32* first,
                             global u64* entries, global u64* other, global u32* values) {
  const u32 found = long_buckets[1];
  FOR_EACH(r, found) {
    const u32 b = long_buckets[LONG_BUCKETS + r], begin = first[b], length = first[b + 1u] - begin;
    if (length > most) continue;
    global const u64* sorted = sort_words(length, 32u, 32u + low, entries + begin, other + begin);
    for (u32 i = 0; i < length; ++i) values[begin + i] = (u32)sorted[i];
  }
}
