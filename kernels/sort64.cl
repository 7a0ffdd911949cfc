// SPDX-License-Identifier: Apache-2.0
// The radix sort's kernels for keys of 64 bits.
#define KEY u64
#include "sort.h"
