// SPDX-License-Identifier: Apache-2.0
// Outlines of many vertices with nothing inside: most triangles are slivers whose cavities have hundreds of faces, and
// share them (docs/refinement.md, "A round").
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "kinds.hpp"
#include "refine_options.hpp"
#include "refine_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

runtime::Runtime& usual() { return *devices_as_all_kinds().front().runtime; }

/// A polygon of `n` vertices at about equal distances on an ellipse.
Workload outline(std::uint32_t n, double width, double height) {
  Workload work;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / n;
    work.points.push_back({std::round(width * (1 + std::cos(angle))), std::round(height * (1 + std::sin(angle)))});
    work.constraints.push_back({i, (i + 1) % n});
  }
  return work;
}

/// 2^31 times the tangent.
std::uint64_t tangent_of(double degrees) {
  return static_cast<std::uint64_t>(std::llround(std::ldexp(std::tan(degrees * std::acos(-1.0) / 180), 31)));
}

}  // namespace

TEST_CASE("vertices on an outline are mended by few candidates each, however many there are") {
  for (const std::uint32_t n : {500u, 2000u, 8000u})
    for (const double flat : {1.0, 0.1}) {
      CAPTURE(n);
      CAPTURE(flat);
      const Workload work = outline(n, 1 << 29, flat * (1 << 29));
      Options options = refining_on_grid();
      options.domain = Domain::nonzero;
      const RefinedResult r = result_of(usual(), work, options);
      CHECK(mesh_fault(r) == "");
      CHECK(r.refined.all_left() == 0);
      CHECK(sharp_triangles(r, tangent_of(20)) == 0);
      CHECK(r.refined.added > n / 2);
      // Each candidate has gone through its cavity, which is nearly all of the mesh in the beginning.
      CHECK(r.refined.candidates < 4 * r.refined.added);
      CHECK(r.refined.rounds < 300);
    }
}

// Without the handicap that slivers between slivers have from the start there are 3.6 and 3.2 aims for each vertex.
TEST_CASE("slivers between slivers do not all aim once to find that their cavities are too large") {
  for (const std::size_t n : {20000u, 98000u}) {
    CAPTURE(n);
    Options options = refining_on_grid();
    options.domain = Domain::nonzero;
    const RefinedResult r = result_of(usual(), on_integers(letters(n)), options);
    CHECK(mesh_fault(r) == "");
    CHECK(r.refined.added > n);
    CHECK(r.refined.aims > r.refined.candidates);
    CHECK(2 * r.refined.aims < 5 * r.refined.added);
    CHECK(r.refined.rounds < 200);
  }
}

TEST_CASE("who aims is drawn alike on every device and for every order of the vertices") {
  Random random(7);
  for (const std::uint32_t n : {12u, 40u, 300u}) {
    CAPTURE(n);
    const Workload work = outline(n, 1 << 26, 1 << 25);
    Options options = refining_on_grid(25);
    options.domain = Domain::nonzero;
    const RefinedResult expected = result_of(usual(), work, options);
    for (Treated& device : devices_as_all_kinds()) {
      CAPTURE(device.name);
      CHECK(same(result_of(*device.runtime, work, options), expected));
    }
    CHECK(by_coordinates(result_of(usual(), shuffled_vertices(work, random), options)) == by_coordinates(expected));
  }
}

TEST_CASE("cavities of any size are gone through alike on every device") {
  for (const bool within : {true, false})
    for (const Workload& work : {on_integers(letters(1500)), outline(800, 1 << 29, 1 << 29)}) {
      CAPTURE(within);
      CAPTURE(work.points.size());
      Options options = refining_on_grid();
      if (within) options.domain = Domain::nonzero;
      const RefinedResult expected = result_of(usual(), work, options);
      CHECK(expected.refined.added > 600);
      for (Treated& device : devices_as_all_kinds()) {
        CAPTURE(device.name);
        const RefinedResult r = result_of(*device.runtime, work, options);
        CHECK(r.refined.rounds == expected.refined.rounds);
        CHECK(same(r, expected));
      }
    }
}

TEST_CASE("outlines of a few vertices are mended, too, where all triangles may sit out") {
  for (std::uint32_t n = 20; n < 60; ++n) {
    CAPTURE(n);
    Options options = refining_on_grid();
    options.domain = Domain::nonzero;
    const RefinedResult r = result_of(usual(), outline(n, 1 << 26, 1 << 26), options);
    CHECK(mesh_fault(r) == "");
    CHECK(r.refined.all_left() == 0);
  }
}

// A triangle that is the only one to be mended, and aims at the middle of a circle on which all vertices lie: the
// cavity is all of the mesh. Each search in vain lets it go through twice as many faces, from 8 on: after 8 of them
// through 2048.
TEST_CASE("while all sit out, cavities of twice as many faces are allowed in each search") {
  const std::uint32_t n = 2000;
  const Workload work = outline(n, 1 << 26, 1 << 26);
  Options options = refining_on_grid(0);
  options.domain = Domain::nonzero;
  options.refine->most_area = std::ldexp(1.0, 60);
  const RefinedResult coarse = result_of(usual(), work, options);
  REQUIRE(coarse.triangles.size() == n - 2);
  std::vector<double> areas;
  for (const auto& t : coarse.triangles) {
    const auto &a = coarse.points[t[0]], &b = coarse.points[t[1]], &c = coarse.points[t[2]];
    areas.push_back(0.5 * double((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])));
  }
  std::sort(areas.begin(), areas.end(), std::greater<>());
  REQUIRE(areas[0] > areas[1]);
  options.refine->most_area = (areas[0] + areas[1]) / 2;
  const RefinedResult r = result_of(usual(), work, options);
  CHECK(mesh_fault(r) == "");
  CHECK(r.refined.all_left() == 0);
  CHECK(r.refined.added == 1);
  CHECK(r.refined.rounds == 1);
  CHECK(r.refined.searches > 2);  // one that finds it, one that finds that all is well, and those in vain
  CHECK(r.refined.searches <= 2 + 8);
}

TEST_CASE("quotients are rounded half up, exactly") {
  __extension__ typedef __int128 Wide;
  std::mt19937_64 random(5);
  for (int i = 0; i < 400000; ++i) {
    const auto bits = [&](unsigned most) { return static_cast<std::int64_t>(random() >> (64 - most)); };
    const std::int64_t denominator = std::max<std::int64_t>(1, bits(1 + unsigned(random() % 63)));
    const std::int64_t sign = random() % 2 == 0 ? 1 : -1, whole = sign * bits(1 + unsigned(random() % 38));
    // Near halves, and anywhere.
    const Wide beside[] = {denominator / 2,       -(denominator / 2), denominator / 2 + 1, -(denominator / 2) - 1, 0,
                           bits(63) % denominator};
    const Wide numerator = Wide(whole) * denominator + beside[random() % 6], twice = 2 * numerator + denominator;
    Wide expected = twice / (2 * Wide(denominator));
    if (twice < 0 && twice % (2 * Wide(denominator)) != 0) --expected;
    device::Int128 limbs;
    limbs.low = static_cast<device::u64>(numerator);
    limbs.high = static_cast<device::i64>(numerator >> 64);
    REQUIRE(device::gcdt_round_quotient(limbs, denominator) == static_cast<std::int64_t>(expected));
  }
}
