// SPDX-License-Identifier: Apache-2.0
// Exclusive scan and compaction (lib/primitives.cpp). No work-group ever waits for another.
//
// Parts. Elements 0 .. count-1 are cut into `parts` ranges of `span`, the last one shorter. The host
// chooses span by the device; groups take parts in turn, so a part has one owner under any launch
// geometry. Each step has two kernels of one meaning:
//   *_serial  the group's first work-item walks the part alone. For CPUs, where a group is a loop of
//             one thread: a plain walk is the fastest there is, and lanes and barriers only cost.
//   *_group   the whole group walks the part in tiles. For GPUs: neighbours read neighbours.
#include "shared.h"

// Work-items that take part in a group's sums; further ones only keep the barriers company.
#ifndef GCDT_SCAN_LANES
#define GCDT_SCAN_LANES 256u
#endif
// Consecutive elements of a work-item in one tile.
#define GCDT_SCAN_WIDTH 4u

// sums[lane] = value(0) + ... + value(lane). Called by the whole group; sums is free before and ready
// for all after.
static void group_scan(local u32* sums, u32 lane, u32 lanes, u32 value) {
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane < lanes) sums[lane] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (u32 step = 1; step < lanes; step *= 2) {
    const u32 left = lane < lanes && lane >= step ? sums[lane - step] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane < lanes) sums[lane] += left;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// One work-group per part, its first work-item alone.
// Reads: in. Writes: sums.
// One word a part, and a part has one owner.
// After: sums[p] is the sum of part p.
kernel void scan_sum_serial(u32 count, u32 span, u32 parts, global const u32* in, global u32* sums) {
  if (get_local_id(0) != 0) return;
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 sum = 0;
    for (u32 i = begin; i < end; ++i) sum += in[i];
    sums[part] = sum;
  }
}

// One work-group per part.
// Reads: in. Writes: sums.
// One word a part, written by the owner's first work-item.
// After: sums[p] is the sum of part p.
kernel void scan_sum_group(u32 count, u32 span, u32 parts, global const u32* in, global u32* sums) {
  local u32 lane_sums[GCDT_SCAN_LANES];
  const u32 lane = get_local_id(0), lanes = min((u32)get_local_size(0), GCDT_SCAN_LANES);
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 sum = 0;
    if (lane < lanes)
      for (u32 i = begin + lane; i < end; i += lanes) sum += in[i];
    group_scan(lane_sums, lane, lanes, sum);
    if (lane == 0) sums[part] = lane_sums[lanes - 1];
  }
}

// One work-group per part, its first work-item alone.
// Reads: in, sums of the parts before. Writes: out; it may be in, each word being read before.
// out[i] belongs to the owner of element i, out[count] to the last part.
// After: out is the exclusive scan of in, total included. With one part, sums are not read.
kernel void scan_serial(u32 count, u32 span, u32 parts, global const u32* in, global const u32* sums, global u32* out) {
  if (get_local_id(0) != 0) return;
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 running = 0;
    for (u32 p = 0; p < part; ++p) running += sums[p];
    for (u32 i = begin; i < end; ++i) {
      const u32 value = in[i];
      out[i] = running;
      running += value;
    }
    if (end == count) out[count] = running;
  }
}

// One work-group per part. Adding up the sums of the parts before costs a few loads a work-item and
// saves the usual middle launch.
// Reads: in, sums of the parts before. Writes: out; it may be in, each word being read before.
// out[i] belongs to the work-item that reads element i, out[count] to the last part's first one.
// After: out is the exclusive scan of in, total included. With one part, sums are not read.
kernel void scan_group(u32 count, u32 span, u32 parts, global const u32* in, global const u32* sums, global u32* out) {
  local u32 lane_sums[GCDT_SCAN_LANES];
  const u32 lane = get_local_id(0), lanes = min((u32)get_local_size(0), GCDT_SCAN_LANES);
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 before = 0;
    if (lane < lanes)
      for (u32 p = lane; p < part; p += lanes) before += sums[p];
    group_scan(lane_sums, lane, lanes, before);
    u32 running = lane_sums[lanes - 1];
    for (u32 tile = begin; tile < end; tile += lanes * GCDT_SCAN_WIDTH) {
      const u32 first = tile + lane * GCDT_SCAN_WIDTH;
      u32 value[GCDT_SCAN_WIDTH], sum = 0;
      for (u32 j = 0; j < GCDT_SCAN_WIDTH; ++j) {
        value[j] = lane < lanes && first + j < end ? in[first + j] : 0;
        sum += value[j];
      }
      group_scan(lane_sums, lane, lanes, sum);
      u32 prefix = running + (lane > 0 && lane < lanes ? lane_sums[lane - 1] : 0);
      for (u32 j = 0; j < GCDT_SCAN_WIDTH; ++j) {
        if (lane < lanes && first + j < end) out[first + j] = prefix;
        prefix += value[j];
      }
      running += lane_sums[lanes - 1];
    }
    if (lane == 0 && end == count) out[count] = running;
  }
}

// One work-item per element.
// Reads: offsets[0 .. count]. Writes: out.
// offsets[i] differs between any two elements that are kept: each raises the offset by one.
// After: out lists the kept elements, ascending.
kernel void compact_indices(u32 count, global const u32* offsets, global u32* out) {
  for (u32 i = get_global_id(0); i < count; i += get_global_size(0))
    if (offsets[i + 1] != offsets[i]) out[offsets[i]] = i;
}
