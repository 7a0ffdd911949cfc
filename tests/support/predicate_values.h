// SPDX-License-Identifier: Apache-2.0
// Every predicate of a tuple, once for host and device: the test adds this file to a program that has the predicates.
// OpenCL C and C++17.
#ifndef GCDT_PREDICATE_VALUES_H
#define GCDT_PREDICATE_VALUES_H

#include "common/predicates.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// Four vertices, at most three of them symbolic and all symbols distinct, and division point k of n.
typedef struct PredicateTuple {
  Vertex a, b, c, d;
  u32 k, n;
} PredicateTuple;

// Every predicate of one tuple. No padding: results are compared byte for byte.
typedef struct PredicateValues {
  i64 orient2d;
  u64 mul_high, mul_high_limbs;
  u64 product_low;
  i64 product_high;
  i32 incircle, must_flip, division, padding;
} PredicateValues;

// Words that fill all 64 bits, for the products.
GCDT_INLINE u64 gcdt_mixed_word(Vertex v, u32 salt) {
  const u64 word = ((u64)v.x << 32 ^ (u64)v.y ^ salt) * 0x9E3779B97F4A7C15ul;
  return word ^ word >> 29;
}

GCDT_INLINE PredicateValues gcdt_evaluate_predicates(PredicateTuple t) {
  const u64 left = gcdt_mixed_word(t.a, t.k), right = gcdt_mixed_word(t.b, t.n);
  const Int128 product = gcdt_multiply((i64)left, (i64)right);
  PredicateValues r;
  r.orient2d = gcdt_orient2d(t.a, t.b, t.c);
  r.mul_high = gcdt_mul_high(left, right);
  r.mul_high_limbs = gcdt_mul_high_limbs(left, right);
  r.product_low = product.low;
  r.product_high = product.high;
  r.incircle = gcdt_incircle(t.a, t.b, t.c, t.d);
  r.must_flip = gcdt_must_flip(t.a, t.b, t.c, t.d);
  r.division = (t.c.symbol | t.d.symbol) == 0 ? gcdt_orient2d_division(t.a, t.b, t.c, t.d, t.k, t.n) : 0;
  r.padding = 0;
  return r;
}

#ifdef __OPENCL_VERSION__
kernel void evaluate_predicates(u32 count, global const PredicateTuple* tuples, global PredicateValues* values) {
  FOR_EACH(i, count) values[i] = gcdt_evaluate_predicates(tuples[i]);
}
#else
static_assert(sizeof(Vertex) == 24 && sizeof(PredicateTuple) == 104 && sizeof(PredicateValues) == 56,
              "the records have the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif
