// SPDX-License-Identifier: Apache-2.0
// gcdt_result_refine through the interface: what is refused, what a call that fails leaves, and lives of the two
// results. What the refined result is, refine_result_test knows.
#include <doctest/doctest.h>

#include <cmath>
#include <optional>

#include "whole_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Doubles = std::vector<std::array<double, 2>>;

// A square, halved by a constraint.
const Doubles halves = {{0, 0}, {3, 0}, {8, 0}, {8, 8}, {3, 8}, {0, 8}};
const std::vector<Constraint> walls = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}, {4, 1}};

Refinement wanted(double area = 0.5) {
  Refinement refine;
  refine.most_area = area;
  return refine;
}

Triangulation in_one_call(const Refinement& refine) {
  Options options;
  options.refine = refine;
  return solver().triangulate(halves, walls, options);
}

/// What refining `result` throws.
std::string refused(const Result& result, const Refinement& refine, const Options& options = {}) {
  try {
    result.refine(refine, options);
  } catch (const Error& error) {
    return error.status() == Status::invalid_argument ? error.what() : "another status";
  }
  return "nothing";
}

bool says(const std::string& what, const std::string& part) { return what.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("one result is refined to several bounds, and the results live on their own") {
  std::optional<Result> plain = solver().solve(halves, walls);
  const Triangulation before = plain->download();
  const Result fine = plain->refine(wanted(0.1)), coarse = plain->refine(wanted(4));
  CHECK(same_bytes(plain->download(), before));
  plain.reset();
  CHECK(same_bytes(fine.download(), in_one_call(wanted(0.1))));
  CHECK(same_bytes(coarse.download(), in_one_call(wanted(4))));
  CHECK(fine.statistics().ms.call > 0);
  CHECK(fine.quality().largest_area <= 0.1);
  CHECK(fine.locate(Doubles{{1, 1}, {9, 9}})[0] >= 0);
}

TEST_CASE("bad values are refused as those of a call are") {
  const Result plain = solver().solve(halves, walls);
  const Triangulation before = plain.download();
  Refinement refine = wanted();
  refine.least_angle = 60;
  CHECK(says(refused(plain, refine), "refine.least_angle must be 0, or from 1 to 34 degrees, not 60"));
  CHECK(says(refused(plain, wanted(0)), "refine.most_area must be above 0"));
  refine = wanted();
  const std::vector<double> two = {1, 2};
  refine.sizes = two;
  CHECK(says(refused(plain, refine), "refine.sizes has 2 lengths for 6 vertices"));
  refine = wanted();
  refine.region_areas = two;
  CHECK(says(refused(plain, refine), "the result has no regions"));
  Options with_seed;
  with_seed.regions = true;
  with_seed.region_seeds = {{1, 1}};
  CHECK(says(refused(solver().solve(halves, walls, with_seed), refine), "region_areas has 2 areas for 1 region seeds"));
  Options split;
  split.crossing = Crossing::split;
  const std::vector<double> four(4, 1.0);
  refine = wanted();
  refine.sizes = four;
  const Doubles corners = {{0, 0}, {8, 8}, {8, 0}, {0, 8}};
  const Result crossed = solver().solve(corners, std::vector<Constraint>{{0, 1}, {2, 3}}, split);
  CHECK(says(refused(crossed, refine), "sizes do not go with crossings that are split"));
  CHECK(same_bytes(plain.download(), before));
}

TEST_CASE("options that are the result's own are refused") {
  const Result plain = solver().solve(halves, walls);
  std::vector<Options> all(8);
  all[0].crossing = Crossing::drop;
  all[1].grid = FixedGrid{};
  all[2].domain = Domain::outer;
  all[3].regions = true;
  all[4].distinct = true;
  all[5].hole_seeds = {{1, 1}};
  all[6].region_seeds = {{1, 1}};
  all[7].refine = wanted();
  for (std::size_t i = 0; i < all.size(); ++i) {
    CAPTURE(i);
    CHECK(says(refused(plain, wanted(), all[i]),
               i < 7 ? "a result has its grid, constraints and regions" : "gcdt_options.refine must be null"));
  }
}

TEST_CASE("null pointers and sizes of structures") {
  const Result plain = solver().solve(halves, walls);
  gcdt_refinement refine = GCDT_REFINEMENT_INIT;
  gcdt_result* made = nullptr;
  CHECK(gcdt_result_refine(nullptr, &refine, nullptr, &made) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_result_refine(plain.handle(), nullptr, nullptr, &made) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_result_refine(plain.handle(), &refine, nullptr, nullptr) == GCDT_ERROR_INVALID_ARGUMENT);
  refine.struct_size = 8;
  CHECK(gcdt_result_refine(plain.handle(), &refine, nullptr, &made) == GCDT_ERROR_STRUCT_SIZE);
  CHECK(made == nullptr);
  refine.struct_size = sizeof refine;
  refine.most_area = 1;
  REQUIRE(gcdt_result_refine(plain.handle(), &refine, nullptr, &made) == GCDT_OK);
  CHECK(gcdt_result_count(made, GCDT_ADDED) > 0);
  gcdt_result_release(made);
}

TEST_CASE("a call that is cancelled leaves the result and the solver as they were") {
  const Result plain = solver().solve(halves, walls);
  const Triangulation before = plain.download();
  Options stop;
  int ticks = 0;
  stop.progress = [&](const char* phase, double) {
    CHECK((std::string(phase) == "refine" || std::string(phase) == "flip"));
    return ++ticks < 4;
  };
  CHECK_THROWS_AS(plain.refine(wanted(1e-3), stop), Error);
  CHECK(ticks == 4);
  CHECK(same_bytes(plain.download(), before));
  CHECK(same_bytes(plain.refine(wanted()).download(), in_one_call(wanted())));
}

TEST_CASE("a limit that is reached is no error, and an incomplete result says so") {
  const Result plain = solver().solve(halves, walls);
  Refinement refine = wanted(0.01);
  refine.most_added = 100;
  const Result made = plain.refine(refine);
  const Statistics s = made.statistics();
  CHECK(s.refine.added == 100);
  CHECK(!s.refine.complete);
  REQUIRE(s.notes.size() == 1);
  CHECK(says(s.notes[0], "the limit of added vertices ended the refinement"));
  CHECK(same_bytes(made.download(), in_one_call(refine)));
}

TEST_CASE("the calling thread may not refine from a callback of the same solver") {
  const Result plain = solver().solve(halves, walls);
  std::int32_t status = GCDT_OK;
  gcdt_refinement refine = GCDT_REFINEMENT_INIT;
  Options options;
  options.progress = [&](const char*, double) {
    gcdt_result* made = nullptr;
    status = gcdt_result_refine(plain.handle(), &refine, nullptr, &made);
    return true;
  };
  solver().solve(halves, walls, options);
  CHECK(status == GCDT_ERROR_IN_USE);
}
