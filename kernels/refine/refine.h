// SPDX-License-Identifier: Apache-2.0
// Quality refinement: what host and kernels share, and its arithmetic (docs/refinement.md). OpenCL C and C++17.
//
// Of a counter-clockwise triangle: `area` is its doubled area, `dot` the largest dot product of two sides from a
// corner. That corner has the least angle, with tangent area / dot, and the shortest side is across from it.
#ifndef GCDT_REFINE_H
#define GCDT_REFINE_H

#include "common/predicates.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// What may be split.
#define GCDT_SPLIT_ALL 0u
#define GCDT_SPLIT_INNER 1u  // subsegments with kept faces on both sides
#define GCDT_SPLIT_NONE 2u

// Words of a block of the list of a cavity.
#define GCDT_BLOCK 8u
// Work-items that rank one candidate by counting those before it (refine.cl).
#define GCDT_COUNTING_TEAM 32u

// Marks of edges beside those of shared.h.
#define GCDT_MARK_ASKED 4u  // stands in the list of subsegments that someone wants split

typedef struct RefineRules {
  u64 tangent;        // 2^31 tan(theta), theta the least angle wanted
  u64 lens;           // 2^31 tan(2 theta)
  u64 off_centre;     // 2^24 * 0.475 cot(theta / 2)
  u64 most_area;      // doubled, in cells; all bits: no limit
  u64 least_squared;  // the square of the least length, in cells: no shorter side is made
  u32 conforming;     // subsegments are split until their circles are empty
  u32 splits;         // GCDT_SPLIT_...
  u32 sized;          // vertices have wanted lengths
  u32 by_label;       // regions have largest areas of their own
} RefineRules;

// Why a kept triangle that is worse than wanted was left: GCDT_EXCUSE_... less 1.
#define GCDT_LEFT_INPUT_ANGLE 0u   // its least angle is between two subsegments
#define GCDT_LEFT_BESIDE_ANGLE 1u  // its shortest side joins two constraints that meet at such an angle
#define GCDT_LEFT_GRID 2u          // its shortest side is shorter than the least length
#define GCDT_LEFT_LIMIT 3u         // nothing but the limit of vertices
#define GCDT_LEFT_TARGET 4u        // its target is too near a vertex
#define GCDT_LEFT_FIXED 5u         // a subsegment that may not be split is in the way
#define GCDT_LEFT_REFUSED 6u       // subsegments that have no place to be split at are in the way
#define GCDT_LEFT_KINDS 7u

// Where rounds of one work-item have stopped (tail.cl), and the host goes on.
#define GCDT_TAIL_JUDGE 0u       // before a round
#define GCDT_TAIL_ENDED 1u       // nothing is left to do
#define GCDT_TAIL_CANDIDATES 2u  // in a round, when its candidates were found
#define GCDT_TAIL_FLIPS 3u       // in a round, when its winners were inserted: edges are queued
#define GCDT_TAIL_GOES_ON 4u     // it has not

// Faces of a cavity that any triangle may go through (wait.h, Lots). Ordinary cavities have about six. Fewer would make
// more rounds; more cost dense outlines in proportion. Doubled so often, that is more than any mesh has.
#define GCDT_FACES_OF_ANY 8u
#define GCDT_MOST_DOUBLINGS 28u

// Candidates of such a round at most, which are ranked by comparing all with all; and stamps that it needs: for claims,
// and for a round of flips.
#define GCDT_TAIL_CANDIDATES_MOST 512u
#define GCDT_TAIL_STAMPS 2u

// What such rounds did, and where they are. Zeroed before.
typedef struct RefineTail {
  u32 stage;
  u32 rounds, searches;  // done: those that inserted, and all, but for the one in which it stopped
  u32 idle;              // how many searches found nothing since one found something
  u32 aims;              // sum over those searches
  u32 vertices;          // there are now
  u32 candidates, flip_rounds, flips_low, flips_high;  // sums
  u32 judgings;                                        // how many times they judged faces
  u32 judged;                                          // how many vertices there were the last time
  u32 stamp_judged;                                    // the last stamp that was given out then
  u32 stamp;                                           // and now
  u32 lost;  // a changed face is not found by its vertex: faces have to be judged by a sweep
} RefineTail;

// What the insertion before and its flips did, if the host has not read it.
typedef struct RefineSettled {
  u32 failed, inserted, rounds, flips_low, flips_high;
  u32 left;  // edges that are still to be tested: nothing is judged before they are
} RefineSettled;

// Zeroed at the start of a round, but for the sums over all rounds.
typedef struct RefineReport {
  u32 failed;                     // a loop did not end where theory says it must
  u32 bad;                        // the length of the list of triangles to be mended
  u32 aiming;                     // of that of those that need not wait
  u32 sitting_out;                // whether one that aimed found its cavity too large; who lost the draw has not aimed
  u32 asked;                      // of that of subsegments to be split
  u32 candidates;                 // of that of candidates, counted on where they do not fit
  u32 blocks;                     // of lists of cavities, counted on where there are none left
  u32 refused;                    // subsegments asked for that cannot be split
  u32 on_subsegments, bent, far;  // sums: vertices on subsegments; not exactly on their piece; rounded the other way
  u32 encroached;                 // at the end: subsegments with a corner in their lens
  u32 left[GCDT_LEFT_KINDS];      // at the end
  RefineSettled settled;
  RefineTail tail;
} RefineReport;

// ---- Integers ---------------------------------------------------------------------------------------

// a * b < c * d, for a, b, c, d >= 0 as signed words.
GCDT_INLINE int gcdt_product_less(u64 a, u64 b, u64 c, u64 d) {
  const Int128 left = gcdt_multiply((i64)a, (i64)b), right = gcdt_multiply((i64)c, (i64)d);
  return left.high < right.high || (left.high == right.high && left.low < right.low);
}

// The largest r with r r <= value < 2^63. Ends: bits are tried once.
GCDT_INLINE u64 gcdt_square_root(u64 value) {
  u64 root = 0;
  for (u64 bit = (u64)1 << 31; bit != 0; bit >>= 1)
    if ((root | bit) * (root | bit) <= value) root |= bit;
  return root;
}

// The largest b with 2^b <= value, value > 0.
GCDT_INLINE u32 gcdt_log2(u64 value) {
  u32 bits = 0;
  for (u32 step = 32; step != 0; step >>= 1)
    if (value >> step) {
      value >>= step;
      bits += step;
    }
  return bits;
}

// To within 2^-22 of the value: of its magnitude, since the limbs of a negative number cancel.
GCDT_INLINE float gcdt_as_float(Int128 value) {
  const int negative = value.high < 0;
  const u64 low = negative ? 0u - value.low : value.low,
            high = (u64)(negative ? ~value.high : value.high) + (u64)(negative && low == 0);
  const float magnitude = (float)high * 18446744073709551616.0f + (float)low;
  return negative ? -magnitude : magnitude;
}

// floor(numerator / denominator + 1/2), of which the magnitude is below 2^39, for |numerator| < 2^97 and 0 <
// denominator < 2^63. With N the numerator, D the denominator and W = 2D it is floor((2N + D) / W). Floats guess it, to
// within 2^-20 whatever their rounding, and integers take away what was guessed: |rest| / W falls from 2^39 below 2^20,
// 3 and 2. So the loop ends, within W of 0 .. W; what is left is exact, and the next one ends after two steps.
GCDT_INLINE i64 gcdt_round_quotient(Int128 numerator, i64 denominator) {
  Int128 rest = gcdt_add(numerator, numerator), once, whole;
  once.low = (u64)denominator;
  once.high = 0;
  rest = gcdt_add(rest, once);
  whole = gcdt_add(once, once);
  const float divisor = 2.0f * (float)denominator;
  i64 q = 0;
  for (int guess = 0; guess < 8; ++guess) {
    const i64 step = (i64)(gcdt_as_float(rest) / divisor);
    if (step == 0) break;
    q += step;
    rest = gcdt_add(rest, gcdt_multiply(-denominator, 2 * step));
  }
  for (; rest.high < 0; --q) rest = gcdt_add(rest, whole);
  const Int128 beyond = gcdt_add(rest, gcdt_multiply(-denominator, 2));
  return beyond.high < 0 ? q : q + 1;
}

GCDT_INLINE i64 gcdt_dot(Vertex from, Vertex a, Vertex b) {
  return (a.x - from.x) * (b.x - from.x) + (a.y - from.y) * (b.y - from.y);
}

GCDT_INLINE u64 gcdt_squared_length(Vertex a, Vertex b) {
  const i64 x = b.x - a.x, y = b.y - a.y;
  return (u64)(x * x + y * y);
}

// ---- Triangles --------------------------------------------------------------------------------------

typedef struct Shape {
  i64 area, dot;  // < 2^62, < 2^63
  u64 shortest;   // squared
  u64 longest;    // squared
  u32 corner;     // of the least angle; of equal ones the least in (x, y)
} Shape;

GCDT_INLINE Shape gcdt_shape(Vertex a, Vertex b, Vertex c) {
  const i64 da = gcdt_dot(a, b, c), db = gcdt_dot(b, c, a), dc = gcdt_dot(c, a, b);
  const u64 la = gcdt_squared_length(b, c), lb = gcdt_squared_length(c, a), lc = gcdt_squared_length(a, b);
  Shape s;
  s.area = gcdt_orient2d_finite(a, b, c);
  s.dot = da;
  s.corner = 0;
  s.shortest = la;
  if (db > s.dot || (db == s.dot && gcdt_tie_key(b) < gcdt_tie_key(a))) {
    s.dot = db;
    s.corner = 1;
    s.shortest = lb;
  }
  if (dc > s.dot || (dc == s.dot && gcdt_tie_key(c) < gcdt_tie_key(s.corner == 0 ? a : b))) {
    s.dot = dc;
    s.corner = 2;
    s.shortest = lc;
  }
  s.longest = la > lb ? (la > lc ? la : lc) : (lb > lc ? lb : lc);
  return s;
}

// Is the least angle less than wanted? Products: 2^62 * 2^31 and 2^63 * 2^31.
GCDT_INLINE int gcdt_is_sharp(Shape s, RefineRules rules) {
  return gcdt_product_less((u64)s.area, (u64)1 << 31, (u64)s.dot, rules.tangent);
}

// Is the triangle larger than wanted: by its area, or because its longest side is longer than sqrt(2) times the mean h
// of what its corners want? l > sqrt(2) h if 9 l^2 > 2 (h1 + h2 + h3)^2, the sum below 2^34.
GCDT_INLINE int gcdt_is_large(Shape s, u64 most_area, u32 sized, u64 wanted_sum) {
  if ((u64)s.area > most_area) return 1;
  return sized && gcdt_product_less(2 * wanted_sum, wanted_sum, 9, s.longest);
}

// Does r see p and q at more than 180 - 2 theta degrees (or, if conforming, 90)? Products: 2^62 * 2^31, 2^63 * 2^33.
GCDT_INLINE int gcdt_in_lens(RefineRules rules, Vertex p, Vertex q, Vertex r) {
  const i64 dot = gcdt_dot(r, p, q);
  if (dot >= 0) return 0;
  if (rules.conforming) return 1;
  const i64 area = gcdt_orient2d_finite(p, q, r);
  return gcdt_product_less((u64)(area < 0 ? -area : area), (u64)1 << 31, (u64)-dot, rules.lens);
}

// Where to insert a vertex for triangle (p, q, r), pq its shortest side: the circumcentre, or the off-centre if that is
// nearer, from which pq is seen at about theta. Both to the nearest grid point, half up; off-centres may lie off the
// grid, below 2^38. The off-centre is 2 K perp + 2^24 (p + q), below 2^62 + 2^56. The circumcentre's numerators are
// below 2^96; it is at most as far as the off-centre.
GCDT_INLINE Vertex gcdt_aim(Vertex p, Vertex q, Vertex r, Shape s, RefineRules rules) {
  const i64 k = (i64)rules.off_centre, one = (i64)1 << 24;
  if (gcdt_product_less(2 * rules.off_centre, (u64)s.area, (u64)1 << 24, (u64)s.dot)) {
    const i64 x = (p.x + q.x) * one + 2 * k * (p.y - q.y) + one, y = (p.y + q.y) * one + 2 * k * (q.x - p.x) + one;
    return gcdt_finite_vertex(x >> 25, y >> 25);
  }
  const i64 ux = q.x - p.x, uy = q.y - p.y, vx = r.x - p.x, vy = r.y - p.y;
  const i64 lu = ux * ux + uy * uy, lv = vx * vx + vy * vy;
  const Int128 x = gcdt_add(gcdt_multiply(vy, lu), gcdt_multiply(-uy, lv));
  const Int128 y = gcdt_add(gcdt_multiply(ux, lv), gcdt_multiply(-vx, lu));
  return gcdt_finite_vertex(p.x + gcdt_round_quotient(x, 2 * s.area), p.y + gcdt_round_quotient(y, 2 * s.area));
}

// Sign of orient2d(a, b, p) for a target p that may lie off the grid: |p| < 2^39.
GCDT_INLINE int gcdt_orient2d_target(Vertex a, Vertex b, Vertex p) {
  return gcdt_sign128(gcdt_add(gcdt_multiply(b.x - a.x, p.y - a.y), gcdt_multiply(a.y - b.y, p.x - a.x)));
}

GCDT_INLINE int gcdt_on_grid(Vertex p) { return p.x >= 0 && p.y >= 0 && p.x >> 31 == 0 && p.y >> 31 == 0; }

// ---- Lengths at vertices ------------------------------------------------------------------------------

// floor(sum of weights times values / whole), the quotient below 2^33; weights below 2^63, `whole` their sum. Bit by
// bit.
GCDT_INLINE u32 gcdt_mean(i64 a, i64 b, i64 c, u32 va, u32 vb, u32 vc, i64 whole) {
  const Int128 sum =
      gcdt_add(gcdt_add(gcdt_multiply(a, (i64)va), gcdt_multiply(b, (i64)vb)), gcdt_multiply(c, (i64)vc));
  u64 quotient = 0;
  for (int bit = 32; bit >= 0; --bit) {
    const u64 more = quotient | ((u64)1 << bit);
    if (gcdt_sign128(gcdt_add(sum, gcdt_multiply(-whole, (i64)more))) >= 0) quotient = more;
  }
  return (u32)quotient;
}

// The length wanted at x in the closed triangle abc, linear between those of its corners.
GCDT_INLINE u32 gcdt_length_on_face(Vertex a, Vertex b, Vertex c, Vertex x, u32 la, u32 lb, u32 lc) {
  return gcdt_mean(gcdt_orient2d_finite(b, c, x), gcdt_orient2d_finite(c, a, x), gcdt_orient2d_finite(a, b, x), la, lb,
                   lc, gcdt_orient2d_finite(a, b, c));
}

// The same at x on ab. A bent vertex is projected on it.
GCDT_INLINE u32 gcdt_length_on_edge(Vertex a, Vertex b, Vertex x, u32 la, u32 lb) {
  const i64 whole = (i64)gcdt_squared_length(a, b), dot = gcdt_dot(a, b, x);
  const i64 along = dot < 0 ? 0 : dot > whole ? whole : dot;
  return gcdt_mean(whole - along, along, 0, la, lb, 0, whole);
}

// ---- Keys -------------------------------------------------------------------------------------------
// 63: a subsegment's candidate; 56 .. 62: 127 - log2 of its shortest side squared; 47 .. 55: 511 less 2^8 tangents of
// its least angle; 0 .. 46: a hash of its point. The greater key has precedence.

// A bijection.
GCDT_INLINE u64 gcdt_mix(u64 x) {
  x ^= x >> 31;
  x *= 0x7FB5D329728EA185ul;
  x ^= x >> 27;
  x *= 0x81DADEF4BC2DD44Dul;
  return x ^ (x >> 33);
}

// Bits 47 .. 62 of a key: above 0.
GCDT_INLINE u32 gcdt_precedence(u64 squared, u64 worse) { return ((127u - gcdt_log2(squared)) << 9) | (u32)worse; }

GCDT_INLINE u64 gcdt_candidate_key(u32 of_subsegment, u64 squared, u64 worse, Vertex at) {
  return ((u64)of_subsegment << 63) | ((u64)gcdt_precedence(squared, worse) << 47) | (gcdt_mix(gcdt_tie_key(at)) >> 17);
}

#define GCDT_MOST_BADNESS 511u
#define GCDT_TANGENT_BITS 8u

// 511 - min(511, floor(2^8 area / dot)); dot > 0, since the least angle is at most 60 degrees. The rest is below dot.
GCDT_INLINE u64 gcdt_badness(Shape s) {
  const u64 dot = (u64)s.dot;
  u64 rest = (u64)s.area;
  if (rest / 2 >= dot) return 0;
  u64 quotient = rest >= dot;
  if (quotient) rest -= dot;
  for (int bit = 0; bit < (int)GCDT_TANGENT_BITS; ++bit) {
    rest *= 2;
    quotient = 2 * quotient + (rest >= dot);
    if (rest >= dot) rest -= dot;
  }
  return quotient > GCDT_MOST_BADNESS ? 0 : GCDT_MOST_BADNESS - quotient;
}

// How much sharper than 2^-8 a sharp triangle is, by powers of two, below 2^6: the badness of all such ones is 511.
// (The quotient is above 0, since the tangent of a sharp triangle's least angle is below 1.)
#define GCDT_NEEDLE_BITS 6u
GCDT_INLINE u32 gcdt_needle(Shape s) {
  if (s.area <= 0) return (1u << GCDT_NEEDLE_BITS) - 1u;  // of a mesh that is wrong
  const u32 slope = gcdt_log2((u64)s.dot / (u64)s.area);
  return slope < 8u ? 0u : slope - 8u;
}

// ---- Places on pieces ----------------------------------------------------------------------------------
// A piece ab, a < b in (x, y), has places k = 0 .. D, D the larger of |dx| and |dy|: k steps from a along that axis,
// the other coordinate rounded half up. So a vertex at a place is within half a cell of the piece on one axis and on it
// by the other, and both coordinates are monotone in k.

typedef struct Piece {
  Vertex a, b;
  i64 along;       // D
  i64 across;      // the extent on the other axis, >= 0
  i32 by_x, down;  // D is along x; whether the axis (or, along x, the other axis) runs down from a
} Piece;

GCDT_INLINE Piece gcdt_piece(Vertex a, Vertex b) {
  const int swapped = gcdt_tie_key(b) < gcdt_tie_key(a);
  Piece piece;
  piece.a = swapped ? b : a;
  piece.b = swapped ? a : b;
  const i64 dx = piece.b.x - piece.a.x, dy = piece.b.y - piece.a.y;  // dx >= 0
  piece.down = dy < 0;
  const i64 height = dy < 0 ? -dy : dy;
  piece.by_x = dx >= height;
  piece.along = piece.by_x ? dx : height;
  piece.across = piece.by_x ? height : dx;
  return piece;
}

GCDT_INLINE i64 gcdt_place_of(Piece piece, Vertex v) {
  const i64 along = piece.by_x ? v.x - piece.a.x : v.y - piece.a.y;
  return along < 0 ? -along : along;
}

// The point at place k; with `other_way` the grid point on the other side of the piece, or a if there is none.
// 2 k across + D is below 2^63 + 2^31.
GCDT_INLINE Vertex gcdt_at_place(Piece piece, i64 k, int other_way) {
  const u64 whole = 2 * (u64)piece.along, twice = 2 * (u64)k * (u64)piece.across;
  // The other coordinate runs down only along x: along y it is x, which ascends from a.
  const int falls = piece.by_x && piece.down;
  u64 steps = (twice + (u64)piece.along - (falls ? 1u : 0u)) / whole;
  if (other_way) {
    if (steps * whole == twice) return piece.a;
    steps = steps * whole < twice ? steps + 1 : steps - 1;
  }
  const i64 aside = falls ? -(i64)steps : (i64)steps;
  if (piece.by_x) return gcdt_finite_vertex(piece.a.x + k, piece.a.y + aside);
  return gcdt_finite_vertex(piece.a.x + aside, piece.a.y + (piece.down ? -k : k));
}

// The place at distance 2^j from an end of the piece, 2^j the least above a third of a length: the largest k with
// k^2 |ab|^2 <= 4^j D^2. Products are below 2^62 * 2^63, and 2^62 * 2^62.
GCDT_INLINE i64 gcdt_shell(Piece piece, u64 squared_length) {
  u64 square = 1;
  while (square <= squared_length / 9) square *= 4;
  const u64 along = (u64)(piece.along * piece.along), whole = gcdt_squared_length(piece.a, piece.b);
  i64 k = 0;
  for (int bit = 30; bit >= 0; --bit) {
    const i64 more = k | ((i64)1 << bit);
    if (!gcdt_product_less(square, along, (u64)(more * more), whole)) k = more;
  }
  return k;
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(RefineRules) == 5 * sizeof(u64) + 4 * sizeof(u32), "the same layout on host and device");
static_assert(sizeof(RefineReport) == (33 + GCDT_LEFT_KINDS) * sizeof(u32), "the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif
