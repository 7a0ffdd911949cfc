// SPDX-License-Identifier: Apache-2.0
// Putting values in order by buckets: about as many buckets as pairs of key and value, and in each few pairs, near
// where they were. A pair's bucket is what its key has from bit `low` on; pairs of buckets beyond the last are left
// out. In a bucket a pair is one word, its entry: the key's low bits above the value. Keys that are not left out are
// distinct, and so are entries.
//
// Buckets of up to GCDT_SORT_IN_BUCKET pairs are sorted where they are found. Of longer ones, on GPUs those of up to
// GCDT_SORT_SMALL pairs by a group each, in local memory, on CPUs larger ones, too, by a work-item each
// (sort64_serial.cl); pairs of others are left (sort_left.cl).
#include "sort/long.h"
#include "sort/sort_in_group.h"

// One work-item per pair. Adds to: counts, which were 0. Writes slots[i] of pairs that are not left out: no two of a
// bucket have the same, by atomic additions, and which has which is chance. Where a work-item's pairs follow one
// another, those of one bucket in a row are added at once: of a vertex with most of the triangles that is nearly all.
// After: counts say how many pairs each bucket has. Ends: each turn passes a pair.
kernel void bucket_count(u32 count, u32 low, u32 buckets, global const u64* keys, volatile global u32* counts,
                         global u32* slots) {
#ifdef GCDT_CONTIGUOUS
  const Items own = items_of_this(count);
  for (u32 i = own.x; i < own.y;) {
    const u64 bucket = keys[i] >> low;
    u32 end = i + 1u;
    while (end < own.y && keys[end] >> low == bucket) ++end;
    if (bucket < buckets)
      for (u32 j = i, slot = atomic_add(counts + bucket, end - i); j < end; ++j) slots[j] = slot++;
    i = end;
  }
#else
  FOR_EACH(i, count) {
    const u64 bucket = keys[i] >> low;
    if (bucket < buckets) slots[i] = atomic_inc(counts + bucket);
  }
#endif
}

// One work-item per pair. Reads: keys, values, slots; first[b], where bucket b begins. Writes: the pair's entry, of
// which it is the one writer, as places differ. After: entries stand bucket by bucket.
kernel void bucket_move(u32 count, u32 low, u32 buckets, global const u64* keys, global const u32* values,
                        global const u32* first, global const u32* slots, global u64* entries) {
  const u64 low_bits = ((u64)1 << low) - 1u;
  FOR_EACH(i, count) {
    const u64 key = keys[i], bucket = key >> low;
    if (bucket < buckets) entries[first[bucket] + slots[i]] = (key & low_bits) << 32 | values[i];
  }
}

// One work-item per bucket. Writes the values of its entries, each behind those of lesser entries; or lists it, if it
// is long. One of more than `most` is counted besides: its pairs will be taken out.
// Reads: first, entries. Writes: values, of which places differ; adds to long_buckets, whose two counts were 0: the
// list by atomic_inc, which gives each place once. After: the values of every bucket that is not listed are in order.
// Ends: loops go through a bucket that is not long.
kernel void bucket_order(u32 buckets, u32 most, global const u32* first, global const u64* entries, global u32* values,
                         volatile global u32* long_buckets) {
  FOR_EACH(b, buckets) {
    const u32 begin = first[b], end = first[b + 1u];
    if (end - begin > GCDT_SORT_IN_BUCKET) {
      long_buckets[LONG_BUCKETS + atomic_inc(long_buckets + 1)] = b;
      if (end - begin > most) atomic_inc(long_buckets);
      continue;
    }
    for (u32 i = begin; i < end; ++i) {
      const u64 entry = entries[i];
      u32 place = begin;
      for (u32 j = begin; j < end; ++j) place += entries[j] < entry ? 1u : 0u;
      values[place] = (u32)entry;
    }
  }
}

// One work-group per listed bucket. Sorts those of up to GCDT_SORT_SMALL entries.
// Reads, writes: entries, values: a bucket's are its group's, and what a work-item writes last it alone reads.
// After: their values are in order.
kernel void bucket_sort_long(global const u32* long_buckets, global const u32* first, global u64* entries,
                             global u32* values) {
  local u64 moved[GCDT_SORT_SMALL];
  local u32 indices[GCDT_SORT_SMALL];
  const u32 found = long_buckets[1];
  for (u32 r = get_group_id(0); r < found; r += get_num_groups(0)) {
    const u32 b = long_buckets[LONG_BUCKETS + r], begin = first[b], length = first[b + 1u] - begin,
              size = length > GCDT_SORT_SMALL ? 0u : length;  // all groups come to the same barriers
    sort_in_group(size, ~(u64)0, entries + begin, values + begin, moved, indices);
    for (u32 i = get_local_id(0); i < size; i += get_local_size(0)) values[begin + i] = (u32)entries[begin + i];
  }
}
