// SPDX-License-Identifier: Apache-2.0
// The radix sort of keys of 32 bits by single work-items, for CPUs.
#define KEY u32
#include "sort/sort_serial.h"
