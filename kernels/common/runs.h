// SPDX-License-Identifier: Apache-2.0
// A few pairs of a key and a value put in order by one work-item. OpenCL C only.
#ifndef GCDT_RUNS_H
#define GCDT_RUNS_H

#include "common/shared.h"

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

#endif
