// SPDX-License-Identifier: Apache-2.0
// Sorting by one work-group, in local memory. OpenCL C only.
#ifndef GCDT_SORT_IN_GROUP_H
#define GCDT_SORT_IN_GROUP_H

#include "common/shared.h"
#include "sort/sizes.h"

GCDT_INLINE bool comes_before(u64 key, u32 index, u64 other_key, u32 other_index) {
  return key < other_key || (key == other_key && index < other_index);
}

// One work-group, all of it with the same arguments. Puts up to GCDT_SORT_SMALL pairs in order of the bits `mask` of
// the key, equal ones in the order in which they were, where they stand: a bitonic sort by (key, index), in which what
// is missing to a power of two counts as greatest; then either array goes through local memory to its new order. In a
// step every pair of places has one work-item, which also reads and writes the same global words throughout; barriers
// stand between steps. Ends: `run` doubles, `step` halves.
GCDT_GIVEN_LOCAL void sort_in_group(u32 count, u64 mask, global u64* keys, global u32* values, local u64* moved,
                                    local u32* indices) {
  u32 size = 1;
  while (size < count) size *= 2u;
  barrier(CLK_LOCAL_MEM_FENCE);  // local memory may still be read by the call before
  for (u32 i = get_local_id(0); i < size; i += get_local_size(0)) {
    moved[i] = i < count ? keys[i] & mask : ~(u64)0;
    indices[i] = i;
  }
  for (u32 run = 2u; run <= size; run *= 2u)
    for (u32 step = run / 2u; step > 0u; step /= 2u) {
      barrier(CLK_LOCAL_MEM_FENCE);
      for (u32 i = get_local_id(0); i < size / 2u; i += get_local_size(0)) {
        const u32 low = 2u * i - (i & (step - 1u)), high = low + step;
        const bool ascending = (low & run) == 0u;
        const u64 a = moved[low], b = moved[high];
        const u32 ia = indices[low], ib = indices[high];
        if (comes_before(b, ib, a, ia) == ascending) {
          moved[low] = b, moved[high] = a;
          indices[low] = ib, indices[high] = ia;
        }
      }
    }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (u32 i = get_local_id(0); i < count; i += get_local_size(0)) moved[i] = keys[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  for (u32 i = get_local_id(0); i < count; i += get_local_size(0)) keys[i] = moved[indices[i]];
  barrier(CLK_LOCAL_MEM_FENCE);
  for (u32 i = get_local_id(0); i < count; i += get_local_size(0)) moved[i] = values[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  for (u32 i = get_local_id(0); i < count; i += get_local_size(0)) values[i] = (u32)moved[indices[i]];
}

#endif
