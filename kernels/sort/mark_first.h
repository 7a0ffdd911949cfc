// SPDX-License-Identifier: Apache-2.0
// Where runs of equal keys begin, of sorted ones: vertices at one grid point, pieces with the same ends. OpenCL C only.
#ifndef GCDT_MARK_FIRST_H
#define GCDT_MARK_FIRST_H

#include "common/shared.h"

// Whether the first of equal keys stands at place i.
static inline bool is_first(global const ulong* keys, uint i) { return i == 0 || keys[i] != keys[i - 1]; }

// One work-item per place in the sorted order.
// Reads: keys, ascending. Writes: first[i] = 1 if the key at i differs from the one before, else 0.
// A place has one work-item.
// After this kernel the scan of `first` counts the distinct keys before each place.
kernel void mark_first(uint n, global const ulong* keys, global uint* first) {
  FOR_EACH(i, n) first[i] = is_first(keys, i) ? 1u : 0u;
}

#endif
