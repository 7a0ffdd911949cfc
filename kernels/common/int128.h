// SPDX-License-Identifier: Apache-2.0
// Signed 128-bit integers on two 64-bit limbs, two's complement. OpenCL C and C++17.
//
// Sums and differences wrap: an expression may leave the range in between as long as its final value
// fits, which every caller derives in place.
#ifndef GCDT_INT128_H
#define GCDT_INT128_H

#include "common/shared.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// Host compilers have such a type, and so may the one that a CPU's driver compiles kernels with; its own mul_hi may
// be made of 32-bit products.
#if defined(__SIZEOF_INT128__) && (!defined(__OPENCL_VERSION__) || defined(GCDT_CONTIGUOUS))
#define GCDT_HAS_INT128 1
#else
#define GCDT_HAS_INT128 0
#endif

typedef struct Int128 {
  u64 low;
  i64 high;
} Int128;

// High 64 bits of the unsigned product, from four 32x32 -> 64 products. Carry: the middle sum is at
// most 3 * (2^32 - 1) + (2^32 - 1)^2 < 2^64.
GCDT_INLINE u64 gcdt_mul_high_limbs(u64 a, u64 b) {
  const u64 a0 = a & 0xFFFFFFFFu, a1 = a >> 32, b0 = b & 0xFFFFFFFFu, b1 = b >> 32;
  const u64 low = a0 * b0, mid1 = a1 * b0, mid2 = a0 * b1;
  const u64 carry = (low >> 32) + (mid1 & 0xFFFFFFFFu) + (mid2 & 0xFFFFFFFFu);
  return a1 * b1 + (mid1 >> 32) + (mid2 >> 32) + (carry >> 32);
}

// GCDT_EMULATE_MUL_HI is set for devices whose mul_hi fails the start-up self-test.
GCDT_INLINE u64 gcdt_mul_high(u64 a, u64 b) {
#if GCDT_HAS_INT128 && !defined(GCDT_EMULATE_MUL_HI)
  __extension__ typedef unsigned __int128 wide;
  return (u64)(((wide)a * b) >> 64);
#elif defined(__OPENCL_VERSION__) && !defined(GCDT_EMULATE_MUL_HI)
  return mul_hi(a, b);
#else
  return gcdt_mul_high_limbs(a, b);
#endif
}

// a * b for any two signed words: the unsigned product less b * 2^64 if a < 0, less a * 2^64 if b < 0.
GCDT_INLINE Int128 gcdt_multiply(i64 a, i64 b) {
  Int128 r;
  r.low = (u64)a * (u64)b;
  r.high = (i64)(gcdt_mul_high((u64)a, (u64)b) - (a < 0 ? (u64)b : 0) - (b < 0 ? (u64)a : 0));
  return r;
}

GCDT_INLINE Int128 gcdt_add(Int128 a, Int128 b) {
  Int128 r;
  r.low = a.low + b.low;
  r.high = (i64)((u64)a.high + (u64)b.high + (r.low < a.low ? 1u : 0u));
  return r;
}

GCDT_INLINE int gcdt_sign128(Int128 a) {
  if (a.high < 0) return -1;
  return (a.high != 0 || a.low != 0) ? 1 : 0;
}

// Sign of a b + c d + e f, which must fit into 128 bits; partial sums need not.
GCDT_INLINE int gcdt_sign_of_products(i64 a, i64 b, i64 c, i64 d, i64 e, i64 f) {
#if GCDT_HAS_INT128 && !defined(GCDT_EMULATE_MUL_HI)
  // Unsigned, where sums wrap; products of signed numbers, which a processor has in one instruction.
  __extension__ typedef __int128 signed_wide;
  __extension__ typedef unsigned __int128 wide;
  const signed_wide sum =
      (signed_wide)((wide)((signed_wide)a * b) + (wide)((signed_wide)c * d) + (wide)((signed_wide)e * f));
  return sum < 0 ? -1 : sum != 0 ? 1 : 0;
#else
  return gcdt_sign128(gcdt_add(gcdt_add(gcdt_multiply(a, b), gcdt_multiply(c, d)), gcdt_multiply(e, f)));
#endif
}

GCDT_INLINE int gcdt_sign64(i64 a) { return (a > 0) - (a < 0); }

#ifndef __OPENCL_VERSION__
}  // namespace gcdt::device
#endif

#endif
