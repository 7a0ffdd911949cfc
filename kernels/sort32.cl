// SPDX-License-Identifier: Apache-2.0
// The radix sort's kernels for keys of 32 bits.
#define KEY u32
#include "sort.h"
