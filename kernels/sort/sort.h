// SPDX-License-Identifier: Apache-2.0
// One pass of a stable radix sort of (KEY, u32) pairs: count digits, scan the table, move the pairs.
// The programs sort{32,64}_{serial,group}.cl define KEY; sort_serial.h and sort_group.h have the kernels.
// Parts, *_serial and *_group: as in primitives.cl.
//
// table[digit * parts + part] holds how many keys of the part have the digit. Its exclusive scan is
// where the part's first such key goes: after all smaller digits, and after equal ones of parts before.
#ifndef GCDT_SORT_H
#define GCDT_SORT_H

#include "common/shared.h"
#include "sort/sizes.h"

GCDT_INLINE u32 digit_of(KEY key, u32 shift, u32 mask) { return (u32)(key >> shift) & mask; }

#endif
