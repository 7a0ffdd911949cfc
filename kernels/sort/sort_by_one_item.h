// SPDX-License-Identifier: Apache-2.0
// Pairs of a key and a value put in order by one work-item. OpenCL C only.
#ifndef GCDT_SORT_BY_ONE_ITEM_H
#define GCDT_SORT_BY_ONE_ITEM_H

#include "common/shared.h"
#include "sort/sizes.h"

// By insertion, in place and stable: pairs begin .. end - 1 by their keys. Ends: each loop runs through the run.
GCDT_INLINE void sort_run(global u64* keys, global u32* values, u32 begin, u32 end) {
  for (u32 i = begin + 1u; i < end; ++i) {
    const u64 key = keys[i];
    const u32 value = values[i];
    u32 at = i;
    for (; at > begin && keys[at - 1u] > key; --at) {
      keys[at] = keys[at - 1u];
      values[at] = values[at - 1u];
    }
    keys[at] = key;
    values[at] = value;
  }
}

// Where the first key of each digit up to `last` comes, instead of how many have it.
GCDT_INLINE void counts_to_begins(u32 last, private u32* next) {
  for (u32 d = 0, sum = 0; d <= last; ++d) {
    const u32 count = next[d];
    next[d] = sum;
    sum += count;
  }
}

// Words by their bits from `low` up to `high`, stably, by digits of GCDT_SERIAL_DIGIT_BITS: from one array to the other
// and back. Returns which one they are in.
GCDT_INLINE global const u64* sort_words(u32 count, u32 low, u32 high, global u64* words, global u64* other) {
  for (u32 shift = low; shift < high; shift += GCDT_SERIAL_DIGIT_BITS) {
    const u32 mask = (1u << min(GCDT_SERIAL_DIGIT_BITS, high - shift)) - 1u;
    u32 next[1u << GCDT_SERIAL_DIGIT_BITS];
    for (u32 d = 0; d <= mask; ++d) next[d] = 0;
    for (u32 i = 0; i < count; ++i) ++next[(u32)(words[i] >> shift) & mask];
    counts_to_begins(mask, next);
    for (u32 i = 0; i < count; ++i) other[next[(u32)(words[i] >> shift) & mask]++] = words[i];
    global u64* sorted = other;
    other = words;
    words = sorted;
  }
  return words;
}

// By the bits below `bits` of the key, stably, by digits of GCDT_ONE_ITEM_DIGIT_BITS: from one pair of arrays to the
// other and back. Returns whether the number of digits is odd, so that the pairs are in the other arrays now.
GCDT_APART bool sort_by_digits(u32 count, u32 bits, global u64* keys, global u32* values, global u64* other_keys,
                               global u32* other_values) {
  const u32 width = GCDT_ONE_ITEM_DIGIT_BITS(count);
  bool other = false;
  for (u32 shift = 0; shift < bits; shift += width, other = !other) {
    const u32 mask = (1u << min(width, bits - shift)) - 1u;
    u32 next[1u << GCDT_MOST_ONE_ITEM_DIGIT_BITS];
    for (u32 d = 0; d <= mask; ++d) next[d] = 0;
    for (u32 i = 0; i < count; ++i) ++next[(u32)(keys[i] >> shift) & mask];
    counts_to_begins(mask, next);
    for (u32 i = 0; i < count; ++i) {
      const u64 key = keys[i];
      const u32 to = next[(u32)(key >> shift) & mask]++;
      other_keys[to] = key;
      other_values[to] = values[i];
    }
    global u64* sorted_keys = other_keys;
    global u32* sorted_values = other_values;
    other_keys = keys, other_values = values;
    keys = sorted_keys, values = sorted_values;
  }
  return other;
}

#endif
