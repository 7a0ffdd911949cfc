// SPDX-License-Identifier: Apache-2.0
// Why triangles are left: the solver says it of each one, the host's proof finds it anew by other code, and every
// reason is reached.
#include <doctest/doctest.h>

#include <algorithm>

#include "proof/mending.hpp"
#include "refine_options.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

struct Made {
  Workload work;
  Options options;
  Triangulation mesh;

  Made(Workload given, const Options& wanted)
      : work(std::move(given)), options(wanted), mesh(solver().triangulate(work.points, work.constraints, options)) {}

  RefinedVerification verified() const {
    MeshView all = view(mesh);
    all.added = mesh.added_on_grid;
    all.added_origin = mesh.added_origin;
    return verify_refined(work.points, work.constraints, all, mesh.statistics.grid, options);
  }
};

using Counts = std::array<std::uint64_t, 8>;

Counts counted(const Array<std::uint8_t>& excuses) {
  Counts counts = {};
  for (const std::uint8_t excuse : excuses) ++counts.at(excuse);
  return counts;
}

Counts told(const Statistics& s) {
  const auto& r = s.refine;
  const std::uint64_t all =
      r.left_input_angle + r.left_beside_angle + r.left_grid + r.left_limit + r.left_fixed + r.left_refused;
  return {s.triangles - all, r.left_input_angle, r.left_beside_angle, r.left_grid - r.left_target,
          r.left_limit,      r.left_target,      r.left_fixed,        r.left_refused};
}

Counts proved(const RefinedVerification& p, std::uint64_t triangles) {
  const std::uint64_t all = p.input_angle + p.beside_angle + p.short_side + p.limit + p.target + p.fixed + p.refused;
  return {triangles - all, p.input_angle, p.beside_angle, p.short_side, p.limit, p.target, p.fixed, p.refused};
}

/// The solver's word for each triangle is the proof's, and both are counted.
Counts check_excuses(const Made& made) {
  const RefinedVerification found = made.verified();
  CHECK(found.reason == "");
  CHECK(found.excuses == std::vector<std::uint8_t>(made.mesh.excuse.begin(), made.mesh.excuse.end()));
  const Counts counts = counted(made.mesh.excuse);
  CHECK(counts == told(made.mesh.statistics));
  CHECK(counts == proved(found, made.mesh.triangles.size()));
  return counts;
}

}  // namespace

TEST_CASE("on grids of every fineness the proof finds the solver's reason for each triangle that is left") {
  Counts all = {};
  for (std::uint32_t seed = 1; seed <= 120; ++seed)
    for (const Domain domain : {Domain::hull, Domain::even_odd}) {
      CAPTURE(seed);
      CAPTURE(static_cast<int>(domain));
      Options options = refining_on_grid(seed % 5 == 0 ? 33 : 20);
      options.domain = domain;
      options.refine->conforming = seed % 4 == 1;
      options.refine->most_added = seed % 7 == 0 ? seed : 4000;
      if (seed % 6 == 0) options.refine->splits = seed % 12 == 0 ? Splits::none : Splits::inner;
      if (seed % 3 == 0) options.refine->most_area = double(40u << (seed % 10));
      const Made made(random_crossing(8 + seed % 20, 40u << (seed % 9), 10, seed), options);
      const Counts counts = check_excuses(made);
      for (std::size_t i = 0; i < counts.size(); ++i) all[i] += counts[i];
    }
  for (std::size_t i = 0; i < all.size(); ++i) {
    CAPTURE(i);
    CHECK((all[i] > 0) == (i != GCDT_EXCUSE_TARGET));
  }
}

// The circumcentre of a triangle with sides of 8 cells is rounded by less than what is between its distance from other
// vertices and the one that gives a target up (docs/refinement.md): so no mesh of a call has this reason.
TEST_CASE("a target too near a vertex, of a triangle that is no one's to mend") {
  const proof::Sites sites({{0, 0}, {64, 0}, {32, 55}, {100, 60}});
  std::uint64_t steps = 0;
  proof::Completion mesh(sites, steps);
  mesh.sort();
  std::uint32_t t = 0;
  while (std::find(mesh.triangles()[t].begin(), mesh.triangles()[t].end(), 3u) != mesh.triangles()[t].end()) ++t;
  const std::vector<char> keep(mesh.triangles().size(), 1);
  const std::vector<std::uint32_t> piece_of(3 * keep.size(), proof::none);
  const std::vector<proof::Piece> pieces;
  const Refinement refine;
  Grid unit;
  unit.kind = Grid::Kind::fixed;
  const proof::Wanted wanted(refine, unit);
  const proof::Mending mending({sites, mesh, keep, pieces, piece_of}, wanted, refine);
  // Its centre is at 0.58 of a side: farther than half a side, nearer than the root of 5/8.
  const proof::Shape shape = proof::shape_of(sites, mesh.triangles()[t]);
  CHECK(mending.excuse(t, shape, false) == proof::Excuse::limit);
  CHECK(mending.excuse(t, shape, true) == proof::Excuse::target);
}

TEST_CASE("what is not so is not accepted") {
  // By the last round of a limit, whose triangles a vertex would mend.
  Options options = refining_on_grid(25);
  options.refine->most_added = 30;
  Made made(random_pslg(60, 1 << 20, 30, 3), options);
  const Counts counts = check_excuses(made);
  REQUIRE(counts[GCDT_EXCUSE_LIMIT] > 0);
  made.options.refine->most_added = UINT64_MAX;
  CHECK(made.verified().reason.find("has an angle below the least one, and nothing excuses it") != std::string::npos);
  // What may not be split is the reason only if it may not.
  options = refining_on_grid(25);
  options.refine->splits = Splits::none;
  Made fixed(random_pslg(60, 1 << 20, 30, 3), options);
  REQUIRE(check_excuses(fixed)[GCDT_EXCUSE_FIXED] > 0);
  fixed.options.refine->splits = Splits::all;
  CHECK(fixed.verified().reason.find("has an angle below the least one, and nothing excuses it") != std::string::npos);
}

TEST_CASE("a result that is refined says it of its triangles, one that is not says nothing") {
  const Workload work = random_pslg(30, 1 << 20, 20, 9);
  const Result plain = solver().solve(work.points, work.constraints);
  CHECK(plain.excuse().empty());
  Refinement refine;
  refine.most_added = 5;
  const Result some = plain.refine(refine);
  CHECK(some.excuse().size() == some.triangles().size());
  CHECK(counted(some.download().excuse) == told(some.statistics()));
  CHECK(counted(some.download().excuse)[GCDT_EXCUSE_LIMIT] > 0);
  const Triangulation whole = some.refine(Refinement{}).download();
  CHECK(counted(whole.excuse)[GCDT_EXCUSE_LIMIT] == 0);
}
