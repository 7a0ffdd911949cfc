// SPDX-License-Identifier: Apache-2.0
// Refinement of results that are refined already, and of meshes that were adopted.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "refine_options.hpp"
#include "whole_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Options in_domain(Domain domain, bool regions = false) {
  Options options;
  options.domain = domain;
  options.regions = regions;
  return options;
}

// A square, halved by a constraint.
Workload halves() {
  return {{{0, 0}, {3, 0}, {8, 0}, {8, 8}, {3, 8}, {0, 8}}, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}, {4, 1}}};
}

/// The first number of added vertices is right, the first ones are those of `before`, and the rest is in order, on what
/// was there before it.
void check_numbers(const Workload& work, const Triangulation& before, const Triangulation& mesh) {
  const std::size_t first = before.added.size(), n = work.points.size();
  REQUIRE(mesh.added.size() >= first);
  REQUIRE(mesh.added_origin.size() == mesh.added.size());
  for (std::size_t i = 0; i < mesh.added.size(); ++i) {
    const auto& on = mesh.added_origin[i];
    if (i < first) {
      CHECK(mesh.added_on_grid[i] == before.added_on_grid[i]);
      CHECK(on == before.added_origin[i]);
      continue;
    }
    if (i > first) CHECK(mesh.added_on_grid[i - 1] < mesh.added_on_grid[i]);
    CHECK(on[0] < n + mesh.added.size());
    if (on[2] == UINT32_MAX && on[3] != UINT32_MAX) CHECK(on[3] < work.constraints.size());
  }
}

std::string reason(const Workload& work, const Triangulation& mesh, Options options, const Refinement& refine,
                   std::uint64_t refinements) {
  options.refine = refine;
  MeshView all = view(mesh);
  all.added = mesh.added_on_grid;
  all.added_origin = mesh.added_origin;
  const RefinedVerification found = verify_refined(work.points, work.constraints, all, mesh.statistics.grid, options);
  if (!found.valid) return found.reason;
  CHECK(found.refinements == refinements);
  CHECK(found.input_angle == mesh.statistics.refine.left_input_angle);
  CHECK(found.beside_angle == mesh.statistics.refine.left_beside_angle);
  CHECK(found.move == doctest::Approx(mesh.statistics.refine.move));
  return found.reason;
}

/// The mesh of a result, as another program would hand it over: any order and first corner.
Triangles disordered(const Triangulation& mesh, std::uint64_t seed) {
  Triangles triangles(mesh.triangles.begin(), mesh.triangles.end());
  Random random(seed);
  shuffle(triangles, random);
  for (auto& t : triangles) std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.below(3)), t.end());
  return triangles;
}

/// All but what labels regions, which adopted meshes have not.
bool same_mesh(Triangulation a, Triangulation b) {
  for (Triangulation* mesh : {&a, &b}) {
    mesh->region.clear(), mesh->depth.clear();
    mesh->winding.clear(), mesh->region_seed.clear();
  }
  return same_bytes(a, b);
}

}  // namespace

TEST_CASE("a refined result is refined further, and its vertices stay") {
  for (std::uint32_t seed = 1; seed <= 12; ++seed)
    for (const Domain domain : {Domain::hull, Domain::even_odd}) {
      CAPTURE(seed);
      CAPTURE(static_cast<int>(domain));
      const Workload work = random_pslg(20 + 5 * seed, 1u << (10 + seed), 8 + seed, seed);
      const Options options = in_domain(domain, seed % 2 == 0);
      const double extent = std::ldexp(1.0, int(10 + seed));
      const Result plain = solver().solve(work.points, work.constraints, options);
      const Result once = plain.refine(refinement(20)), twice = once.refine(refinement(25, extent * extent / 200)),
                   thrice = twice.refine(refinement(0, extent * extent / 900));
      const Triangulation first = once.download(), second = twice.download(), third = thrice.download();
      if (!first.triangles.empty()) CHECK(third.added.size() > second.added.size());
      check_numbers(work, first, second);
      check_numbers(work, second, third);
      CHECK(second.statistics.refine.added == second.added.size() - first.added.size());
      CHECK(third.statistics.vertices_added == third.added.size());
      const auto rows = [&](const std::vector<std::size_t>& counts) {
        std::uint64_t count = 0;
        for (std::size_t i = 1; i < counts.size(); ++i) count += counts[i] > counts[i - 1];
        return count;
      };
      const std::size_t a = first.added.size(), b = second.added.size(), c = third.added.size();
      if (first.statistics.refine.left_refused + second.statistics.refine.left_refused > 0) continue;
      CHECK(reason(work, second, options, refinement(25, extent * extent / 200), rows({0, a, b})) == "");
      CHECK(reason(work, third, options, refinement(0, extent * extent / 900), rows({0, a, b, c})) == "");
    }
}

TEST_CASE("refining to the same bound again adds nothing and changes nothing") {
  for (std::uint32_t seed = 1; seed <= 16; ++seed)
    for (const bool conforming : {false, true}) {
      CAPTURE(seed);
      CAPTURE(conforming);
      // On coarse grids, too, where much is left, and constraints are bent.
      const Workload work = random_pslg(15 + 3 * seed, 40u << (seed % 12), 10 + seed, seed);
      Options options = in_domain(seed % 3 == 0 ? Domain::outer : Domain::hull, true);
      options.grid = FixedGrid{};
      Refinement refine = refinement(seed % 4 == 0 ? 28 : 20);
      refine.conforming = conforming;
      std::vector<double> sizes;
      for (const auto& p : work.points) sizes.push_back(10 + double(p[0]) / 5);
      if (seed % 2 == 0) refine.sizes = sizes;
      const Result once = solver().solve(work.points, work.constraints, options).refine(refine);
      const Result twice = once.refine(refine);
      CHECK(twice.statistics().refine.added == 0);
      CHECK(twice.statistics().refine.rounds == 0);
      CHECK(twice.statistics().refine.encroached == once.statistics().refine.encroached);
      CHECK(twice.statistics().refine.move == once.statistics().refine.move);
      CHECK(same_bytes(once.download(), twice.download()));
    }
}

TEST_CASE("a limit that was reached can be raised") {
  const Workload work = random_pslg(60, 1 << 20, 40, 5);
  Refinement refine = refinement(25);
  refine.most_added = 20;
  const Result part = solver().solve(work.points, work.constraints).refine(refine);
  CHECK(!part.statistics().refine.complete);
  CHECK(part.statistics().notes.size() == 1);
  const Result whole = part.refine(refinement(25));
  CHECK(whole.statistics().refine.complete);
  CHECK(whole.statistics().notes.empty());
  check_numbers(work, part.download(), whole.download());
  CHECK(reason(work, whole.download(), {}, refinement(25), 2) == "");
  const Result next = part.refine(refine);  // the limit is of each
  CHECK(next.statistics().refine.added == 20);
  CHECK(next.statistics().vertices_added == 40);
}

TEST_CASE("lengths at vertices and areas of regions hold for a refined result, too") {
  const Workload work = halves();
  Options options = in_domain(Domain::outer, true);
  options.region_seeds = {{0.5, 7}, {7.5, 1}};
  const std::vector<double> sizes = {0.2, 2, 2, 2, 2, 2}, areas = {0.05, HUGE_VAL};
  Refinement by_length = refinement(20), by_region = refinement(20);
  by_length.sizes = sizes;
  by_region.region_areas = areas;
  const Result once = solver().solve(work.points, work.constraints, options).refine(refinement(20, 4));
  REQUIRE(once.statistics().refine.added > 0);
  const Triangulation graded = once.refine(by_length).download(), fine = once.refine(by_region).download();
  CHECK(graded.added.size() > once.download().added.size());
  CHECK(reason(work, graded, options, by_length, 2) == "");
  CHECK(reason(work, fine, options, by_region, 2) == "");
  Refinement finer = by_length;
  const std::vector<double> half = {0.1, 1, 1, 1, 1, 1};
  finer.sizes = half;
  const Result third = once.refine(by_length).refine(finer);
  CHECK(reason(work, third.download(), options, finer, 3) == "");
  std::size_t of_first = 0;
  for (const auto seed : fine.region_seed) of_first += seed == 0;
  CHECK(of_first >= std::size_t(24 / 0.05));
}

TEST_CASE("crossings that were split are refined further; their lengths are refused") {
  const Workload work = random_crossing(30, 1 << 20, 12, 4);
  Options options;
  options.crossing = Crossing::split;
  const Result once = solver().solve(work.points, work.constraints, options).refine(refinement(20));
  const Result twice = once.refine(refinement(28));
  CHECK(twice.download().added.size() > once.download().added.size());
  CHECK(once.refine(refinement(20)).download().added == once.download().added);
  check_numbers(work, once.download(), twice.download());
  const std::vector<double> sizes(work.points.size(), 1.0);
  Refinement refine = refinement(20);
  refine.sizes = sizes;
  CHECK_THROWS_WITH_AS(once.refine(refine), doctest::Contains("sizes do not go with crossings that are split"), Error);
}

TEST_CASE("values at vertices of both refinements are linear where the input's are") {
  const Workload work = halves();
  const Triangulation mesh =
      solver().solve(work.points, work.constraints).refine(refinement(20, 2)).refine(refinement(25, 0.3)).download();
  std::vector<double> values;
  for (const auto& p : work.points) values.push_back(3 * p[0] - 2 * p[1] + 1);
  const auto at =
      added_values(work.points, work.constraints, mesh.added, mesh.added_crossing, mesh.added_origin, values);
  REQUIRE(at.size() == mesh.added.size());
  for (std::size_t i = 0; i < at.size(); ++i)
    CHECK(at[i] == doctest::Approx(3 * mesh.added[i][0] - 2 * mesh.added[i][1] + 1).epsilon(1e-6));
}

TEST_CASE("an adopted mesh is refined to the bytes of the result that it was") {
  for (std::uint32_t seed = 1; seed <= 10; ++seed)
    for (const Domain domain : {Domain::hull, Domain::even_odd, Domain::outer}) {
      CAPTURE(seed);
      CAPTURE(static_cast<int>(domain));
      const Workload work =
          seed % 2 ? random_pslg(20 + 4 * seed, 100u << seed, 10 + seed, seed) : nested_squares(10 * seed);
      const Result own = solver().solve(work.points, work.constraints, in_domain(domain));
      const Result adopted = solver().adopt(work.points, disordered(own.download(), seed), work.constraints);
      Refinement refine = refinement(25);
      refine.splits = seed % 5 == 0 ? Splits::inner : Splits::all;
      CHECK(same_mesh(own.refine(refine).download(), adopted.refine(refine).download()));
      refine.least_angle = 30;
      refine.most_added = 4000;
      CHECK(same_mesh(own.refine(refinement(25)).refine(refine).download(),
                      adopted.refine(refinement(25)).refine(refine).download()));
    }
}

TEST_CASE("an adopted mesh that is not Delaunay is made so, within its own border") {
  // Two triangles of a flat quadrilateral with the wrong diagonal, and one beside them; the hull has more.
  const Workload work = {{{0, 0}, {10, 0}, {13, 3}, {3, 3}, {20, 0}, {0, 20}}, {}};
  const Triangles wrong = {{0, 1, 2}, {0, 2, 3}, {1, 4, 2}};
  const Result adopted = solver().adopt(work.points, wrong);
  const Triangulation before = adopted.download();
  const Result refined = adopted.refine(refinement(20, 1.5));
  CHECK(same_bytes(before, adopted.download()));
  CHECK(refined.triangles().size() > 30);
  CHECK(refined.quality().largest_area <= 1.5);
  CHECK(refined.quality().area == doctest::Approx(adopted.quality().area));
  CHECK(refined.locate(std::vector<std::array<double, 2>>{{1, 10}, {5, 1}, {14, 1}}) ==
        std::vector<std::int32_t>{-1, refined.locate(std::vector<std::array<double, 2>>{{5, 1}})[0],
                                  refined.locate(std::vector<std::array<double, 2>>{{14, 1}})[0]});
  // The same with the border as constraints, whose domain that is: the same triangles, but for flags and sources.
  const std::vector<Constraint> border = {{0, 1}, {1, 4}, {4, 2}, {2, 3}, {3, 0}};
  const Triangulation
      one = solver().adopt(work.points, wrong, border).refine(refinement(20, 1.5)).download(),
      own = solver().solve(work.points, border, in_domain(Domain::outer)).refine(refinement(20, 1.5)).download();
  CHECK(same_mesh(one, own));
  CHECK(one.triangles == refined.triangles());
  CHECK(one.added_on_grid == refined.added_on_grid());
  CHECK(refined.constrained() == std::vector<std::uint8_t>(refined.triangles().size(), 0));
  CHECK(reason({work.points, border}, one, in_domain(Domain::outer), refinement(20, 1.5), 1) == "");
}

TEST_CASE("an adopted mesh has no regions, and may be empty") {
  const Workload work = halves();
  const std::vector<double> one = {1};
  Refinement refine = refinement(20);
  refine.region_areas = one;
  const Triangulation mesh = solver().triangulate(work.points, work.constraints);
  CHECK_THROWS_WITH_AS(solver().adopt(work.points, mesh.triangles, work.constraints).refine(refine),
                       doctest::Contains("the result has no regions"), Error);
  const Result nothing = solver().adopt(work.points, Triangles{}, work.constraints).refine(refinement(20));
  CHECK(nothing.triangles().empty());
  CHECK(nothing.download().added.empty());
  CHECK(nothing.refine(refinement(25)).triangles().empty());
}

TEST_CASE("a mesh in which a vertex was put on a later one is not accepted") {
  const Workload work = halves();
  const Result twice =
      solver().solve(work.points, work.constraints).refine(refinement(20, 4)).refine(refinement(20, 1));
  Triangulation mesh = twice.download();
  CHECK(reason(work, mesh, {}, refinement(20, 1), 2) == "");
  const auto n = static_cast<std::uint32_t>(work.points.size());
  mesh.added_origin[0][0] = n + static_cast<std::uint32_t>(mesh.added.size()) - 1;
  CHECK(reason(work, mesh, {}, refinement(20, 1), 2).find("added vertices are not in order from vertex ") == 0);
}
