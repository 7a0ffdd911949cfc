// SPDX-License-Identifier: Apache-2.0
// From the bits of a double to an integer on the grid, exactly. OpenCL C and C++17.
//
// No floating-point operation is used: the result is the same on devices without fp64 and under any
// compiler flags. A double is handled as its 64 bits, v = (-1)^s * m * 2^q with integers m < 2^53 and
// q >= -1074; ulp(v) = 2^q, so m >= 2^52 unless q = -1074.
#ifndef GCDT_QUANTISE_H
#define GCDT_QUANTISE_H

#include "common/int128.h"

#ifdef __OPENCL_VERSION__
#define GCDT_GLOBAL global
#define GCDT_CONSTANT_TABLE constant
#else
#define GCDT_GLOBAL
#define GCDT_CONSTANT_TABLE inline constexpr
namespace gcdt::device {
#endif

// ---- The bits of a double -------------------------------------------------------------------------

#define GCDT_SIGN_BIT 0x8000000000000000ul
#define GCDT_INFINITE_BITS 0x7FF0000000000000ul
#define GCDT_HIDDEN_BIT 0x0010000000000000ul
#define GCDT_LEAST_EXPONENT (-1074)

// How coordinates lie in the staging buffer: the 64-bit types one per word, the 32-bit types two per word.
#define GCDT_COORDINATES_FLOAT64 0u
#define GCDT_COORDINATES_FLOAT32 1u
#define GCDT_COORDINATES_INT32 2u
#define GCDT_COORDINATES_INT64 3u

GCDT_INLINE i32 gcdt_leading_zeros(u64 v) {
#ifdef __OPENCL_VERSION__
  return (i32)clz(v);
#elif defined(__GNUC__)
  return v == 0 ? 64 : __builtin_clzll(v);
#else
  i32 zeros = 64;
  for (; v != 0; v >>= 1) --zeros;
  return zeros;
#endif
}
GCDT_INLINE i32 gcdt_bit_length(u64 v) { return 64 - gcdt_leading_zeros(v); }

GCDT_INLINE u64 gcdt_magnitude(u64 bits) { return bits & ~GCDT_SIGN_BIT; }
GCDT_INLINE u32 gcdt_is_finite(u64 bits) { return gcdt_magnitude(bits) < GCDT_INFINITE_BITS; }
// -0 counts as 0.
GCDT_INLINE u64 gcdt_without_negative_zero(u64 bits) { return bits == GCDT_SIGN_BIT ? 0 : bits; }

GCDT_INLINE u64 gcdt_mantissa(u64 bits) {
  const u64 field = gcdt_magnitude(bits) >> 52, fraction = bits & (GCDT_HIDDEN_BIT - 1);
  return field == 0 ? fraction : fraction | GCDT_HIDDEN_BIT;
}
GCDT_INLINE i32 gcdt_exponent(u64 bits) {
  const i32 field = (i32)(gcdt_magnitude(bits) >> 52);
  return field == 0 ? GCDT_LEAST_EXPONENT : field + (GCDT_LEAST_EXPONENT - 1);
}
// The largest e such that the nonzero double is a multiple of 2^e.
GCDT_INLINE i32 gcdt_trailing_exponent(u64 bits) {
  const u64 m = gcdt_mantissa(bits);
  return gcdt_exponent(bits) + gcdt_bit_length(m & (~m + 1)) - 1;
}

// Unsigned integers in the order of the doubles, and back.
GCDT_INLINE u64 gcdt_ordered(u64 bits) { return (bits & GCDT_SIGN_BIT) ? ~bits : bits | GCDT_SIGN_BIT; }
GCDT_INLINE u64 gcdt_from_ordered(u64 key) { return (key & GCDT_SIGN_BIT) ? key & ~GCDT_SIGN_BIT : ~key; }

// The double of a float's bits: exact, infinities and NaNs stay so.
GCDT_INLINE u64 gcdt_double_of_float(u32 bits) {
  const u64 sign = (u64)(bits >> 31) << 63;
  const u64 field = (bits >> 23) & 0xFFu, fraction = bits & 0x7FFFFFu;
  if (field == 0xFFu) return sign | GCDT_INFINITE_BITS | (fraction << 29);
  if (field != 0) return sign | ((field + (1023 - 127)) << 52) | (fraction << 29);
  if (fraction == 0) return sign;
  // Denormal: fraction * 2^-149; the leading bit becomes the hidden one.
  const i32 length = gcdt_bit_length(fraction);
  return sign | ((u64)(length - 1 - 149 + 1023) << 52) | ((fraction << (53 - length)) & (GCDT_HIDDEN_BIT - 1));
}
// The double of an integer from its sign bit and magnitude, which is at most 2^53: exact.
GCDT_INLINE u64 gcdt_double_of_whole(u64 sign, u64 value) {
  if (value == 0) return 0;
  const i32 length = gcdt_bit_length(value);
  const u64 fraction = length > 53 ? 0 : value << (53 - length);
  return sign | ((u64)(length - 1 + 1023) << 52) | (fraction & (GCDT_HIDDEN_BIT - 1));
}
GCDT_INLINE u64 gcdt_double_of_int(u32 bits) {
  return gcdt_double_of_whole((u64)(bits >> 31) << 63, (bits >> 31) ? (u32)(~bits + 1u) : bits);
}
// Beyond 2^53 in magnitude infinity, as some have no double.
GCDT_INLINE u64 gcdt_double_of_long(u64 bits) {
  const u64 sign = bits & GCDT_SIGN_BIT, value = sign ? ~bits + 1u : bits;
  return value > 2 * GCDT_HIDDEN_BIT ? sign | GCDT_INFINITE_BITS : gcdt_double_of_whole(sign, value);
}

// Coordinate `index` = 2 * vertex + axis as it is given: its own bits are the lowest.
GCDT_INLINE u64 gcdt_given_coordinate(GCDT_GLOBAL const u64* coordinates, u32 type, u32 index) {
  if (type == GCDT_COORDINATES_FLOAT64 || type == GCDT_COORDINATES_INT64) return coordinates[index];
  return coordinates[index >> 1] >> (32u * (index & 1u));
}
// The same as the bits of a double, -0 made 0.
GCDT_INLINE u64 gcdt_double_of_given(u64 given, u32 type) {
  if (type == GCDT_COORDINATES_FLOAT64) return gcdt_without_negative_zero(given);
  if (type == GCDT_COORDINATES_FLOAT32) return gcdt_without_negative_zero(gcdt_double_of_float((u32)given));
  return gcdt_double_of_long(type == GCDT_COORDINATES_INT64 ? given : (u64)(i64)(i32)(u32)given);
}
GCDT_INLINE u64 gcdt_coordinate(GCDT_GLOBAL const u64* coordinates, u32 type, u32 index) {
  return gcdt_double_of_given(gcdt_given_coordinate(coordinates, type, index), type);
}

// ---- Numbers of 128 bits: (low, high) = low + 2^64 high ----------------------------------------------

// The 64 bits that (high, low) * 2^shift has at bits 0 .. 63.
GCDT_INLINE u64 gcdt_limb(u64 low, u64 high, i32 shift) {
  if (shift >= 64 || shift <= -128) return 0;
  if (shift >= 0) return low << shift;
  if (shift > -64) return (low >> -shift) | (high << (64 + shift));
  return high >> (-64 - shift);
}

// Whether (high, low) * 2^shift has bits below bit 0.
GCDT_INLINE u32 gcdt_loses_bits(u64 low, u64 high, i32 shift) {
  if (shift >= 0) return 0;
  if (shift <= -128) return (low | high) != 0;
  if (shift > -64) return (low << (64 + shift)) != 0;
  return low != 0 || (shift != -64 && (high << (128 + shift)) != 0);
}

GCDT_INLINE u32 gcdt_below(u64 a_low, u64 a_high, u64 b_low, u64 b_high) {
  return a_high < b_high || (a_high == b_high && a_low < b_low);
}

// ---- Grids whose cell is a power of two or given --------------------------------------------------
//
// Wanted: X = round_half_even((x - o) * five / (2^k * U)) for doubles x and o, five = 5^d <= 5^22 < 2^52,
// U < 2^116: the cell is 2^k * U / five. Ties lie where (x - o) * five / 2^k is an odd multiple of U/2.
//
// A = x * five / 2^k and B = o * five / 2^k are integers below 2^105 times a power of two. They are
// written into 256-bit two's complement windows in units of 2^w,
//   w = min(floor(log2 U) - 108, -2),
// where the lowest bit is set if A has any bit at or below it ("odd"): then A lies strictly between
// the two even numbers around it, or on the odd one. T = U / 2^w is the cell in those units. As
// w <= -2, every tie (2 X + 1) T / 2 is even. So:
//  * Neither is odd: the difference D of the windows is exact.
//  * One is odd: D is odd, and the true difference lies between the same even numbers, so that each
//    comparison with a tie comes out right.
//  * Both are odd: the lowest bit of A is at most w, and A has at most 105 bits: |A|, |B| < 2^(w+105),
//    |A - B| < 2^(w+106) <= U/4, and X = 0. D is made odd, so that it does not read as "not moved".
// Range: |A| < 2^254 units or it is said not to fit. L: for doubles x != o, |x - o| >= 2^-54 |x|. (Let
// |x| >= |o|. If o has the other sign, is zero or |o| <= |x|/2, then |x - o| >= |x|/2. Else ulp(o) >=
// ulp(x)/2, both are multiples of ulp(o), and |x - o| >= ulp(x)/2 >= 2^-54 |x|; |o| is no larger.) If A
// or B does not fit, it is at least 2^(254+w) >= 2^136 U, as 254 + w - log2 U > 254 - 2 - 116, and by L
// the distance is over 2^82 cells: outside the grid, unless x = o, where X = 0.
#define GCDT_WINDOW_LIMBS 4
#define GCDT_UNIT_BITS 108
#define GCDT_GRID_LAST 0x7FFFFFFFu

typedef struct Scale {
  u64 origin[2];                            // the bits of the origin, -0 made 0
  u64 origin_window[2][GCDT_WINDOW_LIMBS];  // B of each axis
  u64 five;
  u64 cell_low, cell_high;  // T
  i32 offset;               // -k - w: a mantissa's exponent q stands at window bit q + offset
  u32 origin_fits[2];
  u32 power_of_two;        // T = 2^108
  u32 fixed_point[2];      // of each axis: origin_fixed can be used
  u32 whole;               // the origin is 0, 0 and the cell 1, so that whole numbers stay as they are
  u32 unused;              // so that devices and host lay it out alike
  u64 origin_fixed[2][2];  // of each axis, low and high word, see gcdt_quantise_fixed
} Scale;

typedef struct Quantised {
  u32 value;    // X
  u32 outside;  // nonzero: X is not in [0, 2^31 - 1]
  u64 move;     // how far x moved, as gcdt_move_key
} Quantised;

// Writes the double times five into the window; 0 if it does not fit.
GCDT_INLINE u32 gcdt_place(u64 bits, u64 five, i32 offset, u64* window) {
  const u64 m = gcdt_mantissa(bits);
  const u64 low = m * five, high = gcdt_mul_high(m, five);
  const i32 shift = gcdt_exponent(bits) + offset;
  const i32 length = high != 0 ? 64 + gcdt_bit_length(high) : gcdt_bit_length(low);
  if (shift + length > 254) return 0;
  // (high, low) * 2^shift = (top, middle, bottom) at limb `first`.
  const i32 first = shift >> 6, up = shift & 63;
  const u64 bottom = low << up, middle = (high << up) | (low >> 1 >> (63 - up)), top = high >> 1 >> (63 - up);
  const u64 lost = (first < 0 ? bottom : 0) | (first < -1 ? middle : 0) | (first < -2 ? top : 0);
  const u64 flip = (bits & GCDT_SIGN_BIT) ? ~(u64)0 : 0;
  u64 carry = flip & 1;
  for (i32 i = 0; i < GCDT_WINDOW_LIMBS; ++i) {
    u64 limb = (i == first ? bottom : 0) | (i == first + 1 ? middle : 0) | (i == first + 2 ? top : 0);
    if (i == 0 && lost != 0) limb |= 1;
    window[i] = (limb ^ flip) + carry;
    carry &= window[i] == 0 ? 1 : 0;
  }
  return 1;
}

// A 64-bit number in the order of the 128-bit ones, good to 56 bits: bit length, then the leading 56
// bits, the last of them set if any bit below is set. 0 for 0 only.
GCDT_INLINE u64 gcdt_move_key(u64 low, u64 high) {
  const i32 length = high != 0 ? 64 + gcdt_bit_length(high) : gcdt_bit_length(low);
  if (length == 0) return 0;
  const i32 shift = 56 - length;
  return ((u64)length << 56) | gcdt_limb(low, high, shift) | gcdt_loses_bits(low, high, shift);
}

// Where the cell is a power of two, 128 bits are enough for nearly all doubles: numbers in units of 2^-64 cells, that
// is 2^44 units of the window. The magnitude of a double is such a number below 2^126 iff its mantissa's place there
// lies from 0 to 73, or bits that it would lose are zero. Returns whether it is; then *low and *high hold it.
#define GCDT_FIXED_BITS 64
GCDT_INLINE u32 gcdt_fixed(u64 bits, i32 offset, u64* low, u64* high) {
  const i32 shift = gcdt_exponent(bits) + offset - (GCDT_UNIT_BITS - GCDT_FIXED_BITS);
  const u64 m = gcdt_mantissa(bits);
  if (shift > 0 && shift < 64) {  // nearly all
    *low = m << shift;
    *high = m >> (64 - shift);
    return 1;
  }
  *low = *high = 0;
  if (shift > 73 || shift <= -64) return shift < 0 && m == 0;
  if (shift >= 64) {
    *high = m << (shift - 64);
    return 1;
  }
  *low = m >> -shift;
  return *low << -shift == m;
}

// The same as gcdt_quantise_rest if both numbers are such: |D| = 2^64 X + remainder, which is 2^44 times that of the
// window.
GCDT_INLINE Quantised gcdt_quantise_fixed(u64 low, u64 high, u32 minus, u64 origin_low, u64 origin_high, u64* rest) {
  Quantised result;
  result.value = 0;
  result.outside = 1;
  result.move = 0;
  if (minus) {
    high = ~high + (low == 0 ? 1 : 0);
    low = ~low + 1;
  }
  high = high - origin_high - (low < origin_low ? 1 : 0);
  low -= origin_low;
  const u32 negative = (u32)(high >> 63);
  if (negative) {
    high = ~high + (low == 0 ? 1 : 0);
    low = ~low + 1;
  }
  if ((high >> 31) != 0) return result;
  u32 x = (u32)high;
  const u64 middle = (u64)1 << (GCDT_FIXED_BITS - 1);
  if (low > middle || (low == middle && (x & 1u))) {
    x += 1u;
    low = ~low + 1;
  }
  result.value = x;
  result.outside = x > GCDT_GRID_LAST || (negative && x != 0);
  *rest = low;
  return result;
}

// The key of a move of so many units of 2^-64 cells. It grows with them.
GCDT_INLINE u64 gcdt_rest_key(u64 rest) {
  return gcdt_move_key(rest << (GCDT_UNIT_BITS - GCDT_FIXED_BITS), rest >> (2 * GCDT_FIXED_BITS - GCDT_UNIT_BITS));
}

GCDT_INLINE void gcdt_negate_window(u64* d) {
  u64 carry = 1;
  for (i32 i = 0; i < GCDT_WINDOW_LIMBS; ++i) {
    d[i] = ~d[i] + carry;
    carry &= d[i] == 0 ? 1 : 0;
  }
}

// As gcdt_quantise, but that the move of nearly all is in *rest, in units of 2^-64 cells, and result.move 0 then. Of
// the others *rest is 0.
GCDT_INLINE Quantised gcdt_quantise_rest(u64 bits, GCDT_GLOBAL const Scale* scale, i32 axis, u64* rest) {
  Quantised result;
  *rest = 0;
  result.value = 0;
  result.outside = 0;
  result.move = 0;
  if (bits == scale->origin[axis]) return result;
  u64 fixed_low, fixed_high;
  if (scale->fixed_point[axis] && gcdt_fixed(bits, scale->offset, &fixed_low, &fixed_high))
    return gcdt_quantise_fixed(fixed_low, fixed_high, (bits & GCDT_SIGN_BIT) != 0, scale->origin_fixed[axis][0],
                               scale->origin_fixed[axis][1], rest);
  u64 d[GCDT_WINDOW_LIMBS];
  result.outside = 1;
  if (!scale->origin_fits[axis] || !gcdt_place(bits, scale->five, scale->offset, d)) return result;
  const u64 both_odd = d[0] & scale->origin_window[axis][0] & 1;
  u64 borrow = 0;
  for (i32 i = 0; i < GCDT_WINDOW_LIMBS; ++i) {
    const u64 a = d[i], b = scale->origin_window[axis][i];
    d[i] = a - b - borrow;
    borrow = a < b || (a == b && borrow != 0) ? 1 : 0;
  }
  d[0] |= both_odd;
  const u32 negative = (d[GCDT_WINDOW_LIMBS - 1] >> 63) != 0;
  if (negative) gcdt_negate_window(d);
  // Now |D| = T X + remainder, X < 2^31 or outside: |D| / 2^31 < T < 2^118.
  const u64 t_low = scale->cell_low, t_high = scale->cell_high;
  u64 low = (d[0] >> 31) | (d[1] << 33), high = (d[1] >> 31) | (d[2] << 33);
  if (d[3] != 0 || (d[2] >> 31) != 0 || !gcdt_below(low, high, t_low, t_high)) return result;
  u32 x = 0;
  if (scale->power_of_two) {
    x = (u32)((d[1] >> (GCDT_UNIT_BITS - 64)) | (d[2] << (128 - GCDT_UNIT_BITS)));
    low = d[0];
    high = d[1] & (((u64)1 << (GCDT_UNIT_BITS - 64)) - 1);
  } else {
    for (i32 bit = 30; bit >= 0; --bit) {
      high = (high << 1) | (low >> 63);
      low = (low << 1) | ((d[0] >> bit) & 1);
      x <<= 1;
      if (gcdt_below(low, high, t_low, t_high)) continue;
      high = high - t_high - (low < t_low ? 1 : 0);
      low -= t_low;
      x |= 1u;
    }
  }
  // rest = T - remainder; rounded up if it is less, or equal and X odd.
  const u64 rest_low = t_low - low, rest_high = t_high - high - (t_low < low ? 1 : 0);
  const u32 tie = rest_low == low && rest_high == high;
  if (gcdt_below(rest_low, rest_high, low, high) || (tie && (x & 1u))) {
    x += 1u;
    low = rest_low;
    high = rest_high;
  }
  result.value = x;
  result.outside = x > GCDT_GRID_LAST || (negative && x != 0);
  result.move = gcdt_move_key(low, high);
  return result;
}

GCDT_INLINE Quantised gcdt_quantise(u64 bits, GCDT_GLOBAL const Scale* scale, i32 axis) {
  u64 rest;
  Quantised result = gcdt_quantise_rest(bits, scale, axis, &rest);
  if (rest != 0) result.move = gcdt_rest_key(rest);
  return result;
}
#ifndef __OPENCL_VERSION__
static_assert(sizeof(Scale) == 17 * sizeof(u64) + 8 * sizeof(u32), "Scale has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif
