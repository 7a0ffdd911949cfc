// SPDX-License-Identifier: Apache-2.0
// Parts of constraints: in which order they are walked, and what cleaning says of them.
#include <algorithm>
#include <numeric>
#include <random>

#include "constraint_oracle.hpp"
#include "kinds.hpp"
#include "phases/clean.hpp"
#include "phases/walk.hpp"
#include "staged.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::uint32_t together = Tuning::parts_ordered_together;

/// Pieces of which nothing matters but their parts and how many edges these pass.
struct RandomParts {
  std::vector<cl_uint> begins{0}, piece_of, edges;  ///< by piece; by part
  std::vector<cl_uint> weights, passed;             ///< by piece; by part of cleaning
  std::vector<cl_uint2> walked;
  std::uint64_t crossed = 0;
};

/// Every third piece is cut into other parts than when it was cleaned, and pieces that are no whole constraint were not
/// cut then: their parts share their weights. `cleaned`: there are others.
RandomParts make_random(std::uint32_t pieces, bool cleaned, std::uint32_t seed) {
  std::mt19937 random(seed);
  RandomParts made;
  for (std::uint32_t c = 0; c < pieces; ++c) {
    const cl_uint count = 1 + random() % 9, had = !cleaned ? 0 : c % 3 == 2 ? count + 1 : count;
    made.walked.push_back({{had > 0 ? cl_uint(made.passed.size()) : 0, had}});
    cl_uint weight = 0;
    const std::size_t first = made.passed.size();
    for (cl_uint i = 0; i < std::max(had, 1u); ++i) {
      // Few pass much, and some pass nothing.
      const cl_uint edges = random() % 11 == 0 ? random() % 3000 : random() % 60;
      weight += edges;
      if (had > 0) made.passed.push_back(edges);
    }
    for (cl_uint i = 0; i < count; ++i) {
      made.piece_of.push_back(c);
      made.edges.push_back(had == count ? made.passed[first + i] : weight / count);
    }
    made.weights.push_back(weight);
    made.crossed += weight;
    made.begins.push_back(made.begins.back() + count);
  }
  return made;
}

void check_order(runtime::Runtime& runtime, const RandomParts& random, cl_uint beyond) {
  const auto parts_made = static_cast<cl_uint>(random.piece_of.size());
  Plan plan;
  plan.crossings_ordered = 0;
  Pieces pieces;
  pieces.count = static_cast<std::uint32_t>(random.weights.size());
  pieces.walked.crossed = random.crossed;
  pieces.walked.weights = runtime.upload("weights", random.weights);
  pieces.walked.parts = runtime.upload("walked", random.walked);
  pieces.walked.passed = runtime.upload("passed", random.passed);
  PieceParts parts;
  parts.capacity = parts_made + beyond;
  parts.begins = runtime.upload("begins", random.begins);
  std::vector<cl_uint> piece_of = random.piece_of;
  piece_of.resize(parts.capacity, GCDT_NONE);
  PartBegins begins;
  begins.pieces = runtime.upload("pieces of parts", piece_of);
  const auto order = order_parts(runtime, plan, pieces, parts, begins);
  REQUIRE(order.size() == parts.capacity);
  std::vector<cl_uint> read(order.size());
  runtime.read(order, read.data(), read.size());

  // What parts pass that stand in a wrong order differs by less than a class is wide, unless both pass much more than
  // the mean of what there is room for.
  const std::uint64_t each = random.crossed / parts.capacity, unit = each / 32 + 1, most = 127 * unit;
  // With many pieces some are of the last class, which holds all beyond.
  CHECK((pieces.count < 300 || *std::max_element(random.edges.begin(), random.edges.end()) >= most));
  bool permutation = true, falling = true, behind = true;
  for (cl_uint block = 0; block < parts.capacity; block += together) {
    const cl_uint end = std::min(block + together, parts.capacity);
    std::vector<cl_uint> own(read.begin() + block, read.begin() + end);
    for (cl_uint i = 1; i < own.size(); ++i) {
      if (own[i - 1] >= parts_made)
        behind = behind && own[i] >= parts_made;
      else if (own[i] < parts_made && own[i - 1] < parts_made)
        falling =
            falling && (random.edges[own[i]] < random.edges[own[i - 1]] + unit || random.edges[own[i - 1]] >= most);
    }
    std::sort(own.begin(), own.end());
    for (cl_uint i = 0; i < own.size(); ++i) permutation = permutation && own[i] == block + i;
  }
  CHECK(permutation);
  CHECK(falling);
  CHECK(behind);
}

}  // namespace

TEST_CASE("parts that pass about as many edges stand side by side") {
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    for (const std::uint32_t count : {1u, 40u, 300u, 2000u})
      for (const bool cleaned : {true, false})
        for (const cl_uint beyond : {0u, 1u, 700u}) {
          CAPTURE(count);
          CAPTURE(cleaned);
          CAPTURE(beyond);
          check_order(*device.runtime, make_random(count, cleaned, count + beyond), beyond);
        }
  }
}

TEST_CASE("parts have no order where they pass little") {
  runtime::Runtime& runtime = *devices_as_all_kinds().front().runtime;
  Plan plan;
  plan.crossings_ordered = 3;
  Pieces pieces;
  PieceParts parts;
  parts.capacity = 10;
  pieces.walked.crossed = 29;
  CHECK(order_parts(runtime, plan, pieces, parts, {}).size() == 0);
}

// A constraint through a field of vertices that takes an eighth of its length, and a short one beside it.
TEST_CASE("a long piece has more parts where what it crosses lies close together") {
  constexpr std::int64_t width = 1 << 20, field = width / 8;
  std::vector<fixture::Point> points = {{0, field / 2}, {width, field / 2}, {0, 0}, {field / 4, 0}};
  fixture::Random random{11};
  for (int i = 0; i < 4000; ++i)
    points.push_back({width / 2 + std::int64_t(random.below(field)), std::int64_t(random.below(field))});
  const std::vector<Constraint> pairs = {{0, 1}, {2, 3}};
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    runtime::Runtime& runtime = *device.runtime;
    const auto clean = [&](std::uint32_t times, std::uint32_t room) {
      fixture::Staged made(runtime, points, pairs);
      made.plan.least_parts = made.plan.most_parts = 16;
      made.plan.long_piece = times;
      made.plan.long_parts = room;
      const CleanResult result = made.cleaner.clean(made.walked(), made.cleaner.keep(made.plan, {}), made.counters);
      REQUIRE(result.hits == 0);
      REQUIRE(result.pieces.count == 2);
      const WalkedPieces& walked = result.pieces.walked;
      std::vector<cl_uint> passed(walked.passed.size());
      std::vector<cl_uint2> parts(2);
      runtime.read(walked.passed, passed.data(), passed.size());
      runtime.read(walked.parts, parts.data(), 2);
      if (parts[0].s[1] < parts[1].s[1]) std::swap(parts[0], parts[1]);
      CHECK(parts[1].s[1] == 1);
      const auto first = passed.begin() + parts[0].s[0], end = first + parts[0].s[1];
      CHECK(parts[0].s[1] <= 17 * times);
      return std::make_pair(std::accumulate(first, end, cl_uint{0}), *std::max_element(first, end));
    };
    const auto [few, longest_of_few] = clean(1, 16);
    const auto [all, longest] = clean(8, 128);
    const auto [same, longest_without_room] = clean(8, 16);
    CHECK(all > 100);
    CHECK(few == all);
    CHECK(same == all);
    CHECK(longest_of_few > all / 4);
    CHECK(longest_without_room == longest_of_few);
    CHECK(longest < all / 8);
  }
}

TEST_CASE("cleaning counts what each part passes") {
  fixture::Random random{5};
  const std::vector<fixture::Point> points = fixture::make_points("uniform", 900, 3);
  const std::vector<Constraint> pairs = fixture::random_constraints(points, 60, random);
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    runtime::Runtime& runtime = *device.runtime;
    fixture::Staged made(runtime, points, pairs);
    const CleanResult clean = made.cleaner.clean(made.walked(), made.cleaner.keep(made.plan, {}), made.counters);
    const WalkedPieces& walked = clean.pieces.walked;
    REQUIRE(clean.pieces.count > 0);
    std::vector<cl_uint> weights(clean.pieces.count), passed(walked.passed.size());
    std::vector<cl_uint2> parts(clean.pieces.count);
    runtime.read(walked.weights, weights.data(), weights.size());
    runtime.read(walked.passed, passed.data(), passed.size());
    runtime.read(walked.parts, parts.data(), parts.size());
    std::uint64_t all = 0, cut = 0;
    for (std::uint32_t c = 0; c < clean.pieces.count; ++c) {
      if (parts[c].s[1] == 0) continue;
      const auto first = passed.begin() + parts[c].s[0];
      CHECK(std::accumulate(first, first + parts[c].s[1], cl_uint{0}) == weights[c]);
      all += weights[c], cut += parts[c].s[1] > 1;
    }
    CHECK(all > 0);
    CHECK(cut > 0);
  }
}
