// SPDX-License-Identifier: Apache-2.0
// Isolated vertices come early (phases/levels.hpp), and flips then make no chains.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "kinds.hpp"
#include "order_cases.hpp"
#include "phases/levels.hpp"
#include "solve/triangulate.hpp"
#include "workloads.hpp"

using namespace gcdt;
using namespace gcdt::test;
using order_cases::coarsest;

namespace {

/// Counts of vertices by rank, each with a depth.
struct Counts {
  std::vector<cl_uint> words = std::vector<cl_uint>(GCDT_DEPTH_COUNTS);
  std::uint32_t ranks = 0;
  void add(std::uint32_t depth, std::uint32_t many) {
    for (; many > 0; --many, ++ranks) ++words[GCDT_DEPTH_COUNT(depth, device::gcdt_strides_of_rank(ranks))];
  }
};

/// The ordered vertices of an input.
struct Ordered : order_cases::Read {
  std::uint32_t n() const { return levels().n; }
  std::uint32_t vertex(std::uint32_t rank) const {
    return device::gcdt_vertex_of_rank(&levels(), levels().count - 1, rank);
  }
  std::uint32_t rank(std::uint32_t v) const { return device::gcdt_rank_of_vertex(&levels(), v); }
  std::uint32_t level(std::uint32_t v) const {
    std::uint32_t j = 0;
    while (v >= levels().begin[j + 1]) ++j;
    return j;
  }
  std::uint64_t code(std::uint32_t rank) const {
    const cl_int2 p = points[vertex(rank)];
    return device::gcdt_morton(static_cast<cl_uint>(p.s[0]), static_cast<cl_uint>(p.s[1]));
  }
  /// Pairs of bits that its code shares with a neighbour's on the curve, counted one by one.
  std::uint32_t depth(std::uint32_t rank) const {
    std::uint32_t most = 0;
    for (const std::uint32_t other : {rank == 0 ? rank : rank - 1, rank + 1 == n() ? rank : rank + 1}) {
      if (other == rank) continue;
      std::uint32_t shared = 0;
      while (code(rank) >> (60 - 2 * shared) == code(other) >> (60 - 2 * shared)) ++shared;
      most = std::max(most, shared);
    }
    return most;
  }
};

Ordered order_on(runtime::Runtime& runtime, const Workload& work) {
  Primitives primitives(runtime);
  return {order_cases::run(runtime, primitives, work.points)};
}

/// Numbers and ranks are each other's inverse, ascend together in each level, and ranks at multiples of a stride are at
/// least of its level.
void check_table(const Ordered& read) {
  const device::Levels& levels = read.levels();
  REQUIRE(levels.begin[0] == 0);
  REQUIRE(levels.begin[levels.count] == read.n());
  std::vector<bool> seen(read.n());
  for (std::uint32_t v = 0; v < read.n(); ++v) {
    const std::uint32_t rank = read.rank(v);
    REQUIRE(rank < read.n());
    REQUIRE(!seen[rank]);
    seen[rank] = true;
    REQUIRE(read.vertex(rank) == v);
    if (v + 1 < read.n() && read.level(v) == read.level(v + 1)) REQUIRE(rank < read.rank(v + 1));
    if (rank > 0) REQUIRE(read.code(rank - 1) < read.code(rank));
    for (std::uint32_t j = read.level(v); j-- > 0;) REQUIRE(rank % levels.stride[j] != 0);
    REQUIRE(device::gcdt_vertex_of_rank(&levels, read.level(v), rank / levels.stride[read.level(v)]) ==
            read.vertex(rank - rank % levels.stride[read.level(v)]));
  }
}

/// A row with two vertices far from it, and every vertex of the row twice.
Workload row_twice(std::size_t n) {
  Workload work = workload("row_between", n);
  work.points.insert(work.points.end(), work.points.begin(), work.points.begin() + static_cast<std::ptrdiff_t>(n / 2));
  return work;
}

}  // namespace

TEST_CASE("evenly spread vertices have no table, and levels by rank") {
  Counts counts;
  // Of 4^8 vertices each cell of depth 8 has one, so that half of them have a neighbour in their cell, and so on.
  for (const auto& [depth, many] : {std::pair{6u, 1000u},
                                    {7u, 12000u},
                                    {8u, 26000u},
                                    {9u, 18000u},
                                    {10u, 6000u},
                                    {11u, 1800u},
                                    {12u, 500u},
                                    {13u, 236u}})
    counts.add(depth, many);
  const ChosenLevels chosen = choose_levels(counts.words, coarsest, {});
  const device::Levels by_rank = device::make_levels(counts.ranks, coarsest);
  CHECK(chosen.levels.tabled == 0);
  CHECK(std::equal(by_rank.begin, by_rank.begin + GCDT_MAX_LEVELS + 1, chosen.levels.begin));
}

TEST_CASE("few vertices less deep than a row are of the coarsest level, and their number is limited") {
  for (const std::uint32_t few : {1u, 3u, 200u, 30000u}) {
    CAPTURE(few);
    Counts counts;
    counts.add(16, 1);  // rank 0 is of the coarsest level in any case
    counts.add(1, few);
    counts.add(16, 60000);
    const ChosenLevels chosen = choose_levels(counts.words, coarsest, {});
    const device::Levels by_rank = device::make_levels(counts.ranks, coarsest);
    REQUIRE(chosen.levels.n == counts.ranks);
    const std::uint32_t allowed = by_rank.begin[1] / Tuning::share_isolated;
    // Down to depth 1, which is too full, or as far below the median, 16, as the coarsest level is above the finest: a
    // depth of the quadtree for each factor of four.
    std::uint32_t above = 0;
    while (1u << 2 * above < by_rank.stride[0]) ++above;
    CHECK(chosen.by_depth.below[0] == (few <= allowed ? 16 + 1 - above - Tuning().isolation_margin : 1));
    for (std::uint32_t j = 0; j + 1 < by_rank.count; ++j) {
      CHECK(chosen.levels.begin[j + 1] >= by_rank.begin[j + 1]);
      CHECK(chosen.levels.begin[j + 1] <= by_rank.begin[j + 1] + by_rank.begin[j + 1] / Tuning::share_isolated);
    }
    CHECK(chosen.levels.begin[by_rank.count] == counts.ranks);
    CHECK(chosen.levels.tabled == (few < 30000));
  }
}

TEST_CASE("on every device a table numbers the vertices, and the isolated ones are of the coarsest level") {
  for (const Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    Tuning tuning = device.runtime->tuning();
    tuning.one_item_vertices = 0;
    const Tuned tuned(*device.runtime, tuning);
    const Ordered read = order_on(*device.runtime, row_twice(5000));
    REQUIRE(read.levels().tabled != 0);
    check_table(read);
    std::uint32_t isolated = 0;
    for (std::uint32_t rank = 0; rank < read.n(); ++rank) {
      if (read.depth(rank) >= 3) continue;
      ++isolated;
      CHECK(read.level(read.vertex(rank)) == 0);
    }
    CHECK(isolated == 2);
  }
}

TEST_CASE("on every device vertices of less depth are of no finer level, however many are isolated") {
  for (const Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    Tuning tuning = small_thresholds();
    tuning.one_item_vertices = 0;
    const Tuned tuned(*device.runtime, tuning);
    for (const char* name : {"clusters", "letters", "uniform", "spiral", "line_and_one"}) {
      CAPTURE(name);
      const Ordered read = order_on(*device.runtime, workload(name, 3000));
      CHECK(read.levels().tabled != 0);
      check_table(read);
      // The level that a depth brings, of those that it does bring one.
      std::vector<std::uint32_t> finest(GCDT_QUADTREE_DEPTHS, 0), brought(GCDT_QUADTREE_DEPTHS, GCDT_MAX_LEVELS);
      for (std::uint32_t rank = 0; rank < read.n(); ++rank) {
        const std::uint32_t strides = device::gcdt_strides_of_rank(rank), depth = read.depth(rank);
        const std::uint32_t level = read.level(read.vertex(rank)), last = read.levels().count - 1;
        const std::uint32_t by_rank = strides > last ? 0 : last - strides;
        REQUIRE(level <= by_rank);
        finest[depth] = std::max(finest[depth], level);
        if (level < by_rank) brought[depth] = std::min(brought[depth], level);
      }
      for (std::uint32_t depth = 0; depth < GCDT_QUADTREE_DEPTHS; ++depth)
        if (brought[depth] != GCDT_MAX_LEVELS)
          for (std::uint32_t less = 0; less <= depth; ++less) CHECK(finest[less] <= brought[depth]);
    }
  }
}

TEST_CASE("shapes that made chains take few rounds of flips on GPUs, and the host reads seldom") {
  for (const Treated& device : devices_as_all_kinds()) {
    if (device.runtime->kind() != DeviceKind::gpu) continue;
    CAPTURE(device.name);
    Primitives primitives(*device.runtime);
    for (const std::string& name : growth_names()) {
      CAPTURE(name);
      const Workload work = workload(name, 10000);
      const Points points = work.points;
      const Constraints constraints = work.constraints;
      const InputSource source = {
          points.size(), constraints.size(), [&] {
            return DeviceInput{stage(*device.runtime, points), stage(*device.runtime, constraints)};
          }};
      device.runtime->memory().begin_call();
      const Statistics s = triangulate(*device.runtime, primitives, source, {}).statistics;
      // A tip among others near it, that sees a dense wall, makes a chain still, along which a round slides: the
      // innermost of a spiral, around which its first turn lies, a thousand vertices. Corners of letters make many.
      CHECK(s.rounds.flip <= (name.compare(0, 7, "letters") == 0 ? 1000 : 400));
      // Few edges and vertices are flipped and inserted before the host knows how many there are: with a read each
      // time, uniform vertices took 20, letters 33.
      CHECK(s.read_backs <= (constraints.size() == 0 ? 17 : 25));
    }
  }
}
