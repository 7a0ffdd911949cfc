// SPDX-License-Identifier: Apache-2.0
// The host's proof accepts CGAL's meshes and names what is wrong with every mutant of them.
#include "gcdt/verify.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "reference.hpp"

using namespace gcdt;
using reference::ReferenceMesh;

namespace {

using GridPoints = std::vector<std::array<std::int64_t, 2>>;
using Segments = std::vector<Constraint>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Random = std::mt19937;

std::int64_t below(Random& random, std::int64_t limit) {
  return std::uniform_int_distribution<std::int64_t>(0, limit - 1)(random);
}

std::int64_t orient(const GridPoints& p, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return (p[b][0] - p[a][0]) * (p[c][1] - p[a][1]) - (p[b][1] - p[a][1]) * (p[c][0] - p[a][0]);
}

bool on_segment(const GridPoints& p, Constraint s, std::uint32_t v) {
  const auto [a, b] = s;
  return orient(p, a, b, v) == 0 && std::min(p[a], p[b]) <= p[v] && p[v] <= std::max(p[a], p[b]);
}

/// Contract 3 by its words: the interiors meet in a point that is no vertex and not part of a common piece.
bool cross(const GridPoints& p, Constraint s, Constraint t) {
  auto sign = [](std::int64_t v) { return (v > 0) - (v < 0); };
  if (sign(orient(p, s[0], s[1], t[0])) * sign(orient(p, s[0], s[1], t[1])) >= 0) return false;
  if (sign(orient(p, t[0], t[1], s[0])) * sign(orient(p, t[0], t[1], s[1])) >= 0) return false;
  for (std::uint32_t v = 0; v < p.size(); ++v)
    if (on_segment(p, s, v) && on_segment(p, t, v)) return false;
  return true;
}

/// The numbers of the constraints that are kept under Crossing::drop.
std::vector<std::uint32_t> kept(const GridPoints& p, const Segments& constraints) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t c = 0; c < constraints.size(); ++c)
    if (std::none_of(result.begin(), result.end(),
                     [&](std::uint32_t earlier) { return cross(p, constraints[c], constraints[earlier]); }))
      result.push_back(c);
  return result;
}

Segments chosen(const Segments& constraints, const std::vector<std::uint32_t>& numbers) {
  Segments result;
  for (std::uint32_t c : numbers) result.push_back(constraints[c]);
  return result;
}

struct Case {
  std::string name;
  GridPoints grid_points;  ///< distinct
  Segments constraints;
  ReferenceMesh mesh;

  Case(std::string what, GridPoints p, Segments c) : name(std::move(what)), grid_points(std::move(p)) {
    constraints = chosen(c, kept(grid_points, c));
    mesh = reference::reference_mesh(grid_points, constraints);
  }
  std::vector<std::array<double, 2>> points() const {
    std::vector<std::array<double, 2>> result;
    for (auto [x, y] : grid_points) result.push_back({double(x), double(y)});
    return result;
  }
};

Verification check(const Case& c, const ReferenceMesh& mesh, bool neighbours = true, bool flags = true) {
  const auto points = c.points();
  MeshView view{mesh.triangles, neighbours ? mesh.neighbours.data() : nullptr,
                flags ? mesh.constrained.data() : nullptr};
  return verify(points, c.constraints, view, choose_grid(points));
}

GridPoints distinct(GridPoints points, Random& random) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::shuffle(points.begin(), points.end(), random);
  return points;
}

GridPoints random_points(Random& random, int count, std::int64_t size) {
  GridPoints points;
  for (int i = 0; i < count; ++i) points.push_back({below(random, size), below(random, size)});
  return distinct(points, random);
}

GridPoints grid_points(Random& random, int side, std::int64_t step) {
  GridPoints points;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) points.push_back({i * step, j * step});
  return distinct(points, random);
}

/// All points of x^2 + y^2 = 1105^2 (36 of them), scaled, and some inside.
GridPoints circle_points(Random& random, std::int64_t scale, int inside) {
  GridPoints points;
  for (std::int64_t x = -1105; x <= 1105; ++x)
    for (std::int64_t y = -1105; y <= 1105; ++y)
      if (x * x + y * y == 1105 * 1105) points.push_back({(x + 1105) * scale, (y + 1105) * scale});
  for (int i = 0; i < inside; ++i)
    points.push_back({(800 + below(random, 600)) * scale, (800 + below(random, 600)) * scale});
  return distinct(points, random);
}

/// A square with many points on its sides.
GridPoints square_points(Random& random, std::int64_t size) {
  GridPoints points = random_points(random, 20, size);
  for (std::int64_t i : {std::int64_t(0), size})
    for (int j = 0; j < 15; ++j) {
      points.push_back({i, below(random, size + 1)});
      points.push_back({below(random, size + 1), i});
    }
  for (std::int64_t x : {std::int64_t(0), size})
    for (std::int64_t y : {std::int64_t(0), size}) points.push_back({x, y});
  return distinct(points, random);
}

/// Random pairs, some repeated, reversed or of no length.
Segments random_constraints(Random& random, const GridPoints& points, int count) {
  Segments constraints;
  const auto n = static_cast<std::int64_t>(points.size());
  for (int i = 0; i < count; ++i) {
    const auto a = static_cast<std::uint32_t>(below(random, n)), b = static_cast<std::uint32_t>(below(random, n));
    constraints.push_back({a, b});
    if (below(random, 6) == 0) constraints.push_back({b, a});
  }
  return constraints;
}

constexpr std::int64_t largest = 0x7fffffff;

std::vector<Case> cases(unsigned seed) {
  Random random(seed);
  std::vector<Case> result;
  auto add = [&](const char* name, const GridPoints& points, int count) {
    result.emplace_back(name, points, random_constraints(random, points, count));
  };
  for (int count : {0, 8, 40}) {
    add("random", random_points(random, 60, 1000), count);
    add("few places", random_points(random, 60, 9), count);
    add("31 bits", random_points(random, 60, largest + 1), count);
    add("grid", grid_points(random, 7, 1), count);
    add("wide grid", grid_points(random, 6, largest / 5), count);
    add("circle", circle_points(random, 1, 6), count);
    add("wide circle", circle_points(random, 900000, 0), count);
    add("square", square_points(random, 40), count);
    add("wide square", square_points(random, largest), count);
  }
  return result;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Edges as (triangle, corner) with a neighbour, constrained or not.
std::vector<std::pair<int, int>> inner_edges(const ReferenceMesh& mesh, bool constrained) {
  std::vector<std::pair<int, int>> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbours[t][k] >= 0 && (mesh.constrained[t] >> k & 1) == constrained) edges.push_back({int(t), k});
  return edges;
}

/// Flips the edge if the quadrilateral is strictly convex. Neighbours and flags follow: the new edge is unflagged.
bool flip(const GridPoints& p, ReferenceMesh& mesh, int t, int k) {
  const int u = mesh.neighbours[t][k];
  int j = 0;
  while (mesh.neighbours[u][j] != t) ++j;
  const auto a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3], c = mesh.triangles[t][(k + 2) % 3];
  const auto d = mesh.triangles[u][j];
  if (orient(p, a, b, d) <= 0 || orient(p, a, d, c) <= 0) return false;
  std::set<Constraint> flagged;
  for (int s : {t, u})
    for (int i = 0; i < 3; ++i)
      if (mesh.constrained[s] >> i & 1)
        flagged.insert({mesh.triangles[s][(i + 1) % 3], mesh.triangles[s][(i + 2) % 3]});
  mesh.triangles[t] = {a, b, d};
  mesh.triangles[u] = {a, d, c};
  for (int s : {t, u}) {
    mesh.constrained[s] = 0;
    for (int i = 0; i < 3; ++i)
      if (flagged.count({mesh.triangles[s][(i + 1) % 3], mesh.triangles[s][(i + 2) % 3]}))
        mesh.constrained[s] |= static_cast<std::uint8_t>(1 << i);
  }
  mesh.neighbours = reference::link(mesh.triangles);
  return true;
}

/// Changes a mesh by chance; false if it has no place for the change.
using Mutation = std::function<bool(const Case&, ReferenceMesh&, Random&)>;

/// Applies the mutation to every case and requires a failure that names `part`, with the mesh's own neighbours and
/// flags and also from the triangles alone where these change.
void must_be_caught(const Mutation& mutate, const std::vector<std::string>& parts, bool triangles_change,
                    int least = 5) {
  int applied = 0;
  Random random(7);
  for (const Case& c : cases(11)) {
    CAPTURE(c.name);
    ReferenceMesh mutant = c.mesh;
    if (!mutate(c, mutant, random)) continue;
    ++applied;
    const auto full = check(c, mutant);
    CHECK_FALSE(full.valid);
    CHECK_FALSE(full.reason.empty());
    const auto bare = triangles_change ? check(c, mutant, false, false) : full;
    CHECK_FALSE(bare.valid);
    const bool named = std::any_of(parts.begin(), parts.end(), [&](auto& part) { return contains(bare.reason, part); });
    CHECK_MESSAGE(named, bare.reason);
  }
  CHECK(applied >= least);
}

std::size_t any_triangle(const ReferenceMesh& mesh, Random& random) {
  return static_cast<std::size_t>(below(random, static_cast<std::int64_t>(mesh.triangles.size())));
}

void erase_triangle(ReferenceMesh& mesh, std::size_t t) {
  mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  mesh.constrained.erase(mesh.constrained.begin() + static_cast<std::ptrdiff_t>(t));
  mesh.neighbours = reference::link(mesh.triangles);
}

const std::vector<std::string> topology_reasons = {"boundary", "corner of no triangle", "triangles, but"};

}  // namespace

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
