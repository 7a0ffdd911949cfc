// SPDX-License-Identifier: Apache-2.0
// The exact predicates against __int128 and against CGAL on big integers, with symbolic vertices as
// real points far away.
#include <CGAL/Gmpq.h>
#include <CGAL/Gmpz.h>
#include <CGAL/Simple_cartesian.h>
#include <doctest/doctest.h>

#include <set>

#include "tuples.hpp"

using namespace gcdt::device;
using gcdt::test::side;
using gcdt::test::TupleMaker;

namespace {

__extension__ typedef __int128 wide;
__extension__ typedef unsigned __int128 unsigned_wide;

using Exact = CGAL::Simple_cartesian<CGAL::Gmpz>;
using Rational = CGAL::Simple_cartesian<CGAL::Gmpq>;

// The real point that a vertex stands for: p_k = M_k D_k with M = 2^200, 2^700, 2^2000.
Exact::Point_2 real_point(Vertex v) {
  static const int exponents[] = {0, 200, 700, 2000};
  const CGAL::Gmpz scale = CGAL::Gmpz(1) << exponents[v.symbol];
  return {CGAL::Gmpz(static_cast<long>(v.x)) * scale, CGAL::Gmpz(static_cast<long>(v.y)) * scale};
}

int real_orientation(Vertex a, Vertex b, Vertex c) {
  return CGAL::orientation(real_point(a), real_point(b), real_point(c));
}
int real_incircle(Vertex a, Vertex b, Vertex c, Vertex d) {
  return CGAL::side_of_oriented_circle(real_point(a), real_point(b), real_point(c), real_point(d));
}

// Flips where the circle says so; on a tie the diagonal goes through the least vertex, x before y.
bool real_must_flip(Vertex a, Vertex b, Vertex c, Vertex d) {
  const int s = real_incircle(a, b, c, d);
  if (s != 0) return s > 0;
  const auto least = [](Vertex u, Vertex v) { return std::min(real_point(u), real_point(v)); };
  return least(b, d) < least(a, c);
}

wide value(Int128 v) { return static_cast<wide>(static_cast<unsigned_wide>(static_cast<u64>(v.high)) << 64 | v.low); }
int sign(wide v) { return (v > 0) - (v < 0); }

const i64 extreme_words[] = {0,
                             1,
                             -1,
                             2,
                             -2,
                             side,
                             -side,
                             side* side,
                             -side* side,
                             INT64_MAX,
                             INT64_MIN,
                             INT64_MIN + 1,
                             1LL << 32,
                             -(1LL << 32),
                             0xFFFFFFFFLL,
                             -0xFFFFFFFFLL,
                             0x7FFFFFFF00000000LL};

template <class Test>
void for_word_pairs(Test test) {
  for (i64 a : extreme_words)
    for (i64 b : extreme_words) test(a, b);
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000000; ++i) {
    const i64 a = static_cast<i64>(random()) >> random() % 64, b = static_cast<i64>(random()) >> random() % 64;
    test(a, b);
  }
}

int orient_sign(Vertex a, Vertex b, Vertex c) { return gcdt_sign64(gcdt_orient2d(a, b, c)); }
int symbols(const PredicateTuple& t) {
  return (t.a.symbol != 0) + (t.b.symbol != 0) + (t.c.symbol != 0) + (t.d.symbol != 0);
}

}  // namespace

TEST_CASE("128-bit products equal the compiler's for all signs and sizes") {
  std::uint64_t wrong = 0;
  for_word_pairs([&](i64 a, i64 b) {
    const u64 high = static_cast<u64>((static_cast<unsigned_wide>(static_cast<u64>(a)) * static_cast<u64>(b)) >> 64);
    wrong += gcdt_mul_high_limbs(static_cast<u64>(a), static_cast<u64>(b)) != high;
    wrong += gcdt_mul_high(static_cast<u64>(a), static_cast<u64>(b)) != high;
    wrong += value(gcdt_multiply(a, b)) != static_cast<wide>(a) * b;
  });
  CHECK(wrong == 0);
}

TEST_CASE("128-bit sums carry and wrap, and signs are right") {
  std::uint64_t wrong = 0;
  for_word_pairs([&](i64 a, i64 b) {
    const Int128 p = gcdt_multiply(a, b), q = gcdt_multiply(b, ~a), sum = gcdt_add(p, q);
    const auto bits = [](Int128 v) { return static_cast<unsigned_wide>(value(v)); };
    wrong += bits(sum) != bits(p) + bits(q);
    for (const Int128& v : {p, q, sum}) wrong += gcdt_sign128(v) != sign(value(v));
    wrong += gcdt_sign64(a) != sign(a);
  });
  CHECK(wrong == 0);
}

TEST_CASE("orient2d of corners of the grid is exact, value included") {
  std::uint64_t wrong = 0;
  const i64 values[] = {0, 1, side / 2, side - 1, side};
  std::vector<Vertex> corners;
  for (i64 x : values)
    for (i64 y : values) corners.push_back(gcdt_finite_vertex(x, y));
  for (const Vertex& a : corners)
    for (const Vertex& b : corners)
      for (const Vertex& c : corners) {
        const wide area = static_cast<wide>(b.x - a.x) * (c.y - a.y) - static_cast<wide>(b.y - a.y) * (c.x - a.x);
        wrong += gcdt_orient2d(a, b, c) != area;
        wrong += gcdt_orient2d_finite(a, b, c) != area;
        wrong += gcdt_orient2d_from(a, b, c) != area;
      }
  CHECK(wrong == 0);
}

TEST_CASE("incircle of all corners and middles of the grid equals CGAL's") {
  std::uint64_t wrong = 0;
  const i64 values[] = {0, side / 2, side};
  std::vector<Vertex> corners;
  for (i64 x : values)
    for (i64 y : values) corners.push_back(gcdt_finite_vertex(x, y));
  for (const Vertex& a : corners)
    for (const Vertex& b : corners)
      for (const Vertex& c : corners)
        for (const Vertex& d : corners) wrong += gcdt_incircle(a, b, c, d) != real_incircle(a, b, c, d);
  CHECK(wrong == 0);
}

TEST_CASE("orient2d and incircle with up to three symbols in any position equal those of real far points") {
  TupleMaker maker(2);
  REQUIRE(maker.pattern_count() == 73);
  std::uint64_t wrong_orient = 0, wrong_incircle = 0, cocircular = 0, collinear = 0;
  std::set<std::array<int, 4>> patterns;
  for (int i = 0; i < 200000; ++i) {
    const PredicateTuple t = maker.next();
    patterns.insert({t.a.symbol, t.b.symbol, t.c.symbol, t.d.symbol});
    const int circle = real_incircle(t.a, t.b, t.c, t.d);
    cocircular += circle == 0;
    wrong_incircle += gcdt_incircle(t.a, t.b, t.c, t.d) != circle;
    const Vertex v[] = {t.a, t.b, t.c, t.d};
    for (int skip = 0; skip < 4; ++skip) {
      const Vertex a = v[skip == 0], b = v[skip <= 1 ? 2 : 1], c = v[skip == 3 ? 2 : 3];
      if (a.symbol && b.symbol && c.symbol) continue;  // never asked
      const int turn = real_orientation(a, b, c);
      collinear += turn == 0;
      wrong_orient += orient_sign(a, b, c) != turn;
    }
  }
  CHECK(wrong_orient == 0);
  CHECK(wrong_incircle == 0);
  // The families reach what they are for.
  CHECK(patterns.size() == 73);
  CHECK(cocircular > 5000);
  CHECK(collinear > 20000);
}

TEST_CASE("must_flip of every quadrilateral equals the circle test on real points, ties by the least vertex") {
  TupleMaker maker(3);
  std::uint64_t wrong = 0, not_convex = 0, flips = 0, ties = 0;
  std::array<std::uint64_t, 4> quadrilaterals{};
  for (int i = 0; i < 300000; ++i) {
    const PredicateTuple t = maker.next();
    if (real_orientation(t.a, t.b, t.c) <= 0 || real_orientation(t.a, t.c, t.d) <= 0) continue;
    const bool flip = real_must_flip(t.a, t.b, t.c, t.d);
    ++quadrilaterals[symbols(t)];
    flips += flip;
    ties += real_incircle(t.a, t.b, t.c, t.d) == 0;
    wrong += (gcdt_must_flip(t.a, t.b, t.c, t.d) != 0) != flip;
    // A flip is only possible in a strictly convex quadrilateral.
    if (flip) not_convex += real_orientation(t.b, t.c, t.d) <= 0 || real_orientation(t.d, t.a, t.b) <= 0;
  }
  CHECK(wrong == 0);
  CHECK(not_convex == 0);
  CHECK(flips > 1000);
  CHECK(ties > 500);
  for (std::uint64_t with_symbols : quadrilaterals) CHECK(with_symbols > 500);
}

TEST_CASE("orient2d from a finite point is that of any, value included") {
  TupleMaker maker(7);
  std::uint64_t wrong = 0, symbolic = 0;
  for (int i = 0; i < 100000; ++i) {
    const PredicateTuple t = maker.next();
    if (t.a.symbol) continue;
    symbolic += t.b.symbol && t.c.symbol;
    wrong += gcdt_orient2d_from(t.a, t.b, t.c) != gcdt_orient2d_any(t.a, t.b, t.c);
  }
  CHECK(wrong == 0);
  CHECK(symbolic > 500);
}

TEST_CASE("orient2d at division points equals orientation at the rational point") {
  TupleMaker maker(4);
  std::uint64_t wrong = 0, asked = 0, on_line = 0;
  const auto rational = [](const Exact::Point_2& p) { return Rational::Point_2(CGAL::Gmpq(p.x()), CGAL::Gmpq(p.y())); };
  for (int i = 0; i < 100000; ++i) {
    const PredicateTuple t = maker.next();
    if (t.c.symbol || t.d.symbol) continue;
    ++asked;
    const CGAL::Gmpq share(CGAL::Gmpz(static_cast<long>(t.k)), CGAL::Gmpz(static_cast<long>(t.n)));
    const auto p = rational(real_point(t.c)), q = rational(real_point(t.d));
    const Rational::Point_2 at = p + (q - p) * share;
    const int turn = CGAL::orientation(rational(real_point(t.a)), rational(real_point(t.b)), at);
    on_line += turn == 0;
    wrong += gcdt_orient2d_division(t.a, t.b, t.c, t.d, t.k, t.n) != turn;
  }
  CHECK(wrong == 0);
  CHECK(asked > 10000);
  CHECK(on_line > 500);
}

TEST_CASE("the tie key orders points by x, then y") {
  const i64 values[] = {0, 1, side - 1, side};
  u64 last = 0;
  bool first = true;
  for (i64 x : values)
    for (i64 y : values) {
      const u64 key = gcdt_tie_key(gcdt_finite_vertex(x, y));
      CHECK((first || key > last));
      CHECK(key < (1ull << 62));
      last = key;
      first = false;
    }
}
