// SPDX-License-Identifier: Apache-2.0
// Exact predicates on grid points in [0, S]^2, S = 2^31 - 1, and three symbolic vertices at infinity.
// OpenCL C and C++17. Paper: section 4 and appendix B.
//
// Symbolic vertices. p_k = M_k * D_k with 1 << M_0 << M_1 << M_2 and
//     D_0 = (-2^31, -1) left,   D_1 = (2^31, -1) right,   D_2 = (1, 2^31) up.
// (p_0, p_1, p_2) is counter-clockwise and holds every finite point strictly inside. Every predicate
// is a polynomial in the M_k whose leading coefficient has the sign computed here and is never zero,
// and an input has finitely many tuples: so real M_k exist for which all these signs are the signs of
// real points. A symbolic run is a run on n + 3 real points.
//
// Bits, all points finite:
//   differences   |.| <= S < 2^31
//   orient2d      twice the area of a triangle in a square of side S: |.| <= S^2 < 2^62
//   incircle      lifts (squared lengths) <= 2 S^2 < 2^63; minors (doubled areas) < 2^62; the value is
//                 six times the volume of a tetrahedron in a box S x S x S^2/2 around the centre, a third
//                 of the box at most: |.| <= S^4 < 2^124. Sums may wrap in between.
// With symbols: orient2d is a sum of homogeneous minors of at most 2^62 + 1; one symbol: < 2^62 + 2^31;
// two: |cross(D_i, D_j)| <= 2^62 + 1. Summed with wrap-around, exact in 64 bits.
#ifndef GCDT_PREDICATES_H
#define GCDT_PREDICATES_H

#include "common/int128.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// symbol 0: the finite point (x, y). symbol 1, 2, 3: p_0, p_1, p_2, and (x, y) = D_k.
typedef struct Vertex {
  i64 x, y;
  i32 symbol;
} Vertex;

GCDT_INLINE Vertex gcdt_finite_vertex(i64 x, i64 y) {
  Vertex v;
  v.x = x;
  v.y = y;
  v.symbol = 0;
  return v;
}

GCDT_INLINE Vertex gcdt_symbolic_vertex(int k) {
  const i64 b = (i64)1 << 31;
  Vertex v;
  v.x = k == 0 ? -b : k == 1 ? b : 1;
  v.y = k == 2 ? b : -1;
  v.symbol = k + 1;
  return v;
}

// The product of two differences of coordinates of finite points, each between -2^31 and 2^31: said to a GPU's
// compiler, since one multiplication does then what else takes four. A CPU has one of 64 bits.
GCDT_INLINE i64 gcdt_times(i64 d, i64 e) {
#ifdef GCDT_GPU
  return (i64)(i32)d * (i64)(i32)e;
#else
  return d * e;
#endif
}

// Twice the signed area of (a, b, c): > 0 counter-clockwise. All finite.
GCDT_INLINE i64 gcdt_orient2d_finite(Vertex a, Vertex b, Vertex c) {
  return gcdt_times(b.x - a.x, c.y - a.y) - gcdt_times(b.y - a.y, c.x - a.x);
}

// orient2d with at most two symbols; the value's sign is exact. With one symbol it is zero only if the
// two finite vertices are equal, with two never. Never asked with three. It is affine in each finite
// argument, which division points use.
GCDT_INLINE i64 gcdt_orient2d_any(Vertex a, Vertex b, Vertex c) {
  const u64 bc = (u64)b.x * (u64)c.y - (u64)b.y * (u64)c.x;
  const u64 ca = (u64)c.x * (u64)a.y - (u64)c.y * (u64)a.x;
  const u64 ab = (u64)a.x * (u64)b.y - (u64)a.y * (u64)b.x;
  return (i64)((a.symbol == 0 ? bc : 0) + (b.symbol == 0 ? ca : 0) + (c.symbol == 0 ? ab : 0));
}

// The same, in fewer steps where all are finite.
GCDT_INLINE i64 gcdt_orient2d(Vertex a, Vertex b, Vertex c) {
  if ((a.symbol | b.symbol | c.symbol) == 0) return gcdt_orient2d_finite(a, b, c);
  return gcdt_orient2d_any(a, b, c);
}

// The way from a finite vertex o to another one, with its squared length; or a symbol's direction, with nothing.
typedef struct Way {
  i64 x, y, lift;
} Way;

GCDT_INLINE Way gcdt_way(i64 x, i64 y) {
  Way w;
  w.x = x;
  w.y = y;
  w.lift = gcdt_times(x, x) + gcdt_times(y, y);
  return w;
}
GCDT_INLINE Way gcdt_way_finite(Vertex o, Vertex v) { return gcdt_way(v.x - o.x, v.y - o.y); }
GCDT_INLINE Way gcdt_way_to(Vertex o, Vertex v) { return v.symbol == 0 ? gcdt_way_finite(o, v) : gcdt_way(v.x, v.y); }

// orient2d(o, a, b) where o is finite, in one text for all: the cross product of the ways from o. (So b x o is part of
// it if a is finite, o x a if b is, as in orient2d_any.)
GCDT_INLINE i64 gcdt_orient2d_of_ways(Way a, Way b) { return a.x * b.y - a.y * b.x; }
GCDT_INLINE i64 gcdt_orient2d_from(Vertex o, Vertex a, Vertex b) {
  return gcdt_orient2d_of_ways(gcdt_way_to(o, a), gcdt_way_to(o, b));
}

// Sign of the in-circle determinant of (a, b, c, o), all finite, by the ways from o.
GCDT_INLINE int gcdt_incircle_of_ways(Way a, Way b, Way c) {
  const i64 bc = gcdt_times(b.x, c.y) - gcdt_times(b.y, c.x), ca = gcdt_times(c.x, a.y) - gcdt_times(c.y, a.x),
            ab = gcdt_times(a.x, b.y) - gcdt_times(a.y, b.x);
  return gcdt_sign_of_products(a.lift, bc, b.lift, ca, c.lift, ab);
}

// Sign of the in-circle determinant: > 0 if d lies strictly inside the circle through the
// counter-clockwise triangle (a, b, c). All finite.
GCDT_INLINE int gcdt_incircle_finite(Vertex a, Vertex b, Vertex c, Vertex d) {
  return gcdt_incircle_of_ways(gcdt_way_finite(d, a), gcdt_way_finite(d, b), gcdt_way_finite(d, c));
}

// The complete in-circle sign, 0 to 3 symbols in any position. Taking away the largest symbol leaves
// the leading coefficient, the orient2d of the other three in cyclic order, negated for positions b
// and d; if those are finite and collinear the next coefficient decides.
GCDT_INLINE int gcdt_incircle(Vertex a, Vertex b, Vertex c, Vertex d) {
  Vertex p = d, q = a, r = b, s = c;
  int f = -1;
  if ((a.symbol | b.symbol | c.symbol | d.symbol) == 0) return gcdt_incircle_finite(a, b, c, d);
  if (a.symbol > b.symbol && a.symbol > c.symbol && a.symbol > d.symbol) {
    p = a, q = b, r = c, s = d, f = 1;
  } else if (b.symbol > c.symbol && b.symbol > d.symbol) {
    p = b, q = c, r = d, s = a;
  } else if (c.symbol > d.symbol) {
    p = c, q = d, r = a, s = b, f = 1;
  }
  if (q.symbol != 0 && r.symbol != 0 && s.symbol != 0) {
    // Three symbols remain only if one is repeated: no triangle has that. The symbols' own triangle is
    // counter-clockwise for even permutations; p, the largest, is not among three distinct ones.
    return 0;
  }
  const int o = gcdt_sign64(gcdt_orient2d(q, r, s));
  if (o != 0) return f * o;
  if ((q.symbol | r.symbol | s.symbol) != 0) return 0;
  // Collinear: (q - s) . (r - s), |.| < 2^63, is > 0 if s lies outside the segment qr, < 0 between.
  const int outside = gcdt_sign64((q.x - s.x) * (r.x - s.x) + (q.y - s.y) * (r.y - s.y));
  return -f * outside * gcdt_sign64(gcdt_orient2d(q, r, p));
}

// Total order of finite points that decides cocircular ties: x first. 62 bits.
GCDT_INLINE u64 gcdt_tie_key(Vertex v) { return ((u64)v.x << 31) | (u64)v.y; }

// The quadrilateral a, b, c, d is counter-clockwise with diagonal a-c: (a, b, c) and (a, c, d) are
// counter-clockwise. True if Delaunay wants b-d instead. Cocircular: the diagonal goes through the
// least of the four (a "pulling" of the vertices in that order: flips end and the result is unique).
// A symbol that is the largest of the four: as an apex (b or d) it lies outside every circle; as an
// end of the diagonal it is flipped away if the quadrilateral is strictly convex at the other end.
GCDT_INLINE int gcdt_must_flip(Vertex a, Vertex b, Vertex c, Vertex d) {
  const i32 ac = a.symbol > c.symbol ? a.symbol : c.symbol;
  const i32 bd = b.symbol > d.symbol ? b.symbol : d.symbol;
  if ((ac | bd) == 0) {
    const int s = gcdt_incircle_finite(a, b, c, d);
    if (s != 0) return s > 0;
    const u64 ka = gcdt_tie_key(a), kb = gcdt_tie_key(b), kc = gcdt_tie_key(c), kd = gcdt_tie_key(d);
    return (kb < kd ? kb : kd) < (ka < kc ? ka : kc);
  }
  if (bd > ac) return 0;
  return gcdt_orient2d_any(b, c.symbol == ac ? d : c, c.symbol == ac ? a : d) > 0;
}

// Sign of orient2d(a, b, P) for the k-th of n division points P = ((n-k) p + k q) / n of segment pq
// (paper, equation 1), p and q finite, 0 <= k <= n < 2^31, a and b as for gcdt_orient2d. orient2d is
// affine in P: n * value = (n-k) orient2d(a,b,p) + k orient2d(a,b,q), below 2^63 * 2^31 * 2 = 2^95. The first takes
// these two, op and oq.
GCDT_INLINE int gcdt_division_sign(i64 op, i64 oq, u32 k, u32 n) {
  return gcdt_sign128(gcdt_add(gcdt_multiply(op, (i64)(n - k)), gcdt_multiply(oq, (i64)k)));
}
GCDT_INLINE int gcdt_orient2d_division(Vertex a, Vertex b, Vertex p, Vertex q, u32 k, u32 n) {
  return gcdt_division_sign(gcdt_orient2d_from(p, a, b), gcdt_orient2d_from(q, a, b), k, n);
}

#ifdef __OPENCL_VERSION__
static inline Vertex vertex_at(global const int2* points, uint v) {
  const int2 p = points[v];
  return gcdt_finite_vertex(p.x, p.y);
}
#else
}  // namespace gcdt::device
#endif

#endif
