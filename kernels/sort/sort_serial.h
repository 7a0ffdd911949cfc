// SPDX-License-Identifier: Apache-2.0
// A sort pass by single work-items, for CPUs.
#ifndef GCDT_SORT_SERIAL_H
#define GCDT_SORT_SERIAL_H

#include "sort/sort.h"

#define GCDT_SERIAL_DIGITS (1u << GCDT_SERIAL_DIGIT_BITS)

// One work-group per part, its first work-item alone.
// Reads: keys. Writes: table, all digits of the part.
// A part has one owner.
// After: table[d * parts + p] counts the keys of part p with digit d.
kernel void sort_count_serial(u32 count, u32 span, u32 parts, u32 shift, u32 mask, global const KEY* keys,
                              global u32* table) {
  if (get_local_id(0) != 0) return;
  FOR_EACH_OF_GROUPS(part, 0u, parts) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 counts[GCDT_SERIAL_DIGITS];
    for (u32 d = 0; d <= mask; ++d) counts[d] = 0;
    for (u32 i = begin; i < end; ++i) ++counts[digit_of(keys[i], shift, mask)];
    for (u32 d = 0; d <= mask; ++d) table[d * parts + part] = counts[d];
  }
}

// One work-group per part, its first work-item alone.
// Reads: keys_in, values_in, table (scanned). Writes: keys_out, values_out.
// The scanned table gives each (digit, part) its own range, and `next` steps through it.
// After: the pairs are in order of the digit; equal digits keep their order.
kernel void sort_move_serial(u32 count, u32 span, u32 parts, u32 shift, u32 mask, global const KEY* keys_in,
                             global const u32* values_in, global const u32* table, global KEY* keys_out,
                             global u32* values_out) {
  if (get_local_id(0) != 0) return;
  FOR_EACH_OF_GROUPS(part, 0u, parts) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 next[GCDT_SERIAL_DIGITS];
    for (u32 d = 0; d <= mask; ++d) next[d] = table[min(d, mask) * parts + part];  // min: as in FOR_EACH_OF_GROUPS
    for (u32 i = begin; i < end; ++i) {
      const KEY key = keys_in[i];
      const u32 to = next[digit_of(key, shift, mask)]++;
      keys_out[to] = key;
      values_out[to] = values_in[i];
    }
  }
}

#endif
