// SPDX-License-Identifier: Apache-2.0
// The host's proof accepts CGAL's meshes and names what is wrong with every mutant of them.
#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "mesh_cases.hpp"

using namespace gcdt;
using namespace gcdt::mesh_cases;

TEST_CASE("verify accepts the reference's meshes, with or without neighbours and flags") {
  for (unsigned seed = 0; seed < 40; ++seed)
    for (const Case& c : cases(seed)) {
      CAPTURE(c.name);
      for (int given = 0; given < 4; ++given) {
        const auto result = check(c, c.mesh, given & 1, given & 2);
        CHECK_MESSAGE(result.valid, result.reason);
        CHECK(result.reason.empty());
      }
    }
}

TEST_CASE("verify accepts triangles in any order and rotation") {
  Random random(3);
  for (const Case& c : cases(1)) {
    ReferenceMesh mesh = c.mesh;
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    for (auto& t : mesh.triangles) std::rotate(t.begin(), t.begin() + below(random, 3), t.end());
    mesh.neighbours = reference::link(mesh.triangles);
    CHECK(check(c, mesh, true, false).reason == "");
  }
}

TEST_CASE("verify accepts duplicates, and catches a corner that is not the representative") {
  Random random(5);
  for (const Case& original : cases(2)) {
    // Copies of vertices in front of and behind the originals: the copy or the original becomes the representative.
    Case c = original;
    std::vector<std::uint32_t> now(original.grid_points.size());
    c.grid_points.clear();
    for (std::size_t i = 0; i < now.size(); ++i) {
      now[i] = static_cast<std::uint32_t>(c.grid_points.size());
      for (std::int64_t copies = below(random, 3); copies >= 0; --copies)
        c.grid_points.push_back(original.grid_points[i]);
    }
    auto any_copy = [&](std::uint32_t v) {
      const auto end = v + 1 < now.size() ? now[v + 1] : static_cast<std::uint32_t>(c.grid_points.size());
      return now[v] + static_cast<std::uint32_t>(below(random, end - now[v]));
    };
    for (auto& t : c.mesh.triangles)
      for (auto& v : t) v = now[v];
    for (auto& constraint : c.constraints)
      for (auto& v : constraint) v = any_copy(v);
    CHECK(check(c, c.mesh).reason == "");
    ReferenceMesh mutant = c.mesh;
    bool changed = false;
    for (auto& t : mutant.triangles)
      for (auto& v : t)
        if (!changed && v + 1 < c.grid_points.size() && c.grid_points[v + 1] == c.grid_points[v]) {
          ++v;
          changed = true;
        }
    REQUIRE(changed);
    CHECK(contains(check(c, mutant).reason, "is a duplicate of vertex"));
  }
}

TEST_CASE("a dropped triangle is caught") {
  must_be_caught([](auto&, auto& mesh, auto& random) { return erase_triangle(mesh, any_triangle(mesh, random)), true; },
                 topology_reasons, true);
}

TEST_CASE("a doubled triangle is caught") {
  must_be_caught(
      [](auto&, ReferenceMesh& mesh, auto& random) {
        const auto t = any_triangle(mesh, random);
        mesh.triangles.push_back(mesh.triangles[t]);
        mesh.constrained.push_back(mesh.constrained[t]);
        mesh.neighbours.push_back(mesh.neighbours[t]);
        return true;
      },
      {"is in two triangles"}, true);
}

TEST_CASE("a triangle replaced by a copy of another, the count kept, is caught") {
  must_be_caught(
      [](auto&, ReferenceMesh& mesh, auto& random) {
        const auto s = any_triangle(mesh, random), t = any_triangle(mesh, random);
        mesh.triangles[s] = mesh.triangles[t];
        return s != t;
      },
      {"is in two triangles", "corner of no triangle"}, true);
}

TEST_CASE("two swapped corners are caught") {
  must_be_caught(
      [](auto&, ReferenceMesh& mesh, auto& random) {
        auto& t = mesh.triangles[any_triangle(mesh, random)];
        std::swap(t[0], t[1]);
        return true;
      },
      {"is not counter-clockwise"}, true);
}

TEST_CASE("an unconstrained edge that is flipped is caught") {
  must_be_caught(
      [](const Case& c, ReferenceMesh& mesh, Random& random) {
        auto edges = inner_edges(mesh, false);
        std::shuffle(edges.begin(), edges.end(), random);
        return std::any_of(edges.begin(), edges.end(),
                           [&](auto e) { return flip(c.grid_points, mesh, e.first, e.second); });
      },
      {"is not locally Delaunay", "wrong diagonal"}, true);
}

TEST_CASE("every flippable edge matters: no single flip of an unconstrained edge is accepted") {
  for (const Case& c : cases(4))
    for (auto [t, k] : inner_edges(c.mesh, false)) {
      ReferenceMesh mutant = c.mesh;
      if (flip(c.grid_points, mutant, t, k)) CHECK_FALSE(check(c, mutant).valid);
    }
}

TEST_CASE("a tie among cocircular vertices decided the other way is caught as a tie") {
  std::map<std::string, int> ties;
  for (const Case& c : cases(6))
    for (auto [t, k] : inner_edges(c.mesh, false)) {
      ReferenceMesh mutant = c.mesh;
      if (flip(c.grid_points, mutant, t, k))
        ties[c.name] += contains(check(c, mutant).reason, "wrong diagonal of four cocircular");
    }
  for (const char* name : {"grid", "wide grid", "circle", "wide circle"}) CHECK_MESSAGE(ties[name] > 0, name);
}

TEST_CASE("a wrong neighbour, a missing one and one outside the hull are caught") {
  auto set = [](auto choose) {
    return [choose](auto&, ReferenceMesh& mesh, Random& random) {
      const auto t = any_triangle(mesh, random);
      auto& neighbour = mesh.neighbours[t][static_cast<std::size_t>(below(random, 3))];
      const std::int32_t before = neighbour;
      neighbour = choose(before, mesh, random);
      return neighbour != before;
    };
  };
  const std::vector<std::string> parts = {"the neighbour across edge"};
  must_be_caught(set([](int, auto& mesh, auto& random) { return int(any_triangle(mesh, random)); }), parts, false);
  must_be_caught(set([](int, auto&, auto&) { return -1; }), parts, false);
  must_be_caught(set([](int, auto&, auto&) { return -2; }), parts, false);
  must_be_caught(set([](int, auto& mesh, auto&) { return int(mesh.triangles.size()); }), parts, false);
  must_be_caught(
      [](auto&, ReferenceMesh& mesh, auto&) {
        for (auto& t : mesh.neighbours)
          for (auto& neighbour : t)
            if (neighbour == -1) return neighbour = 0, true;
        return false;
      },
      parts, false);
}

TEST_CASE("a vertex number that does not exist is caught, in triangles and in constraints") {
  for (std::uint32_t beyond : {0u, 1u, 0x7fffffffu, 0xffffffffu})
    must_be_caught(
        [beyond](const Case& c, ReferenceMesh& mesh, Random& random) {
          const auto n = static_cast<std::uint32_t>(c.grid_points.size());
          mesh.triangles[any_triangle(mesh, random)][1] = std::max(n, beyond == 1u ? n + 1 : beyond);
          return true;
        },
        {"does not exist"}, true);
  Case c = cases(8)[1];
  c.constraints.push_back({0, static_cast<std::uint32_t>(c.grid_points.size())});
  CHECK(contains(check(c, c.mesh).reason, "does not exist"));
}

TEST_CASE("a vertex left out of the triangulation is caught") {
  Random random(9);
  for (const Case& c : cases(9)) {
    const auto n = c.grid_points.size();
    const auto out = static_cast<std::uint32_t>(below(random, static_cast<std::int64_t>(n)));
    GridPoints fewer = c.grid_points;
    fewer.erase(fewer.begin() + out);
    Case mutant(c.name, c.grid_points, {});
    mutant.mesh = reference::reference_mesh(fewer, {});
    for (auto& t : mutant.mesh.triangles)
      for (auto& v : t) v += v >= out;
    CHECK(contains(check(mutant, mutant.mesh).reason, "vertex " + std::to_string(out) + " is a corner of no triangle"));
  }
}

TEST_CASE("a notch in the hull is caught, also where no vertex is lost") {
  must_be_caught(
      [](auto&, ReferenceMesh& mesh, auto&) {
        std::map<std::uint32_t, int> uses;
        for (auto& t : mesh.triangles)
          for (auto v : t) ++uses[v];
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
          for (int k = 0; k < 3; ++k) {
            const auto& corners = mesh.triangles[t];
            if (mesh.neighbours[t][k] != -1 || uses[corners[0]] < 2 || uses[corners[1]] < 2 || uses[corners[2]] < 2)
              continue;
            erase_triangle(mesh, t);
            return true;
          }
        return false;
      },
      {"boundary"}, true);
}

TEST_CASE("a mesh that winds around twice is caught") {
  // A fan around vertex 0 whose rim is a pentagram: all triangles counter-clockwise, all turns to the left.
  const GridPoints p = {{100, 100}, {200, 100}, {131, 195}, {19, 159}, {19, 41}, {131, 5}};
  Case c("pentagram", p, {});
  ReferenceMesh mesh;
  const std::uint32_t star[5] = {1, 3, 5, 2, 4};
  for (int i = 0; i < 5; ++i) mesh.triangles.push_back({0, star[i], star[(i + 1) % 5]});
  mesh.constrained.assign(5, 0);
  mesh.neighbours = reference::link(mesh.triangles);
  CHECK(contains(check(c, mesh).reason, "turns around 2 times"));
}

TEST_CASE("two islands, and two triangles that touch in one vertex, are caught") {
  ReferenceMesh mesh;
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const Case islands("islands", {{0, 0}, {1, 0}, {0, 1}, {9, 9}, {8, 9}, {9, 8}}, {});
  CHECK(contains(check(islands, mesh, false, false).reason, "not one closed polygon"));
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  const Case bow("bow", {{5, 5}, {9, 4}, {9, 6}, {1, 6}, {1, 4}}, {});
  CHECK(contains(check(bow, mesh, false, false).reason, "the boundary passes vertex 0 twice"));
}

TEST_CASE("of meshes with random corners overwritten only those that stayed the same are accepted") {
  Random random(13);
  auto canonical = [](Triangles triangles) {
    for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
  };
  int same = 0;
  for (unsigned seed = 20; seed < 30; ++seed)
    for (const Case& c : cases(seed))
      for (int i = 0; i < 20; ++i) {
        ReferenceMesh mutant = c.mesh;
        const auto n = static_cast<std::int64_t>(c.grid_points.size());
        for (std::int64_t changes = 1 + below(random, 3); changes > 0; --changes)
          mutant.triangles[any_triangle(mutant, random)][static_cast<std::size_t>(below(random, 3))] =
              static_cast<std::uint32_t>(below(random, n));
        mutant.neighbours = reference::link(mutant.triangles);
        const bool equal = canonical(mutant.triangles) == canonical(c.mesh.triangles);
        CHECK(check(c, mutant, false, false).valid == equal);
        CHECK(check(c, mutant, true, false).valid == equal);
        same += equal;
      }
  CHECK(same < 1000);
}

TEST_CASE("vertices on one line have no triangles, and triangles there are caught") {
  for (const GridPoints& p : {GridPoints{}, GridPoints{{3, 4}}, GridPoints{{3, 4}, {5, 5}},
                              GridPoints{{0, 0}, {2, 4}, {1, 2}, {largest / 2, largest - 1}}}) {
    Case c("line", p, {});
    CHECK(c.mesh.triangles.empty());
    if (p.size() > 1) c.constraints = {{0, 1}, {1, 1}};
    CHECK(check(c, c.mesh).reason == "");
    ReferenceMesh mesh;
    mesh.triangles = {{0, 1, 2}};
    CHECK_FALSE(check(c, mesh, false, false).valid);
  }
  Case empty("no triangles", {{0, 0}, {1, 0}, {0, 1}}, {});
  CHECK(contains(check(empty, {}, false, false).reason, "vertex 0 is a corner of no triangle"));
}

TEST_CASE("verify reports bad grids and coordinates as failures, never as exceptions") {
  const Case c = cases(1)[0];
  const auto points = c.points();
  const MeshView view{c.mesh.triangles, nullptr, nullptr};
  auto reason = [&](auto change) {
    Grid grid = choose_grid(points);
    change(grid);
    return verify(points, c.constraints, view, grid).reason;
  };
  CHECK(reason([](Grid&) {}) == "");
  CHECK(contains(reason([](Grid& g) { g.origin[0] = 1e300; }), "outside the grid"));
  CHECK(contains(reason([](Grid& g) { g.origin[1] = HUGE_VAL; }), "not finite"));
  CHECK(contains(reason([](Grid& g) { g.cell_exponent -= 1; }), "outside the grid"));
  CHECK(contains(reason([](Grid& g) { g.cell_exponent = 3; }), "not on the binary grid"));
  CHECK_FALSE(reason([](Grid& g) { g.cell_exponent = 1 << 30; }).empty());
  CHECK_FALSE(reason([](Grid& g) { g.cell_exponent = -(1 << 30); }).empty());
  CHECK_FALSE(reason([](Grid& g) { g.cell_units = 7; }).empty());
  CHECK_FALSE(reason([](Grid& g) { g.cell_units = 1, g.cell_decimals = 23, g.kind = Grid::Kind::decimal; }).empty());
  auto bad = points;
  bad[5][1] = std::nan("");
  CHECK(contains(verify(bad, c.constraints, view, choose_grid(points)).reason, "y of vertex 5 is not finite"));
}
