// SPDX-License-Identifier: Apache-2.0
// A sort pass by whole work-groups, for GPUs.
#ifndef GCDT_SORT_GROUP_H
#define GCDT_SORT_GROUP_H

#include "sort/sort.h"

// Local memory: 1152 keys with their padding, 1024 ranks, 128 counts of 32 bytes, 32 words: 15.1 KiB with 64-bit keys.
#define GCDT_GROUP_DIGITS (1u << GCDT_GROUP_DIGIT_BITS)

// One work-group per part. A work-item counts in its own column: no atomics, no bank conflicts.
// Reads: keys. Writes: table, all digits of the part.
// A part has one owner, and each digit's row is added up by one of its work-items.
// After: table[d * parts + p] counts the keys of part p with digit d.
kernel void sort_count_group(u32 count, u32 span, u32 parts, u32 shift, u32 mask, global const KEY* keys,
                             global u32* table) {
  local u32 counts[GCDT_GROUP_DIGITS * GCDT_SORT_LANES];
  const u32 lane = get_local_id(0), lanes = min((u32)get_local_size(0), GCDT_SORT_LANES);
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    if (lane < lanes) {
      for (u32 d = 0; d <= mask; ++d) counts[d * lanes + lane] = 0;
      for (u32 i = begin + lane; i < end; i += lanes) ++counts[digit_of(keys[i], shift, mask) * lanes + lane];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane < lanes)
      for (u32 d = lane; d <= mask; d += lanes) {
        u32 sum = 0, column = d % lanes;  // rows start at different columns, hence different banks
        for (u32 i = 0; i < lanes; ++i) {
          sum += counts[d * lanes + column];
          column = column + 1 == lanes ? 0 : column + 1;
        }
        table[d * parts + part] = sum;
      }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// Sixteen counts of 16 bits in four words: digit d in component d / 4. A tile has at most 1024 keys.
GCDT_INLINE ulong4 packed_one(u32 digit) {
  const u32 component = digit / 4;
  const u64 one = (u64)1 << (digit % 4 * 16);
  return (ulong4)(component == 0 ? one : 0, component == 1 ? one : 0, component == 2 ? one : 0,
                  component == 3 ? one : 0);
}
GCDT_INLINE u32 packed_count(ulong4 counts, u32 digit) {
  const u32 component = digit / 4;
  const u64 word = component < 2 ? (component == 0 ? counts.x : counts.y) : (component == 2 ? counts.z : counts.w);
  return (u32)(word >> (digit % 4 * 16)) & 0xFFFFu;
}

// Where key i of a tile lies: one word of padding after every eight, so that work-items reading their
// eight keys side by side hit different banks.
#define GCDT_TILE_SLOT(i) ((i) + (i) / GCDT_SORT_WIDTH)

// One work-group per part. Tile by tile it ranks the keys by digit in local memory (work-item i owns
// keys 8i .. 8i+7, so ranks keep the order), then writes them digit by digit: neighbours to neighbours.
// Reads: keys_in, values_in, table (scanned). Writes: keys_out, values_out.
// The scanned table gives each (digit, part) its own range; in a tile ranks are a permutation.
// After: the pairs are in order of the digit; equal digits keep their order.
kernel void sort_move_group(u32 count, u32 span, u32 parts, u32 shift, u32 mask, global const KEY* keys_in,
                            global const u32* values_in, global const u32* table, global KEY* keys_out,
                            global u32* values_out) {
  local KEY keys[GCDT_TILE_SLOT(GCDT_SORT_LANES * GCDT_SORT_WIDTH)];
  local ushort key_of_rank[GCDT_SORT_LANES * GCDT_SORT_WIDTH];
  local ulong4 counts[GCDT_SORT_LANES];
  local u32 first_rank[GCDT_GROUP_DIGITS];  // of each digit in the tile
  local u32 next[GCDT_GROUP_DIGITS];        // where the part's next key of each digit goes
  const u32 lane = get_local_id(0), lanes = min((u32)get_local_size(0), GCDT_SORT_LANES);
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    for (u32 d = lane; d <= mask; d += get_local_size(0)) next[d] = table[d * parts + part];
    for (u32 tile = begin; tile < end; tile += lanes * GCDT_SORT_WIDTH) {
      const u32 size = min(end - tile, lanes * GCDT_SORT_WIDTH);
      const u32 own_begin = min(lane * GCDT_SORT_WIDTH, size), own_end = min(own_begin + GCDT_SORT_WIDTH, size);
      if (lane < lanes)
        for (u32 i = lane; i < size; i += lanes) keys[GCDT_TILE_SLOT(i)] = keys_in[tile + i];
      barrier(CLK_LOCAL_MEM_FENCE);
      ulong4 own = (ulong4)(0);
      for (u32 i = own_begin; i < own_end; ++i) own += packed_one(digit_of(keys[GCDT_TILE_SLOT(i)], shift, mask));
      if (lane < lanes) counts[lane] = own;
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 step = 1; step < lanes; step *= 2) {
        const ulong4 left = lane < lanes && lane >= step ? counts[lane - step] : (ulong4)(0);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (lane < lanes) counts[lane] += left;
        barrier(CLK_LOCAL_MEM_FENCE);
      }
      const ulong4 total = counts[lanes - 1];
      if (lane == 0)
        for (u32 d = 0, rank = 0; d <= mask; ++d) {
          first_rank[d] = rank;
          rank += packed_count(total, d);
        }
      barrier(CLK_LOCAL_MEM_FENCE);
      ulong4 before = lane < lanes ? counts[lane] - own : (ulong4)(0);
      for (u32 i = own_begin; i < own_end; ++i) {
        const u32 d = digit_of(keys[GCDT_TILE_SLOT(i)], shift, mask);
        key_of_rank[first_rank[d] + packed_count(before, d)] = (ushort)i;
        before += packed_one(d);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane < lanes)
        for (u32 rank = lane; rank < size; rank += lanes) {
          const u32 i = key_of_rank[rank];
          const KEY key = keys[GCDT_TILE_SLOT(i)];
          const u32 d = digit_of(key, shift, mask), to = next[d] + rank - first_rank[d];
          keys_out[to] = key;
          values_out[to] = values_in[tile + i];
        }
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 d = lane; d <= mask; d += get_local_size(0)) next[d] += packed_count(total, d);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

#endif
