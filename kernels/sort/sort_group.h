// SPDX-License-Identifier: Apache-2.0
// A sort pass by whole work-groups, for GPUs.
#ifndef GCDT_SORT_GROUP_H
#define GCDT_SORT_GROUP_H

#include "sort/sort.h"

// Local memory of a move: 1152 keys with their padding, 1024 values and ranks, 32 rows of counts, words for each digit:
// 25.4 KiB with 64-bit keys.
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

// Counts of a tile's keys, 16 bits each, which are enough for 1024: a row for each digit, in it one for each lane, two
// side by side. After each segment of sixteen lanes stands a pair of padding, so that work-items that go through
// segments side by side hit different banks.
#define GCDT_SEGMENT_LANES 16u
#define GCDT_SEGMENTS (GCDT_SORT_LANES / GCDT_SEGMENT_LANES)
#define GCDT_SEGMENT_PAIRS (GCDT_SEGMENT_LANES / 2u)
#define GCDT_SEGMENT_SIZE (GCDT_SEGMENT_PAIRS + 1u)
#define GCDT_ROW_SIZE (GCDT_SEGMENTS * GCDT_SEGMENT_SIZE)
#define GCDT_COUNT_OF_LANE(lane) ((lane) + 2u * ((lane) / GCDT_SEGMENT_LANES))

// The sum of a segment's counts.
GCDT_INLINE u32 sum_of_segment(local const ushort2* segment) {
  ushort2 sum = (ushort2)(0);
  for (u32 i = 0; i < GCDT_SEGMENT_PAIRS; ++i) sum += segment[i];
  return (u32)sum.x + sum.y;
}

// Each count becomes `rank` and the sum of those before it.
GCDT_INLINE void scan_segment(local ushort2* segment, u32 rank) {
  for (u32 i = 0; i < GCDT_SEGMENT_PAIRS; ++i) {
    const ushort2 two = segment[i];
    segment[i] = (ushort2)((ushort)rank, (ushort)(rank + two.x));
    rank += (u32)two.x + two.y;
  }
}

// Where key i of a tile lies: one word of padding after every eight, so that work-items reading their
// eight keys side by side hit different banks.
#define GCDT_TILE_SLOT(i) ((i) + (i) / GCDT_SORT_WIDTH)

// One work-group per part. Tile by tile it ranks the keys by digit in local memory, then writes them digit by digit:
// neighbours to neighbours. Work-item i owns keys 8i .. 8i+7, so ranks keep the order. It counts them in its own
// column; then sums of segments, of digits, and what is before each segment become the rank of its first key of each
// digit, where the count was. Reads: keys_in, values_in, table (scanned). Writes: keys_out, values_out. The scanned
// table gives each (digit, part) its own range; in a tile ranks are a permutation. In local memory a word has one
// writer between barriers, and others read it behind the next one; a lane's counts are its own, two in a word or not.
// After: the pairs are in order of the digit; equal digits keep their order.
kernel void sort_move_group(u32 count, u32 span, u32 parts, u32 shift, u32 mask, global const KEY* keys_in,
                            global const u32* values_in, global const u32* table, global KEY* keys_out,
                            global u32* values_out) {
  local KEY keys[GCDT_TILE_SLOT(GCDT_SORT_LANES * GCDT_SORT_WIDTH)];
  local u32 values[GCDT_SORT_LANES * GCDT_SORT_WIDTH];
  local ushort key_of_rank[GCDT_SORT_LANES * GCDT_SORT_WIDTH];
  local ushort2 counts[GCDT_GROUP_DIGITS * GCDT_ROW_SIZE];
  local u32 sums[GCDT_GROUP_DIGITS * GCDT_SEGMENTS];
  local u32 totals[GCDT_GROUP_DIGITS];      // of the tile before, then of the tile
  local u32 first_rank[GCDT_GROUP_DIGITS];  // of each digit in the tile
  local u32 next[GCDT_GROUP_DIGITS];        // where the part's next key of each digit goes
  const u32 lane = get_local_id(0), all = (u32)get_local_size(0), lanes = min(all, GCDT_SORT_LANES);
  const u32 segments = (mask + 1u) * GCDT_SEGMENTS;
  local ushort* own_counts = (local ushort*)counts + GCDT_COUNT_OF_LANE(lane);
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    for (u32 d = lane; d <= mask; d += all) next[d] = table[d * parts + part], totals[d] = 0u;
    for (u32 tile = begin; tile < end; tile += lanes * GCDT_SORT_WIDTH) {
      const u32 size = min(end - tile, lanes * GCDT_SORT_WIDTH);
      const u32 own_begin = min(lane * GCDT_SORT_WIDTH, size), own_end = min(own_begin + GCDT_SORT_WIDTH, size);
      if (lane < lanes)
        for (u32 i = lane; i < size; i += lanes) {
          keys[GCDT_TILE_SLOT(i)] = keys_in[tile + i];
          values[i] = values_in[tile + i];
        }
      for (u32 i = lane; i < (mask + 1u) * GCDT_ROW_SIZE; i += all) counts[i] = (ushort2)(0);
      for (u32 d = lane; d <= mask; d += all) next[d] += totals[d];
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 i = own_begin; i < own_end; ++i)
        ++own_counts[2u * GCDT_ROW_SIZE * digit_of(keys[GCDT_TILE_SLOT(i)], shift, mask)];
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 s = lane; s < segments; s += all) sums[s] = sum_of_segment(counts + s * GCDT_SEGMENT_SIZE);
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 d = lane; d <= mask; d += all) {
        u32 total = 0;
        for (u32 s = 0; s < GCDT_SEGMENTS; ++s) total += sums[d * GCDT_SEGMENTS + s];
        totals[d] = total;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 s = lane; s < segments; s += all) {
        const u32 d = s / GCDT_SEGMENTS;
        u32 rank = 0;
#pragma unroll 4
        for (u32 i = 0; i < d; ++i) rank += totals[i];
        if (s % GCDT_SEGMENTS == 0u) first_rank[d] = rank;
#pragma unroll 1  // fewer than GCDT_SEGMENTS
        for (u32 i = d * GCDT_SEGMENTS; i < s; ++i) rank += sums[i];
        scan_segment(counts + s * GCDT_SEGMENT_SIZE, rank);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 i = own_begin; i < own_end; ++i) {
        local ushort* rank = own_counts + 2u * GCDT_ROW_SIZE * digit_of(keys[GCDT_TILE_SLOT(i)], shift, mask);
        key_of_rank[(*rank)++] = (ushort)i;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane < lanes)
        for (u32 rank = lane; rank < size; rank += lanes) {
          const u32 i = key_of_rank[rank];
          const KEY key = keys[GCDT_TILE_SLOT(i)];
          const u32 d = digit_of(key, shift, mask), to = next[d] + rank - first_rank[d];
          keys_out[to] = key;
          values_out[to] = values[i];
        }
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }
}

#endif
