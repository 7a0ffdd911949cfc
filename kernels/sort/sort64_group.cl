// SPDX-License-Identifier: Apache-2.0
// The radix sort of keys of 64 bits by whole work-groups, for GPUs.
#define KEY u64
#include "sort/sort_group.h"
