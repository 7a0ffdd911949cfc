// SPDX-License-Identifier: Apache-2.0
// The radix sort of keys of 64 bits by single work-items, for CPUs.
#define KEY u64
#include "sort/sort_serial.h"
