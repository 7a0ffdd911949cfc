// SPDX-License-Identifier: Apache-2.0
// The scan by whole work-groups, for GPUs; parts as in primitives.cl.
#include "sort/compact.h"

// Work-items that take part in a group's sums; further ones only keep the barriers company.
#ifndef GCDT_SCAN_LANES
#define GCDT_SCAN_LANES 256u
#endif
// Consecutive elements of a work-item in one tile.
#define GCDT_SCAN_WIDTH 4u

// Called by the whole group; `halves`, 2 * GCDT_SCAN_LANES words, is free before. The half that is returned has
// value(0) + ... + value(lane) for each lane, and is ready for all. A step adds from one half to the other.
GCDT_GIVEN_LOCAL local const u32* group_scan(local u32* halves, u32 lane, u32 lanes, u32 value) {
  local u32 *sums = halves, *other = halves + GCDT_SCAN_LANES;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane < lanes) sums[lane] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (u32 step = 1; step < lanes; step *= 2) {
    if (lane < lanes) other[lane] = sums[lane] + (lane >= step ? sums[lane - step] : 0u);
    barrier(CLK_LOCAL_MEM_FENCE);
    local u32* added = other;
    other = sums;
    sums = added;
  }
  return sums;
}

// One work-group per part.
// Reads: in. Writes: sums.
// One word a part, written by the owner's first work-item.
// After: sums[p] is the sum of part p.
kernel void scan_sum_group(u32 count, u32 span, u32 parts, global const u32* in, global u32* sums) {
  local u32 halves[2u * GCDT_SCAN_LANES];
  const u32 lane = get_local_id(0), lanes = min((u32)get_local_size(0), GCDT_SCAN_LANES);
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 sum = 0;
    if (lane < lanes)
      for (u32 i = begin + lane; i < end; i += lanes) sum += in[i];
    local const u32* upto = group_scan(halves, lane, lanes, sum);
    if (lane == 0) sums[part] = upto[lanes - 1];
  }
}

// One work-group per part. Adding up the sums of the parts before costs a few loads a work-item and
// saves the usual middle launch.
// Reads: in, sums of the parts before. Writes: out; it may be in, each word being read before.
// out[i] belongs to the work-item that reads element i, out[count] to the last part's first one.
// After: out is the exclusive scan of in, total included. With one part, sums are not read.
kernel void scan_group(u32 count, u32 span, u32 parts, global const u32* in, global const u32* sums, global u32* out) {
  local u32 halves[2u * GCDT_SCAN_LANES];
  const u32 lane = get_local_id(0), lanes = min((u32)get_local_size(0), GCDT_SCAN_LANES);
  for (u32 part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 before = 0;
    if (lane < lanes)
      for (u32 p = lane; p < part; p += lanes) before += sums[p];
    u32 running = group_scan(halves, lane, lanes, before)[lanes - 1];
    for (u32 tile = begin; tile < end; tile += lanes * GCDT_SCAN_WIDTH) {
      const u32 first = tile + lane * GCDT_SCAN_WIDTH;
      u32 value[GCDT_SCAN_WIDTH], sum = 0;
      for (u32 j = 0; j < GCDT_SCAN_WIDTH; ++j) {
        value[j] = lane < lanes && first + j < end ? in[first + j] : 0;
        sum += value[j];
      }
      local const u32* upto = group_scan(halves, lane, lanes, sum);
      u32 prefix = running + (lane > 0 && lane < lanes ? upto[lane - 1] : 0);
      for (u32 j = 0; j < GCDT_SCAN_WIDTH; ++j) {
        if (lane < lanes && first + j < end) out[first + j] = prefix;
        prefix += value[j];
      }
      running += upto[lanes - 1];
    }
    if (lane == 0 && end == count) out[count] = running;
  }
}
