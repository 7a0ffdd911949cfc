// SPDX-License-Identifier: Apache-2.0
// The host's proof of a domain takes O(n log n) steps, which it counts, on inputs on which sweeping with flips, looking
// around vertices, or walking in the input's order takes more; its parts do what they say.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "proof/domain.hpp"
#include "proof/locate.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

std::uint32_t last_of(const Workload& work) { return static_cast<std::uint32_t>(work.points.size() - 1); }

/// The outline of a thin X: four arms, each side a run of n / 8 vertices.
Workload outlined_x(std::size_t n) {
  Workload work;
  const auto length = static_cast<double>(n / 8);
  for (const auto& [x, y] : {std::array{1., 1.}, {-1., 1.}, {-1., -1.}, {1., -1.}}) {
    for (double i = 1; i <= length; ++i) work.points.push_back({x * i * 4 + y, y * i * 4 - x});
    for (double i = length; i > 0; --i) work.points.push_back({x * i * 4 - y, y * i * 4 + x});
  }
  for (std::uint32_t v = 0; v < last_of(work); ++v) work.constraints.push_back({v, v + 1});
  work.constraints.push_back({last_of(work), 0});
  return work;
}

/// Two lines of points that cross, and a constraint along each.
Workload dotted_x(std::size_t n) {
  Workload work;
  const auto half = static_cast<double>(n / 4);
  for (double i = -half; i < half; ++i) work.points.push_back({10 * i, i});
  work.constraints.push_back({0, last_of(work)});
  const std::uint32_t first = last_of(work) + 1;
  for (double i = -half; i < half; ++i)
    if (i != 0) work.points.push_back({10 * i, -i});
  work.constraints.push_back({first, last_of(work)});
  return work;
}

/// Eight rows of points, each a run of edges, and from each row's begin a constraint to the next one's end.
Workload rows(std::size_t n) {
  Workload work;
  const auto length = static_cast<std::uint32_t>(n / 8);
  for (std::uint32_t row = 0; row < 8; ++row) {
    for (std::uint32_t i = 0; i < length; ++i) work.points.push_back({4. * i + row % 2, 1000. * row});
    for (std::uint32_t i = 1; i < length; ++i) work.constraints.push_back({last_of(work) - i, last_of(work) - i + 1});
    if (row > 0) work.constraints.push_back({(row - 1) * length, last_of(work)});
  }
  return work;
}

/// A row of points, and two vertices that are joined to each of them.
Workload double_fan(std::size_t n) {
  Workload work;
  const auto count = static_cast<std::uint32_t>(n);
  for (std::uint32_t i = 0; i < count; ++i) work.points.push_back({2. * i, 0});
  for (const double side : {3., -3.}) work.points.push_back({1. * count, side * count});
  for (std::uint32_t i = 0; i < count; ++i)
    for (const std::uint32_t hub : {count, count + 1}) work.constraints.push_back({hub, i});
  return work;
}

/// A fan from one vertex through the gaps of a dense row to vertices behind it.
Workload pierced_row(std::size_t n) {
  Workload work;
  work.points.push_back({0, 0});
  for (std::uint32_t i = 0; i < n / 3; ++i) {
    work.points.push_back({2. * n, 8. * i + 5});
    work.points.push_back({2. * n + 1, 8. * i + 3});
    work.points.push_back({4. * n, 16. * i});
    work.constraints.push_back({0, last_of(work)});
  }
  return work;
}

/// Two zigzag rows, and between them long constraints, nearly along the rows, that cross the edges between these.
Workload strips(std::size_t n) {
  Workload work;
  for (std::uint32_t i = 0; i < n; ++i) work.points.push_back({1000 + 7. * i, i % 2 ? 4e3 : -4e3});
  for (int i = -40; i <= 40; ++i) {
    work.points.push_back({0, 80. * i});
    work.points.push_back({2000 + 7. * n, 2. * i});
    work.constraints.push_back({last_of(work) - 1, last_of(work)});
  }
  return work;
}

struct Family {
  const char* name;
  Workload (*make)(std::size_t n);
};
constexpr Family families[] = {{"outlined x", outlined_x},
                               {"dotted x", dotted_x},
                               {"rows", rows},
                               {"strips", strips},
                               {"double fan", double_fan},
                               {"pierced row", pierced_row},
                               {"comb", comb},
                               {"fan", fan},
                               {"hub", hub},
                               {"star", star},
                               {"spiral", spiral},
                               {"parabola", parabola},
                               {"grid", grid},
                               {"nested squares", nested_squares},
                               {"line and one", line_and_one},
                               {"collinear runs", collinear_runs}};

std::uint64_t steps_of(const Workload& work, const Options& options) {
  const Triangulation mesh = solver().triangulate(work.points, work.constraints, options);
  const proof::RegionView said = {mesh.region.data(), mesh.depth.data(), mesh.winding.data()};
  std::uint64_t steps = 0;
  const Verification proved =
      proof::verify_domain(work.points, work.constraints, view(mesh), said, mesh.statistics.grid, options, &steps);
  CHECK(proved.reason == "");
  return steps;
}

double n_log_n(double n) { return n * std::log2(n); }

/// n log n, with n the vertices, constraints and seeds.
double size_of(const Workload& work, const Options& options) {
  return n_log_n(static_cast<double>(work.points.size() + work.constraints.size() + options.hole_seeds.size()));
}

std::vector<proof::Vertex> vertices_of(const Workload& work) {
  std::vector<proof::Vertex> vertices;
  for (const Point& p : work.points)
    vertices.push_back({static_cast<std::int32_t>(p[0]), static_cast<std::int32_t>(p[1])});
  return vertices;
}

/// Twice the area of a polygon, or of a triangle of places on it.
template <class Corners>
std::int64_t doubled_area(const std::vector<proof::Vertex>& polygon, const Corners& corners) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const proof::Vertex a = polygon[corners[i]], b = polygon[corners[(i + 1) % corners.size()]];
    sum += std::int64_t{a.x} * b.y - std::int64_t{b.x} * a.y;
  }
  return sum;
}

bool meet(proof::Vertex a, proof::Vertex b, proof::Vertex c, proof::Vertex d) {
  const auto sign = [](std::int64_t v) { return v < 0 ? -1 : v > 0 ? 1 : 0; };
  return sign(proof::orient(a, b, c)) * sign(proof::orient(a, b, d)) <= 0 &&
         sign(proof::orient(c, d, a)) * sign(proof::orient(c, d, b)) <= 0;
}

/// A path above the segment from (1000, 0) to (2000, 0) with lines down to it that meet neither each other nor the
/// path, from its right end to its left, folded as often as chance will; empty if it does not come about.
std::vector<proof::Vertex> folded_path(Random& random, std::size_t inner) {
  std::vector<std::int32_t> feet(inner);
  for (std::int32_t& x : feet) x = 1001 + static_cast<std::int32_t>(random.below(999));
  std::sort(feet.begin(), feet.end());
  std::vector<proof::Vertex> path = {{1000, 0}};
  const auto free = [&](proof::Vertex foot, proof::Vertex at) {
    for (std::size_t j = 1; j < path.size(); ++j) {
      const proof::Vertex other = {feet[j - 1], 0};
      const bool last = j + 1 == path.size();
      if (meet(foot, at, other, path[j]) || meet(foot, at, path[j - 1], path[j])) return false;
      if (!last && (meet(path.back(), at, other, path[j]) || meet(path.back(), at, path[j - 1], path[j]))) return false;
      if (last && (proof::orient(other, path[j], at) >= 0 || proof::orient(path[j - 1], path[j], at) == 0))
        return false;
    }
    return true;
  };
  for (std::size_t i = 0, tries = 0; i < inner && tries < 60; ++tries) {
    const proof::Vertex at = {static_cast<std::int32_t>(random.below(3000)),
                              1 + static_cast<std::int32_t>(random.below(random.below(2) ? 1000 : 60))};
    if (!free({feet[i], 0}, at)) continue;
    path.push_back(at);
    ++i, tries = 0;
  }
  const proof::Vertex end = {2000, 0};
  if (path.size() <= inner || !free(end, end)) return {};
  path.push_back(end);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace

// Four times as many vertices take eight times the steps if those grow as n^1.5: relative to n log n, 1.7 times here.
TEST_CASE("the proof of a domain takes at most 4 n log n steps, and they do not grow faster") {
  Options options;
  options.domain = Domain::even_odd;
  for (const Family& family : families) {
    const std::string name = family.name;
    CAPTURE(name);
    double before = HUGE_VAL;
    for (const std::size_t n : {1u << 10, 1u << 12, 1u << 14}) {
      CAPTURE(n);
      const Workload work = family.make(n);
      const double each = static_cast<double>(steps_of(work, options)) / size_of(work, options);
      CHECK(each <= 4);
      CHECK(each <= 1.5 * before);
      before = each;
    }
  }
}

TEST_CASE("hole seeds, as many as vertices, take no more than that") {
  for (const std::size_t n : {1u << 9, 1u << 11, 1u << 13}) {
    CAPTURE(n);
    const Workload work = outlined_x(n);
    Options options;
    options.domain = Domain::outer_holes;
    Random random(n);
    for (std::size_t i = 0; i < n; ++i) {
      Point seed = work.points[random.below(n)];
      if (random.below(2)) seed = {seed[0] + random.between(-3, 3), seed[1] + random.between(-3, 3)};
      options.hole_seeds.push_back(seed);
    }
    CHECK(static_cast<double>(steps_of(work, options)) <= 4 * size_of(work, options));
  }
}

TEST_CASE("a sweep finds the least triangle that holds a place, in, on the border of, and beside the mesh") {
  Random random(3);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Workload work = random_pslg(30, 12, 10, seed);
    const proof::Sites sites(vertices_of(work));
    std::uint64_t steps = 0;
    proof::Completion mesh(sites, steps);
    mesh.sort();
    for (std::int32_t x = 0; x < 14; ++x)
      for (std::int32_t y = 0; y < 14; ++y) {
        std::uint32_t expected = proof::none;
        for (std::uint32_t t = 0; t < mesh.triangles().size() && expected == proof::none; ++t) {
          const auto& [a, b, c] = mesh.triangles()[t];
          const proof::Vertex p = sites.at[a], q = sites.at[b], r = sites.at[c], at = {x, y};
          if (proof::orient(p, q, at) >= 0 && proof::orient(q, r, at) >= 0 && proof::orient(r, p, at) >= 0)
            expected = t;
        }
        const std::vector<std::uint32_t> found = proof::least_triangles(sites, mesh, {{x, y}, {13, 13}, {x, y}}, steps);
        CHECK(found == std::vector<std::uint32_t>{expected, proof::none, expected});
      }
  }
}

TEST_CASE("what a constraint leaves is triangulated by triangles the right way round, however its border folds") {
  Random random(11);
  std::size_t paths = 0;
  while (paths < 3000) {
    const std::vector<proof::Vertex> at = folded_path(random, 4 + random.below(6));
    if (at.empty()) continue;
    ++paths;
    const proof::Sites sites(at);
    std::vector<std::uint32_t> places(at.size());
    std::iota(places.begin(), places.end(), 0u);
    std::uint64_t steps = 0;
    proof::Cavity cavity(sites, steps);
    for (int order = 0; order < 10; ++order) {
      cavity.triangulate(places);
      std::int64_t sum = 0, wrong = 0;
      for (const auto& t : cavity.triangles()) {
        const std::int64_t area = doubled_area(at, t);
        sum += area;
        wrong += area <= 0;
      }
      CHECK(wrong == 0);
      CHECK(sum == doubled_area(at, places));
    }
  }
}
