// SPDX-License-Identifier: Apache-2.0
// Tuples of vertices on which exact predicates are hard: extreme, nearly and exactly degenerate, with
// 0 to 3 symbolic vertices in every position.
#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "predicate_values.h"

namespace gcdt::test {

using device::PredicateTuple;
using device::Vertex;

constexpr std::int64_t side = 2147483647;  // S of predicates.h
constexpr int family_count = 9;

class TupleMaker {
 public:
  explicit TupleMaker(std::uint64_t seed) : random_(seed) {
    for (int code = 0; code < 256; ++code) {  // base 4: the symbol of each position
      std::array<int, 4> symbols{code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6 & 3};
      std::array<int, 4> seen{};
      for (int s : symbols) ++seen[s];
      if (seen[1] <= 1 && seen[2] <= 1 && seen[3] <= 1) patterns_.push_back(symbols);
    }
  }

  /// 73: the ways to put up to three distinct symbols at four positions.
  std::size_t pattern_count() const { return patterns_.size(); }

  /// Half of all tuples are finite; the others go through all patterns. Every second one is turned
  /// into a quadrilateral of two counter-clockwise triangles (a, b, c), (a, c, d) if its vertices allow.
  PredicateTuple next() {
    const std::uint64_t i = index_++;
    std::array<Vertex, 4> v = points(static_cast<int>(i % family_count));
    if (i / 2 % 2 == 0) {
      const auto& pattern = patterns_[i / 4 % patterns_.size()];
      for (int j = 0; j < 4; ++j)
        if (pattern[j] != 0) v[j] = device::gcdt_symbolic_vertex(pattern[j] - 1);
    }
    if (i % 2 == 0) make_quadrilateral(v);
    const device::u32 n = i % 3 == 0 ? 0x7FFFFFFFu : 1u + below(1000);
    return {v[0], v[1], v[2], v[3], below(n + 1u), n};
  }

 private:
  device::u32 below(std::uint64_t bound) { return static_cast<device::u32>(random_() % bound); }
  std::int64_t anywhere() { return below(std::uint64_t{1} << 31); }
  static std::int64_t clamped(std::int64_t x) { return std::clamp<std::int64_t>(x, 0, side); }
  static Vertex at(std::int64_t x, std::int64_t y) { return device::gcdt_finite_vertex(clamped(x), clamped(y)); }
  std::int64_t nudge() { return below(4) == 0 ? static_cast<std::int64_t>(below(3)) - 1 : 0; }

  std::array<Vertex, 4> points(int family) {
    std::array<Vertex, 4> v;
    const std::int64_t bx = anywhere(), by = anywhere(), dx = anywhere() - side / 2, dy = anywhere() - side / 2;
    const std::int64_t step = 1 + below(std::uint64_t{1} << below(30));
    // Points on the circle of radius 65 around 0.
    static const std::int64_t circle[][2] = {{65, 0},  {63, 16}, {60, 25}, {56, 33}, {52, 39},
                                             {39, 52}, {33, 56}, {25, 60}, {16, 63}};
    for (auto& p : v) switch (family) {
        case 0: p = at(anywhere(), anywhere()); break;
        case 1: p = at(extreme(), extreme()); break;
        case 2: p = at(bx % 1000 + below(4) * step, by % 1000 + below(4) * step); break;
        case 3: {
          const std::int64_t t = static_cast<std::int64_t>(below(2001)) - 1000;
          p = at(side / 2 + dx / 1000 * t + nudge(), side / 2 + dy / 1000 * t + nudge());
          break;
        }
        case 4: {
          const auto& c = circle[below(9)];
          const std::int64_t scale = 1 + step % (side / 130), sx = below(2) ? scale : -scale,
                             sy = below(2) ? scale : -scale;
          p = at(side / 2 + sx * c[0] + nudge(), side / 2 + sy * c[1] + nudge());
          break;
        }
        case 5: p = at(bx / 2 + (below(2) ? step : 0) + nudge(), by / 2 + (below(2) ? step : 0) + nudge()); break;
        case 6: p = at(bx + below(16), by + below(16)); break;
        case 7: p = at(below(2) ? below(4) : side - below(4), below(2) ? below(4) : side - below(4)); break;
        default: {
          const std::int64_t t = below(46340);
          p = at(t, t * t);
        }
      }
    return v;
  }

  std::int64_t extreme() {
    static const std::int64_t values[] = {0, 1, side / 2, side / 2 + 1, side - 1, side};
    return values[below(2) ? (below(2) ? 0 : 5) : below(6)];
  }

  void make_quadrilateral(std::array<Vertex, 4>& v) {
    std::array<int, 4> order{0, 1, 2, 3};
    do {
      const Vertex a = v[order[0]], b = v[order[1]], c = v[order[2]], d = v[order[3]];
      const bool all_symbols = (a.symbol && b.symbol && c.symbol) || (a.symbol && c.symbol && d.symbol);
      if (!all_symbols && device::gcdt_orient2d(a, b, c) > 0 && device::gcdt_orient2d(a, c, d) > 0) {
        v = {a, b, c, d};
        return;
      }
    } while (std::next_permutation(order.begin(), order.end()));
  }

  std::mt19937_64 random_;
  std::uint64_t index_ = 0;
  std::vector<std::array<int, 4>> patterns_;
};

}  // namespace gcdt::test
