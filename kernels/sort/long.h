// SPDX-License-Identifier: Apache-2.0
// Runs and buckets that are too long to be put in order where they stand. OpenCL C only.
#ifndef GCDT_LONG_H
#define GCDT_LONG_H

#include "common/shared.h"

// The list of long buckets: of how many the pairs will be taken out; how many there are; their numbers.
#define LONG_BUCKETS 2u

// Where the run that begins at `begin` ends, or `outside`, if that is in it. Ends: the range halves.
GCDT_INLINE u32 end_of_run(u32 low, global const u64* keys, u32 begin, u32 outside) {
  const u64 high = keys[begin] >> low;
  u32 inside = begin;
  while (outside - inside > 1u) {
    const u32 middle = inside + (outside - inside) / 2u;
    if (keys[middle] >> low == high)
      inside = middle;
    else
      outside = middle;
  }
  return outside;
}

#endif
