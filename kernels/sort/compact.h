// SPDX-License-Identifier: Apache-2.0
// The elements that are kept, listed by the scan of their flags. In the programs of both scans, so that a call needs
// one program for both. OpenCL C only.
#ifndef GCDT_COMPACT_H
#define GCDT_COMPACT_H

#include "common/shared.h"

// One work-item per element.
// Reads: offsets[0 .. count]. Writes: out.
// offsets[i] differs between any two elements that are kept: each raises the offset by one.
// After: out lists the kept elements, ascending.
kernel void compact_indices(u32 count, global const u32* offsets, global u32* out) {
  FOR_EACH(i, count)
  if (offsets[i + 1] != offsets[i]) out[offsets[i]] = i;
}

#endif
