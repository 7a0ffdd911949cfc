// SPDX-License-Identifier: Apache-2.0
// What the radix sort of 64-bit keys leaves to simpler ways: few keys, sorted by one work-group, and keys that a
// sort by their high bits has left nearly in order.
#include "digits.h"
#include "runs.h"

// Keys that one work-group sorts in local memory: 24 KiB of the 32 that every device has.
#define SORT_SMALL 2048u

GCDT_INLINE bool comes_before(u64 key, u32 index, u64 other_key, u32 other_index) {
  return key < other_key || (key == other_key && index < other_index);
}

// One work-group. Sorts up to SORT_SMALL pairs by the bits `mask` of the key, equal ones in the order in which they
// were: a bitonic sort by (key, index); what is missing to a power of two counts as greatest.
// Reads: keys_in, values_in. Writes: keys_out, values_out.
// In a step every pair of places has one work-item; barriers stand between steps.
// After: the pairs are in order.
kernel void sort_small(u32 count, u64 mask, global const u64* keys_in, global const u32* values_in,
                       global u64* keys_out, global u32* values_out) {
  local u64 keys[SORT_SMALL];
  local u32 indices[SORT_SMALL];
  u32 size = 1;
  while (size < count) size *= 2u;
  for (u32 i = get_local_id(0); i < size; i += get_local_size(0)) {
    keys[i] = i < count ? keys_in[i] & mask : ~(u64)0;
    indices[i] = i;
  }
  for (u32 run = 2u; run <= size; run *= 2u)
    for (u32 step = run / 2u; step > 0u; step /= 2u) {
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 i = get_local_id(0); i < size / 2u; i += get_local_size(0)) {
        const u32 low = 2u * i - (i & (step - 1u)), high = low + step;
        const bool ascending = (low & run) == 0u;
        const u64 a = keys[low], b = keys[high];
        const u32 ia = indices[low], ib = indices[high];
        if (comes_before(b, ib, a, ia) == ascending) {
          keys[low] = b, keys[high] = a;
          indices[low] = ib, indices[high] = ia;
        }
      }
    }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (u32 i = get_local_id(0); i < count; i += get_local_size(0)) {
    keys_out[i] = keys_in[indices[i]];
    values_out[i] = values_in[indices[i]];
  }
}

// One work-group, its first work-item alone: for CPUs, where that is faster than lanes and barriers, and than launches
// for each digit. Sorts pairs by the bits below `bits` of the key, stably, by digits of 8 bits.
// Reads, writes: keys and values, and the other ones by turns.
// After: the pairs are in order; they stand in the other buffers if the number of digits is odd.
kernel void sort_alone(u32 count, u32 bits, global u64* keys, global u32* values, global u64* other_keys,
                       global u32* other_values) {
  if (get_local_id(0) == 0) sort_by_digits(count, bits, keys, values, other_keys, other_values);
}

// One work-item per pair, in order of the bits from `low` on. Where a run of keys that agree in these begins, its
// work-item sorts it by insertion, in place and stable; a run longer than `longest` is left as it is.
// Reads, writes: keys, values.
// A run has one work-item, and nobody looks beyond the neighbours of its own run but at the bits from `low` on, in
// which all keys that may stand there agree.
// After: every run up to `longest` is in order.
kernel void sort_runs(u32 count, u32 low, u32 longest, global u64* keys, global u32* values) {
  FOR_EACH(begin, count) {
    const u64 high = keys[begin] >> low;
    if (begin > 0u && keys[begin - 1u] >> low == high) continue;
    u32 end = begin + 1u;
    while (end < count && end - begin <= longest && keys[end] >> low == high) ++end;
    if (end - begin > longest) continue;
    sort_run(keys, values, begin, end);
  }
}

// One work-item per pair. Writes 1 to *unordered if two neighbours are not in order. No race: all write the same.
kernel void sort_verify(u32 count, global const u64* keys, global u32* unordered) {
  FOR_EACH(i, max(count, 1u) - 1u)
  if (keys[i] > keys[i + 1u]) *unordered = 1u;
}
