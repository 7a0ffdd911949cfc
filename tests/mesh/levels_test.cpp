// SPDX-License-Identifier: Apache-2.0
#include "common/levels.h"

#include <doctest/doctest.h>

#include <random>
#include <vector>

using namespace gcdt::device;

namespace {

void check_levels(u32 n, u32 coarsest, u32 step) {
  CAPTURE(n);
  CAPTURE(coarsest);
  const Levels levels = make_levels(n, coarsest);
  REQUIRE(levels.n == n);
  REQUIRE(levels.count >= 1);
  REQUIRE(levels.count <= GCDT_MAX_LEVELS);
  REQUIRE(levels.begin[0] == 0);
  REQUIRE(levels.begin[levels.count] == n);
  REQUIRE(levels.stride[levels.count - 1] == 1);
  if (levels.count < GCDT_MAX_LEVELS) REQUIRE(levels.begin[1] <= coarsest);
  for (u32 j = 0; j + 1 < levels.count; ++j) {
    REQUIRE(levels.begin[j] <= levels.begin[j + 1]);
    REQUIRE(levels.stride[j] == (j + 2 == levels.count ? 4 : 16) * levels.stride[j + 1]);
  }
  for (u64 v = 0; v < n; v += step) {
    const u32 rank = gcdt_rank_of_vertex(&levels, u32(v));
    REQUIRE(rank < n);
    REQUIRE(gcdt_vertex_of_rank(&levels, levels.count - 1, rank) == v);
    // The level of v is the coarsest whose stride divides the rank.
    u32 j = 0;
    while (v >= levels.begin[j + 1]) ++j;
    REQUIRE(rank % levels.stride[j] == 0);
    if (j > 0) REQUIRE(rank % levels.stride[j - 1] != 0);
    REQUIRE(gcdt_vertex_of_rank(&levels, j, rank / levels.stride[j]) == v);
    REQUIRE(gcdt_vertices_before(&levels, j, rank / levels.stride[j]) == v - levels.begin[j]);
    // Along the curve inside a level.
    if (v + 1 < levels.begin[j + 1]) REQUIRE(gcdt_rank_of_vertex(&levels, u32(v + 1)) > rank);
  }
}

}  // namespace

TEST_CASE("vertex and rank are inverse to each other for every number of vertices") {
  for (u32 n = 0; n <= 300; ++n)
    for (u32 coarsest : {1u, 2u, 3u, 16u, 1000u}) check_levels(n, coarsest, 1);
  for (u32 n : {1000u, 4095u, 4096u, 4097u, 65537u, 1000003u})
    for (u32 coarsest : {1u, 16u, 1024u}) check_levels(n, coarsest, 1);
  for (u32 n : {(1u << 29) - 2, (1u << 29) - 3, 400000007u})
    for (u32 coarsest : {1u, 1024u}) check_levels(n, coarsest, 99991);
}

TEST_CASE("every rank has its own vertex") {
  for (u32 n : {1u, 2u, 3u, 4u, 5u, 15u, 16u, 17u, 63u, 64u, 65u, 1000u, 5000u}) {
    const Levels levels = make_levels(n, 4);
    std::vector<char> seen(n, 0);
    for (u32 rank = 0; rank < n; ++rank) {
      const u32 v = gcdt_vertex_of_rank(&levels, levels.count - 1, rank);
      REQUIRE(v < n);
      REQUIRE(!seen[v]);
      seen[v] = 1;
    }
  }
}

TEST_CASE("points are compared along the curve as their Morton codes are") {
  std::mt19937 e(2);
  for (int i = 0; i < 1000000; ++i) {
    const u32 px = u32(e()) >> 1, py = u32(e()) >> 1;
    const u32 qx = px ^ (i % 32 == 31 ? 0u : u32(e()) >> (1 + i % 31)), qy = py ^ (u32(e()) >> (1 + i / 31 % 31));
    REQUIRE((gcdt_after_on_curve(px, py, qx, qy) != 0) == (gcdt_morton(px, py) > gcdt_morton(qx, qy)));
    REQUIRE(!gcdt_after_on_curve(px, py, px, py));
  }
}

TEST_CASE("the Morton code interleaves x and y and is undone by gathering") {
  std::mt19937 e(1);
  for (int i = 0; i < 100000; ++i) {
    const u32 x = u32(e()) >> (1 + i % 31), y = u32(e()) >> 1;
    u64 expected = 0;
    for (int bit = 0; bit < 31; ++bit)
      expected |= (u64((x >> bit) & 1) << (2 * bit)) | (u64((y >> bit) & 1) << (2 * bit + 1));
    REQUIRE(gcdt_morton(x, y) == expected);
    REQUIRE(gcdt_gather_bits(expected) == x);
    REQUIRE(gcdt_gather_bits(expected >> 1) == y);
  }
}
