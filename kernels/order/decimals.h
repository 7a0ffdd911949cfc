// SPDX-License-Identifier: Apache-2.0
// From the bits of a double that reads as a decimal number to an integer on a decimal grid, exactly. OpenCL C and
// C++17.
#ifndef GCDT_DECIMALS_H
#define GCDT_DECIMALS_H

#include "order/quantise.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

#define GCDT_MAX_DECIMALS 22
#define GCDT_NUMERATOR_OVERFLOW 0x8000000000000000ul

// clang-format off
GCDT_CONSTANT_TABLE u64 gcdt_powers_of_five[GCDT_MAX_DECIMALS + 1] = {
    1ul, 5ul, 25ul, 125ul, 625ul, 3125ul, 15625ul, 78125ul, 390625ul, 1953125ul, 9765625ul, 48828125ul, 244140625ul,
    1220703125ul, 6103515625ul, 30517578125ul, 152587890625ul, 762939453125ul, 3814697265625ul, 19073486328125ul,
    95367431640625ul, 476837158203125ul, 2384185791015625ul};
// clang-format on

// X = (S(x) - least) * step, S(x) = the numerator of x in units of 10^-digits.
typedef struct Decimals {
  i64 least[2];
  u64 step;
  i32 digits;
  u32 padding;
} Decimals;

// Whether |v| is the double nearest to N / 10^d for an integer N, and that N: the nearest to |v| 10^d (half
// to even), or the other neighbour if only that one reads as v. An N of 2^63 or more is returned as
// GCDT_NUMERATOR_OVERFLOW. If it holds for d, it holds for d + 1 (10 N).
//
// |v| 10^d = M 2^-s with M = m 5^d < 2^105 and s = -(q + d). For s > 0 let R = M - N 2^s; then
// v - N / 10^d = R 2^q / 5^d. Half the gap above v is 2^q / 2, so N / 10^d > v reads as v iff 2 |R| < 5^d
// (5^d is odd: no tie). The same below, but 4 |R| < 5^d where the gap below is half as wide.
// s >= 106: N = 0 has R = M >= 5^d, and N >= 1 has |R| >= 2^s - M > 2^104: neither reads as v.
GCDT_INLINE u32 gcdt_decimal(u64 bits, i32 d, u64* numerator) {
  const u64 m = gcdt_mantissa(bits), five = gcdt_powers_of_five[d];
  const u64 low = m * five, high = gcdt_mul_high(m, five);
  const i32 s = -(gcdt_exponent(bits) + d);
  *numerator = 0;
  if (m == 0) return 1;
  if (s <= 0) {
    const u32 fits = high == 0 && gcdt_bit_length(low) - s < 64;
    *numerator = fits ? low << -s : GCDT_NUMERATOR_OVERFLOW;
    return 1;
  }
  if (s >= 106) return 0;
  // below = M mod 2^s, above = 2^s - below.
  const u64 mask_low = s >= 64 ? ~(u64)0 : ((u64)1 << s) - 1, mask_high = s <= 64 ? 0 : ((u64)1 << (s - 64)) - 1;
  const u64 below = low & mask_low, below_high = high & mask_high;
  const u64 above = (~below & mask_low) + 1;  // wraps to 0 if below is 0 in this limb
  const u64 above_high = (~below_high & mask_high) + (above == 0 ? 1 : 0);
  const u32 narrow = m == GCDT_HIDDEN_BIT && gcdt_exponent(bits) > GCDT_LEAST_EXPONENT;
  // five < 2^52: compare before doubling, so that nothing overflows.
  const u32 lower = below_high == 0 && below < GCDT_HIDDEN_BIT && (below << (narrow ? 2 : 1)) < five;
  const u32 upper = above_high == 0 && above != 0 && above < GCDT_HIDDEN_BIT && (above << 1) < five;
  if (!lower && !upper) return 0;
  const u64 floor_low = gcdt_limb(low, high, -s), floor_high = gcdt_limb(low, high, -s - 64);
  const u32 nearer = gcdt_below(above, above_high, below, below_high) ||
                     (above == below && above_high == below_high && (floor_low & 1));
  const u32 up = upper && (nearer || !lower);
  const u32 overflow = floor_high != 0 || floor_low >= GCDT_NUMERATOR_OVERFLOW - up;
  *numerator = overflow ? GCDT_NUMERATOR_OVERFLOW : floor_low + up;
  return 1;
}

// The least number of decimals >= `from` and <= `limit` with which v can be written; limit + 1 if none.
GCDT_INLINE i32 gcdt_decimals_needed(u64 bits, i32 from, i32 limit) {
  u64 numerator;
  while (from <= limit && !gcdt_decimal(bits, from, &numerator)) ++from;
  return from;
}

// S(v): the numerator of v with the fewest decimals, in units of 10^-digits; v can be written with `digits`
// decimals. GCDT_NUMERATOR_OVERFLOW (the least i64) if it is not below 2^63.
//
// An N < 2^51 that reads as v with `digits` decimals is the only one that does, hence that numerator already: with
// w = 2^q 10^digits, numbers that read as v lie at most w / 2 from |v| 10^digits. If m >= 2^52, that is at least 2^52
// w, so w <= N / (2^52 - 1/2) < 1; if m is less, q = -1074 and w < 1. Two of them would be less than 1 apart.
GCDT_INLINE i64 gcdt_decimal_numerator(u64 bits, i32 digits) {
  u64 numerator, fewer;
  gcdt_decimal(bits, digits, &numerator);
  if (numerator < GCDT_HIDDEN_BIT / 2) return (bits & GCDT_SIGN_BIT) ? -(i64)numerator : (i64)numerator;
  i32 d = digits;
  while (d > 0 && gcdt_decimal(bits, d - 1, &fewer)) {
    numerator = fewer;
    --d;
  }
  // 10^(digits - d) in two factors: 5^22 and 2^22 each times a number below 2^63 stays below 2^128.
  const u64 five = gcdt_powers_of_five[digits - d];
  const u64 scaled = numerator * five;
  if (gcdt_mul_high(numerator, five) != 0 || gcdt_bit_length(scaled) + (digits - d) > 63)
    return (i64)GCDT_NUMERATOR_OVERFLOW;
  const i64 value = (i64)(scaled << (digits - d));
  return (bits & GCDT_SIGN_BIT) ? -value : value;
}

// Where a vertex is placed on one axis of a decimal grid. It has at most so many decimals.
GCDT_INLINE u32 gcdt_place_decimal(u64 bits, u32 axis, GCDT_GLOBAL const Decimals* decimals) {
  const i64 numerator = gcdt_decimal_numerator(bits, decimals->digits);
  return (u32)(((u64)numerator - (u64)decimals->least[axis]) * decimals->step);
}

// The grid coordinate on one axis of a point that is no vertex. Where the grid was chosen for decimals, a double that
// is one is taken for it, as for vertices; all others are rounded by `scale`.
GCDT_INLINE Quantised gcdt_place_query(u64 bits, u32 by_decimals, GCDT_GLOBAL const Scale* scale,
                                       GCDT_GLOBAL const Decimals* decimals, u32 axis) {
  u64 numerator;
  if (by_decimals && gcdt_decimal(bits, decimals->digits, &numerator)) {
    const i64 wide = gcdt_decimal_numerator(bits, decimals->digits);
    const u64 from_least = (u64)wide - (u64)decimals->least[axis];
    if (wide != (i64)GCDT_NUMERATOR_OVERFLOW) {
      Quantised placed;
      placed.outside = wide < decimals->least[axis] || from_least > GCDT_GRID_LAST / decimals->step;
      placed.value = (u32)(from_least * decimals->step);
      placed.move = 0;
      return placed;
    }
  }
  return gcdt_quantise(bits, scale, (i32)axis);
}
#ifndef __OPENCL_VERSION__
static_assert(sizeof(Decimals) == 4 * sizeof(u64), "Decimals has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif
