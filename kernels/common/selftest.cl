// SPDX-License-Identifier: Apache-2.0
// The operations that all exactness rests on, for the test at start-up (lib/device/selftest.cpp).
#include "common/int128.h"

// One work-item per row.
// Reads: operands, a and b a row. Writes: results, eight words a row.
// A row belongs to one work-item.
// After: results hold a * b (high, low, high by limbs), a + b and its carry, and a shifted by b mod 64.
kernel void selftest_words(u32 rows, global const u64* operands, global u64* results) {
  FOR_EACH(i, rows) {
    const u64 a = operands[2 * i], b = operands[2 * i + 1], sum = a + b;
    const u32 by = (u32)b & 63u;
    global u64* row = results + 8 * i;
    row[0] = gcdt_mul_high(a, b);
    row[1] = a * b;
    row[2] = gcdt_mul_high_limbs(a, b);
    row[3] = sum;
    row[4] = sum < a ? 1 : 0;
    row[5] = a << by;
    row[6] = a >> by;
    row[7] = (u64)((i64)a >> by);
  }
}

// One work-item per number i below count, a multiple of 32.
// Reads and writes: words, by atomics only: order cannot matter to the values they end with.
// After: words hold the sum, least, greatest of all i, a bit set and a bit cleared by each i mod 32, how
// many i there are, the sum of what the counter held before each, and how many won the compare-exchange.
kernel void selftest_atomics(u32 count, global u32* words) {
  FOR_EACH(i, count) {
    atomic_add(&words[0], i);
    atomic_min(&words[1], i + 5u);
    atomic_max(&words[2], i + 5u);
    atomic_or(&words[3], 1u << (i & 31u));
    atomic_and(&words[4], ~(1u << (i & 31u)));
    const u32 before = atomic_inc(&words[5]);
    atomic_add(&words[6], before);
    if (atomic_cmpxchg(&words[7], GCDT_NONE, i) == GCDT_NONE) atomic_inc(&words[8]);
  }
}
