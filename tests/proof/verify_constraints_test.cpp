// SPDX-License-Identifier: Apache-2.0
// The host's proof of the constraints and their flags, under reject and under drop.
#include <doctest/doctest.h>

#include <algorithm>

#include "mesh_cases.hpp"

using namespace gcdt;
using namespace gcdt::mesh_cases;

TEST_CASE("a constrained edge that is flipped is caught as a missing constraint") {
  must_be_caught(
      [](const Case& c, ReferenceMesh& mesh, Random& random) {
        auto edges = inner_edges(mesh, true);
        std::shuffle(edges.begin(), edges.end(), random);
        return std::any_of(edges.begin(), edges.end(),
                           [&](auto e) { return flip(c.grid_points, mesh, e.first, e.second); });
      },
      {"is not a chain of edges"}, true);
}

TEST_CASE("a missing flag, an extra flag and a flag beyond the three edges are caught") {
  auto toggle = [](bool set) {
    return [set](auto&, ReferenceMesh& mesh, Random& random) {
      auto edges = inner_edges(mesh, set);
      if (edges.empty()) return false;
      const auto [t, k] = edges[static_cast<std::size_t>(below(random, static_cast<std::int64_t>(edges.size())))];
      mesh.constrained[static_cast<std::size_t>(t)] ^= static_cast<std::uint8_t>(1 << k);
      return true;
    };
  };
  must_be_caught(toggle(true), {"is not flagged as constrained, but constraint"}, false);
  must_be_caught(toggle(false), {"is flagged as constrained, but no constraint"}, false);
  must_be_caught(
      [](auto&, auto& mesh, auto& random) { return mesh.constrained[any_triangle(mesh, random)] |= 8, true; },
      {"has flags of edges it does not have"}, false);
}

namespace {

Verification check_drop(const GridPoints& p, const Segments& constraints, const ReferenceMesh& mesh) {
  Case c("drop", p, {});
  const auto points = c.points();
  MeshView view{mesh.triangles, mesh.neighbours.data(), mesh.constrained.data()};
  return verify(points, constraints, view, choose_grid(points), Crossing::drop);
}

}  // namespace

TEST_CASE("under drop exactly the constraints that cross no earlier kept one must be there") {
  int dropped = 0, wrong = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    Random random(seed);
    const GridPoints p = seed % 3 == 0   ? random_points(random, 30, 8)
                         : seed % 3 == 1 ? grid_points(random, 6, 1)
                                         : random_points(random, 30, largest);
    const Segments constraints = random_constraints(random, p, 14);
    const auto right = kept(p, constraints);
    CHECK(check_drop(p, constraints, reference::reference_mesh(p, chosen(constraints, right))).reason == "");
    dropped += right.size() < constraints.size();

    // The same rule from behind, and every set with one kept constraint less: other meshes, all to be rejected.
    Segments backwards(constraints.rbegin(), constraints.rend());
    std::vector<Segments> others = {chosen(backwards, kept(p, backwards))};
    for (std::size_t i = 0; i < right.size(); ++i) {
      others.push_back(chosen(constraints, right));
      others.back().erase(others.back().begin() + static_cast<std::ptrdiff_t>(i));
    }
    const auto mesh = reference::reference_mesh(p, chosen(constraints, right));
    for (const Segments& other : others) {
      const auto mutant = reference::reference_mesh(p, other);
      const bool same = mutant.triangles == mesh.triangles && mutant.constrained == mesh.constrained;
      CHECK(check_drop(p, constraints, mutant).valid == same);
      wrong += !same;
    }
  }
  CHECK(dropped > 50);
  CHECK(wrong > 300);
}

TEST_CASE("crossing constraints are no valid input of a mesh under reject") {
  const GridPoints p = {{0, 0}, {4, 0}, {5, 5}, {0, 4}};
  const Segments diagonals = {{0, 2}, {1, 3}};
  Case c("square", p, {diagonals[0]});
  CHECK(check_drop(p, diagonals, c.mesh).reason == "");
  c.constraints = diagonals;
  CHECK(contains(check(c, c.mesh).reason, "constraint 1 (1-3) is not a chain of edges: it crosses edge"));
}

TEST_CASE("constraints that meet in a vertex do not cross, and pieces of a dropped one are not flagged") {
  // 0-4 and 1-3 meet in vertex 2; 5-8 passes vertex 6 and crosses 0-4 beyond it.
  const GridPoints p = {{0, 0}, {0, 4}, {2, 2}, {4, 0}, {9, 9}, {3, 12}, {4, 9}, {0, 9}, {6, 3}};
  const Segments constraints = {{0, 4}, {1, 3}, {5, 8}};
  CHECK(kept(p, constraints) == std::vector<std::uint32_t>{0, 1});
  const auto mesh = reference::reference_mesh(p, {{0, 4}, {1, 3}});
  CHECK(check_drop(p, constraints, mesh).reason == "");
  const auto pieces = reference::reference_mesh(p, {{0, 4}, {1, 3}, {5, 6}});
  CHECK(contains(check_drop(p, constraints, pieces).reason, "is flagged as constrained, but no constraint"));
  // Another source covers the piece: now it is flagged, and must be.
  const Segments covered = {{0, 4}, {1, 3}, {5, 8}, {6, 5}};
  CHECK(check_drop(p, covered, pieces).reason == "");
  CHECK_FALSE(check_drop(p, covered, mesh).valid);
}

TEST_CASE("a constraint is rightly dropped for an earlier one where a later one runs along the same edge") {
  // 0-2 passes vertex 1; 3-4 crosses it between 1 and 2, where 1-2 also runs.
  const GridPoints p = {{0, 0}, {2, 0}, {4, 0}, {3, 3}, {3, -2}};
  const Segments constraints = {{0, 2}, {3, 4}, {1, 2}};
  const auto mesh = reference::reference_mesh(p, {{0, 2}});
  CHECK(check_drop(p, constraints, mesh).reason == "");
  CHECK_FALSE(check_drop(p, {{3, 4}, {0, 2}, {1, 2}}, mesh).valid);
}
