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

GCDT_INLINE void copy_pairs(u32 count, global const u64* keys, global const u32* values, global u64* to_keys,
                            global u32* to_values) {
  for (u32 i = 0; i < count; ++i) to_keys[i] = keys[i], to_values[i] = values[i];
}

// By the bits of the key from `low` up to `high`, stably, by digits of GCDT_ONE_ITEM_DIGIT_BITS: from one pair of
// arrays to the other and back. Returns whether the number of digits is odd, so that the pairs are in the other arrays
// now.
GCDT_APART bool sort_by_digits(u32 count, u32 low, u32 high, global u64* keys, global u32* values,
                               global u64* other_keys, global u32* other_values) {
  const u32 width = GCDT_ONE_ITEM_DIGIT_BITS(count);
  bool other = false;
  for (u32 shift = low; shift < high; shift += width, other = !other) {
    const u32 mask = (1u << min(width, high - shift)) - 1u;
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

// A run by the bits of its keys below `high`, stably and in place: short ones by insertion, which takes all bits of the
// key, long ones by digits. The other arrays are void afterwards.
GCDT_INLINE void sort_run_below(u32 count, u32 high, global u64* keys, global u32* values, global u64* other_keys,
                                global u32* other_values) {
  if (count <= GCDT_RUN_BY_INSERTION)
    sort_run(keys, values, 0u, count);
  else if (sort_by_digits(count, 0u, high, keys, values, other_keys, other_values))
    copy_pairs(count, other_keys, other_values, keys, values);
}

// By the bits below `high`, which are more than two digits, of the key, stably and in place: by two digits and what
// these leave. Of keys that differ at random next to none agree in these 16 or 22 bits; where keys do, each run is
// sorted by itself. The other arrays are void afterwards. Ends: each run has a pair.
GCDT_APART void sort_by_prefix(u32 count, u32 high, global u64* keys, global u32* values, global u64* other_keys,
                               global u32* other_values) {
  const u32 low = high - 2u * GCDT_ONE_ITEM_DIGIT_BITS(count);
  sort_by_digits(count, low, high, keys, values, other_keys, other_values);  // there and back
  for (u32 begin = 0u, end = 1u; begin < count; begin = end++) {
    while (end < count && keys[end] >> low == keys[begin] >> low) ++end;
    sort_run_below(end - begin, low, keys + begin, values + begin, other_keys + begin, other_values + begin);
  }
}

#endif
