// SPDX-License-Identifier: Apache-2.0
// The host's proof of refined meshes: it accepts what the library makes, on fine grids and on coarse ones, and names
// what is wrong with a mesh that was tampered with.
#include <doctest/doctest.h>

#include "proof/chains.hpp"
#include "refine_options.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

MeshView whole_view(const Triangulation& mesh) {
  MeshView all = view(mesh);
  all.added = mesh.added_on_grid;
  all.added_origin = mesh.added_origin;
  return all;
}

struct Made {
  Workload work;
  Options options;
  Triangulation mesh;

  Made(Workload given, Options wanted)
      : work(std::move(given)),
        options(std::move(wanted)),
        mesh(solver().triangulate(work.points, work.constraints, options)) {}

  RefinedVerification verified(const MeshView& mesh_view) const {
    return verify_refined(work.points, work.constraints, mesh_view, mesh.statistics.grid, options);
  }
  RefinedVerification verified() const { return verified(whole_view(mesh)); }
  std::string reason() const { return verified().reason; }
};

Workload walls() {
  return {{{0, 0}, {3, 0}, {8, 0}, {8, 8}, {3, 8}, {0, 8}, {6, 4}},
          {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}, {4, 1}}};
}

}  // namespace

TEST_CASE("what the library makes is accepted, with as many excuses as it has counted") {
  std::uint64_t input_angles = 0, beside = 0;
  for (std::size_t n = 10; n < 90; n += 10)
    for (const Domain domain : {Domain::hull, Domain::even_odd, Domain::outer, Domain::holes}) {
      CAPTURE(n);
      CAPTURE(static_cast<int>(domain));
      Options options = refining(n % 20 == 0 ? 20 : 26);
      options.crossing = Crossing::drop;
      options.domain = domain;
      options.refine->most_added = 3000;
      if (n % 30 == 0) options.refine->most_area = 500;
      const Made made(n % 3 == 0 ? random_crossing(n, 1000, n / 3, n) : random_pslg(n, 1000, n, n), options);
      if (domain == Domain::holes) CHECK(made.options.hole_seeds.empty());
      const RefinedVerification found = made.verified();
      CHECK(found.reason == "");
      const auto& s = made.mesh.statistics.refine;
      CHECK(found.input_angle == s.left_input_angle);
      CHECK(found.beside_angle == s.left_beside_angle);
      CHECK(found.on_constraints == s.on_subsegments);
      CHECK(found.input_angle + found.beside_angle + found.short_side + found.limit + found.target + found.fixed +
                found.refused ==
            s.left_input_angle + s.left_beside_angle + s.left_grid + s.left_fixed + s.left_refused + s.left_limit);
      CHECK(found.move == doctest::Approx(s.move));
      CHECK(found.excuses == std::vector<std::uint8_t>(made.mesh.excuse.begin(), made.mesh.excuse.end()));
      input_angles += found.input_angle, beside += found.beside_angle;
      MeshView bare = whole_view(made.mesh);
      bare.constrained = nullptr;
      bare.neighbours = nullptr;
      CHECK(made.verified(bare).excuses == found.excuses);
    }
  CHECK(input_angles > 0);
  CHECK(beside > 0);
}

TEST_CASE("on coarse grids constraints are bent, and every mesh is accepted") {
  std::uint64_t bent = 0, far = 0;
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    Options options = refining();
    options.grid = FixedGrid{};
    options.crossing = Crossing::drop;
    options.refine->most_added = 2000;
    const Made made(random_crossing(12, 40u << (seed % 8), 10, seed), options);
    const RefinedVerification found = made.verified();
    CHECK(found.reason == "");
    far += found.far, bent += found.move > 0;
  }
  CHECK(bent > 5);
  CHECK(far > 0);
}

TEST_CASE("splits that are fixed") {
  for (const Splits splits : {Splits::inner, Splits::none}) {
    Options options = refining(25);
    options.domain = Domain::outer;
    options.refine->most_area = 0.5;
    Made made(walls(), options);
    CHECK(made.reason() == "");
    made.options.refine->splits = splits;
    CHECK(made.reason().find("what must not be split, from vertex ") == 0);
    made.mesh = solver().triangulate(made.work.points, made.work.constraints, made.options);
    CHECK(made.reason() == "");
    CHECK(made.verified().fixed > 0);
    CHECK(made.verified().fixed == made.mesh.statistics.refine.left_fixed);
  }
}

TEST_CASE("a mesh that does not keep what is claimed is named") {
  Options options = refining(20);
  options.refine->most_area = 1;
  Made made(walls(), options);
  REQUIRE(made.reason() == "");
  made.options.refine->most_area = 0.5;
  CHECK(made.reason().find("has more than the largest area, and nothing excuses it") != std::string::npos);
  made.options.refine->most_area = 1;
  made.options.refine->least_angle = 34;
  CHECK(made.reason().find("has an angle below the least one, and nothing excuses it") != std::string::npos);
  made.options.refine->most_added = made.mesh.added.size() + 1;  // which was not reached
  CHECK(made.reason().find("has an angle below the least one, and nothing excuses it") != std::string::npos);
  --made.options.refine->most_added;  // now it may be the reason
  CHECK(made.reason() == "");
  CHECK(made.verified().limit > 0);
}

TEST_CASE("areas of regions") {
  Options options = refining(20);
  options.domain = Domain::outer;
  options.region_seeds = {{0.5, 7}, {7.5, 1}, {100, 100}};
  const std::vector<double> areas = {0.25, HUGE_VAL, 1e-9}, more = {0.25, 0.25, 1e-9};
  options.refine->region_areas = areas;
  Made made(walls(), options);
  CHECK(made.reason() == "");
  CHECK(made.mesh.triangles.size() > 100);
  made.options.refine->region_areas = more;
  CHECK(made.reason().find("has more than the largest area, and nothing excuses it") != std::string::npos);
  // With the seeds exchanged, the areas are those of the other side.
  made.options.refine->region_areas = areas;
  std::swap(made.options.region_seeds[0], made.options.region_seeds[1]);
  CHECK(made.reason().find("has more than the largest area, and nothing excuses it") != std::string::npos);
}

TEST_CASE("wanted lengths") {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    const Workload work = random_pslg(40, 1000, 20, seed);
    std::vector<double> sizes;
    for (const auto& p : work.points) sizes.push_back(20 + double(p[0]) / 10);
    Options options = refining(20);
    options.refine->sizes = sizes;
    const Made made(work, options);
    REQUIRE(made.mesh.added_origin.size() > 100);
    CHECK(made.reason() == "");
    const auto reason_of = [&](auto&& change) {
      std::vector<std::array<std::uint32_t, 4>> origins(made.mesh.added_origin.begin(), made.mesh.added_origin.end());
      change(origins);
      MeshView view = whole_view(made.mesh);
      view.added_origin = origins;
      return made.verified(view).reason;
    };
    const auto n = static_cast<std::uint32_t>(work.points.size());
    CHECK(reason_of([](auto& origins) { origins.pop_back(); }).find("wanted lengths need the origins of all ") == 0);
    CHECK(reason_of([&](auto& origins) { origins[3][0] = n + 3; }) == "added vertex " + std::to_string(n + 3) +
                                                                          " has an origin, vertex " +
                                                                          std::to_string(n + 3) + ", that needs it");
    CHECK(reason_of([&](auto& origins) { origins[3][1] = 1u << 30; }).find(", that does not exist") !=
          std::string::npos);
    // All lengths half as long: some triangle is too large for them, or has an angle that these do not excuse.
    std::vector<double> halves;
    for (const double size : sizes) halves.push_back(size / 2);
    Made other = made;
    other.options.refine->sizes = halves;
    CHECK(other.reason().find(", and nothing excuses it") != std::string::npos);
  }
}

TEST_CASE("edges beside constraints are Delaunay where that is wanted") {
  std::size_t plain = 0, proved = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    Options options = refining(20);
    Made made(random_pslg(40, 100000, 20, seed), options);
    if (made.mesh.statistics.refine.left_refused > 0) continue;  // at a hull that was bent; nothing else excuses these
    ++proved;
    CHECK(made.reason() == "");
    made.options.refine->conforming = true;
    plain += made.reason().find("has a corner in the circle over its side from vertex ") != std::string::npos;
    const Made conforming(made.work, made.options);
    CHECK(conforming.reason() == "");
    CHECK(conforming.verified().encroached == conforming.mesh.statistics.refine.encroached);
  }
  CHECK(proved >= 8);
  CHECK(plain > 5);  // without the wish most of them have such an edge
}

TEST_CASE("a mesh that was tampered with is not accepted") {
  Options options = refining(20);
  options.refine->most_area = 2;
  const Made made(walls(), options);
  REQUIRE(made.reason() == "");
  const auto with = [&](auto&& change) {
    Triangulation other = made.mesh;
    change(other);
    return made.verified(whole_view(other)).reason;
  };
  CHECK(with([](auto& m) { m.triangles.pop_back(), m.neighbours.pop_back(), m.constrained.pop_back(); }) != "");
  CHECK(with([](auto& m) { m.triangles[1] = m.triangles[0]; }) != "");
  CHECK(with([](auto& m) { m.triangles[0][0] = 9999; }) == "vertex 9999 does not exist");
  CHECK(with([](auto& m) { std::swap(m.triangles[0][0], m.triangles[0][1]); }) != "");
  CHECK(with([](auto& m) { m.neighbours[0][0] ^= 1; }).find("the neighbour across") != std::string::npos);
  CHECK(with([](auto& m) { m.constrained[0] ^= 7; }) != "");
  CHECK(with([](auto& m) { m.added_on_grid[0] = m.added_on_grid[1]; }) != "");
  CHECK(with([](auto& m) { m.added_on_grid[0][0] += 100; }) != "");
  CHECK(with([](auto& m) { m.added_on_grid[0] = {-1, 0}; }) != "");
  CHECK(with([](auto& m) {
          const auto last = m.added_on_grid.back();
          m.added_on_grid.push_back({last[0], last[1] + 1});
        }).find("is in no triangle") != std::string::npos);
  // One edge flipped: find two triangles of a convex quadrilateral across an edge that is not flagged.
  const std::string flipped = with([](auto& m) {
    const auto& n = m.neighbours;
    for (std::size_t t = 0; t < n.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (n[t][k] >= 0 && !(m.constrained[t] >> k & 1)) {
          const auto u = std::size_t(n[t][k]);
          auto &a = m.triangles[t], &b = m.triangles[u];
          std::size_t j = 0;
          while (n[u][j] != std::int32_t(t)) ++j;
          const auto p = a[k], q = b[j];
          a[(k + 2) % 3] = q, b[(j + 2) % 3] = p;
          return;
        }
  });
  CHECK(flipped != "");
}

TEST_CASE("a vertex of the input that a chain has passed is named") {
  // From 0 to 1 by 4; 2 is above both and 3 below both, unless the chain rises to y = 2.
  const auto reason = [](proof::Vertex beside, std::int32_t height) {
    const proof::Sites sites({{0, 0}, {64, 1}, beside, {20, -1}, {32, height}});
    std::vector<proof::Piece> pieces = {{0, 1, true, true, true, proof::none, proof::none}};
    pieces[0].chain = {0, 4, 1};
    return proof::prove_sides(sites, 4, pieces);
  };
  CHECK(reason({40, 2}, 1) == "");
  CHECK(reason({40, 0}, 1) == "");
  CHECK(reason({40, 0}, 0) == "");
  CHECK(reason({16, 0}, 0) == "vertex 2 has changed sides of what runs from vertex 0 to 1");  // it is on the link
  CHECK(reason({48, 1}, 0) == "");
  CHECK(reason({40, 1}, 1) == "vertex 2 has changed sides of what runs from vertex 0 to 1");
  CHECK(reason({16, 1}, 2) == "vertex 2 has changed sides of what runs from vertex 0 to 1");
}

TEST_CASE("what is not verified is refused") {
  const Made made(walls(), refining());
  Options options = refining();
  options.crossing = Crossing::split;
  const Grid& grid = made.mesh.statistics.grid;
  CHECK_THROWS_WITH_AS(verify_refined(made.work.points, made.work.constraints, whole_view(made.mesh), grid, options),
                       doctest::Contains("GCDT_CROSSING_SPLIT"), Error);
  CHECK_THROWS_WITH_AS(verify_refined(made.work.points, made.work.constraints, whole_view(made.mesh), grid, {}),
                       doctest::Contains("gcdt_options.refine is null"), Error);
  CHECK_THROWS_WITH_AS(
      verify_domain(made.work.points, made.work.constraints, whole_view(made.mesh), {}, grid, refining()),
      doctest::Contains("gcdt_verify_refined"), Error);
  CHECK_THROWS_WITH_AS(
      verify_refined(made.work.points, made.work.constraints, whole_view(made.mesh), grid, refining(40)),
      doctest::Contains("refine.least_angle"), Error);
}
