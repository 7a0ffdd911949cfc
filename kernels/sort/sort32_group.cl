// SPDX-License-Identifier: Apache-2.0
// The radix sort of keys of 32 bits by whole work-groups, for GPUs.
#define KEY u32
#include "sort/sort_group.h"
