// SPDX-License-Identifier: Apache-2.0
// The bits of a double, what they stand for, and the doubles of other numbers. OpenCL C and C++17.
//
// No floating-point operation is used: the result is the same on devices without fp64 and under any
// compiler flags. A double is handled as its 64 bits, v = (-1)^s * m * 2^q with integers m < 2^53 and
// q >= -1074; ulp(v) = 2^q, so m >= 2^52 unless q = -1074.
#ifndef GCDT_DOUBLES_H
#define GCDT_DOUBLES_H

#include "common/int128.h"

#ifdef __OPENCL_VERSION__
#define GCDT_GLOBAL global
#define GCDT_CONSTANT_TABLE constant
#else
#define GCDT_GLOBAL
#define GCDT_CONSTANT_TABLE inline constexpr
namespace gcdt::device {
#endif

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

// Coordinate `index` = 2 * vertex + axis as the bits of a double, -0 made 0.
GCDT_INLINE u64 gcdt_coordinate(GCDT_GLOBAL const u64* coordinates, u32 type, u32 index) {
  if (type == GCDT_COORDINATES_FLOAT64) return gcdt_without_negative_zero(coordinates[index]);
  if (type == GCDT_COORDINATES_INT64) return gcdt_double_of_long(coordinates[index]);
  const u32 bits = (u32)(coordinates[index >> 1] >> (32u * (index & 1u)));
  return gcdt_without_negative_zero(type == GCDT_COORDINATES_FLOAT32 ? gcdt_double_of_float(bits)
                                                                     : gcdt_double_of_int(bits));
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
#ifndef __OPENCL_VERSION__
}  // namespace gcdt::device
#endif

#endif
