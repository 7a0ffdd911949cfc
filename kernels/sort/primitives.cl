// SPDX-License-Identifier: Apache-2.0
// Exclusive scan and compaction (lib/mesh/primitives.cpp). No work-group ever waits for another.
//
// Parts. Elements 0 .. count-1 are cut into `parts` ranges of `span`, the last one shorter. The host
// chooses span by the device; groups take parts in turn, so a part has one owner under any launch
// geometry. Each step has two kernels of one meaning, in programs of their own because some drivers
// compile every kernel of a program:
//   *_serial  the group's first work-item walks the part alone. For CPUs, where a group is a loop of
//             one thread: a plain walk is the fastest there is, and lanes and barriers only cost.
//   *_group   the whole group walks the part in tiles. For GPUs: neighbours read neighbours.
#include "sort/compact.h"

// One work-group per part, its first work-item alone.
// Reads: in. Writes: sums.
// One word a part, and a part has one owner.
// After: sums[p] is the sum of part p.
kernel void scan_sum_serial(u32 count, u32 span, u32 parts, global const u32* in, global u32* sums) {
  if (get_local_id(0) != 0) return;
  FOR_EACH_OF_GROUPS(part, 0u, parts) {
    const u32 begin = part * span, end = min(begin + span, count);
    u32 sum = 0;
    for (u32 i = begin; i < end; ++i) sum += in[i];
    sums[part] = sum;
  }
}

// One work-group per part, its first work-item alone.
// Reads: in, sums of the parts before. Writes: out; it may be in, each word being read before.
// out[i] belongs to the owner of element i, out[count] to the last part.
// After: out is the exclusive scan of in, total included. With one part, sums are not read.
kernel void scan_serial(u32 count, u32 span, u32 parts, global const u32* in, global const u32* sums, global u32* out) {
  if (get_local_id(0) != 0) return;
  FOR_EACH_OF_GROUPS(part, 0u, parts) {
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
