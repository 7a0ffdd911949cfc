// SPDX-License-Identifier: Apache-2.0
// Rows of maxima, one of each work-group: not every device has 64-bit atomics, and a maximum does not depend on the
// order of folding. OpenCL C only.
#ifndef GCDT_MAXIMA_H
#define GCDT_MAXIMA_H

#include "common/loops.h"
#include "common/shared.h"

// The vertices, of n, of this work-item in a table of `rows` groups' rows, in that of group `row`.
static inline Items items_of_row(uint n, uint row, uint rows) {
  const uint size = (uint)get_local_size(0);
  return items_of_share(n, row * size + (uint)get_local_id(0), rows * size);
}

// Writes the greatest of each column over the group, all of which calls it. `memory`: a word for each column and
// work-item. No race: between barriers a work-item reads what none of those writes that go on. Ends: `left` halves.
GCDT_GIVEN_LOCAL void put_greatest(private const ulong* own, uint columns, local ulong* memory, global ulong* row) {
  const uint size = (uint)get_local_size(0), i = (uint)get_local_id(0);
  for (uint c = 0; c < columns; ++c) memory[c * size + i] = own[c];
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint left = size; left > 1u;) {
    const uint half_of_left = (left + 1u) / 2u;
    for (uint c = 0; c < columns; ++c)
      if (i + half_of_left < left)
        memory[c * size + i] = max(memory[c * size + i], memory[c * size + i + half_of_left]);
    barrier(CLK_LOCAL_MEM_FENCE);
    left = half_of_left;
  }
  for (uint c = 0; c < columns; ++c)
    if (i == 0u) row[c] = memory[c * size];
  barrier(CLK_LOCAL_MEM_FENCE);
}

#endif
