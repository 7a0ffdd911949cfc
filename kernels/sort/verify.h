// SPDX-License-Identifier: Apache-2.0
// Whether pairs are in order. OpenCL C only.
#ifndef GCDT_VERIFY_H
#define GCDT_VERIFY_H

#include "common/shared.h"

// One work-item per pair. Writes 1 to *unordered if two neighbours are not in order. No race: all write the same.
kernel void sort_verify(u32 count, global const u64* keys, global u32* unordered) {
  FOR_EACH(i, max(count, 1u) - 1u)
  if (keys[i] > keys[i + 1u]) *unordered = 1u;
}

#endif
