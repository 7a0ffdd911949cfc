// SPDX-License-Identifier: Apache-2.0
// What changes of an input and of its form change nothing of the result, or just what docs/contract.md, 5, says.
#include "agreement.hpp"
#include "whole_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Coordinates of every triangle, corner by corner.
std::vector<std::array<Point, 3>> shape(const Workload& work, const Triangulation& mesh) {
  std::vector<std::array<Point, 3>> result;
  for (const auto& t : mesh.triangles) result.push_back({work.points[t[0]], work.points[t[1]], work.points[t[2]]});
  return result;
}

/// `work` with its vertices in another order: vertex i becomes `place[i]`.
Workload renumbered(const Workload& work, const std::vector<std::uint32_t>& place) {
  Workload result{std::vector<Point>(work.points.size()), {}};
  for (std::size_t i = 0; i < place.size(); ++i) result.points[place[i]] = work.points[i];
  for (const Segment& s : work.constraints) result.constraints.push_back({place[s[0]], place[s[1]]});
  return result;
}

}  // namespace

TEST_CASE("permuting constraints and reversing their ends gives the same mesh") {
  for (Workload work : samples()) {
    const Triangulation before = triangulated(work);
    Random random(1);
    shuffle(work.constraints, random);
    for (Segment& s : work.constraints)
      if (random.below(2)) std::swap(s[0], s[1]);
    const Triangulation after = triangulated(work);
    CHECK(before.triangles == after.triangles);
    CHECK(before.neighbours == after.neighbours);
    CHECK(before.constrained == after.constrained);
    CHECK(before.pieces == after.pieces);
  }
}

TEST_CASE("permuting vertices gives the same coordinates, triangle by triangle and corner by corner") {
  for (const Workload& work : samples()) {
    std::vector<std::uint32_t> place(work.points.size());
    for (std::uint32_t i = 0; i < place.size(); ++i) place[i] = i;
    Random random(2);
    shuffle(place, random);
    const Workload permuted = renumbered(work, place);
    const Triangulation before = triangulated(work), after = triangulated(permuted);
    CHECK(shape(work, before) == shape(permuted, after));
    CHECK(before.neighbours == after.neighbours);
    CHECK(before.constrained == after.constrained);
    CHECK(before.source_offsets == after.source_offsets);
    CHECK(before.sources == after.sources);
  }
}

TEST_CASE("moving by whole cells of the grid gives the same mesh") {
  for (const Workload& work : samples()) {
    const auto ordered = [](const Workload& w) {
      auto triangles = triangulated(w).triangles;  // each starts with its least number: order apart, the same mesh
      for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      std::sort(triangles.begin(), triangles.end());
      return triangles;
    };
    const auto expected = ordered(work);
    for (const Point offset : {Point{1, 0}, Point{-12345, 678}, Point{-0x1p30, 0x1p30}})
      CHECK(ordered(moved(work, [&](Point p) { return Point{p[0] + offset[0], p[1] + offset[1]}; })) == expected);
  }
}

TEST_CASE("a quarter turn and a mirror give the same mesh but for unconstrained edges of cocircular vertices") {
  for (const Workload& work : samples()) {
    const auto points = integers(work.points);
    const auto constrained = pieces(points, work.constraints);
    const Edges expected = classify(points, triangulated(work).triangles, constrained);
    CHECK(triangulated(work).triangles.size() == triangle_count(points));
    const auto edges_after = [&](auto map) {
      const auto triangles = triangulated(moved(work, map)).triangles;  // numbers are the same, so classify in place
      return classify(points, triangles, constrained);
    };
    for (const Edges& edges : {edges_after([](Point p) {
                                 return Point{-p[1], p[0]};
                               }),
                               edges_after([](Point p) {
                                 return Point{-p[0], -p[1]};
                               })}) {
      CHECK(edges.decided == expected.decided);
      CHECK(edges.tied.size() == expected.tied.size());
    }
    // A mirror turns every triangle round; swapping two corners turns it back.
    auto mirrored = triangulated(moved(work, [](Point p) { return Point{-p[0], p[1]}; })).triangles;
    for (auto& t : mirrored) std::swap(t[1], t[2]);
    CHECK(classify(points, mirrored, constrained).decided == expected.decided);
  }
}

TEST_CASE("the input is not changed") {
  const Workload work = random_crossing(50, 10, 100, 4), copy = work;
  triangulated(work, Crossing::drop);
  CHECK(work.points == copy.points);
  CHECK(work.constraints == copy.constraints);
}

TEST_CASE("duplicates are merged into the least number and can be used by constraints") {
  Workload work = random_pslg(30, 12, 40, 5);
  const std::uint32_t n = static_cast<std::uint32_t>(work.points.size());
  const Triangulation before = triangulated(work);
  for (std::uint32_t i = 0; i < n; ++i) work.points.push_back(work.points[n - 1 - i]);
  for (Segment& s : work.constraints) s = {2 * n - 1 - s[0], s[1]};
  const Triangulation after = triangulated(work);
  CHECK(before.triangles == after.triangles);
  CHECK(before.pieces == after.pieces);
  CHECK(disagreement(work, after) == "");
}

TEST_CASE("-0 counts as 0") {
  const Workload zero = moved(random_pslg(40, 7, 60, 6), [](Point p) { return Point{p[0] - 3, p[1] - 3}; });
  const Workload minus = moved(zero, [](Point p) { return Point{p[0] == 0 ? -0.0 : p[0], p[1] == 0 ? -0.0 : p[1]}; });
  CHECK(std::any_of(minus.points.begin(), minus.points.end(), [](Point p) { return p[0] == 0 && std::signbit(p[0]); }));
  CHECK(same_bytes(triangulated(zero), triangulated(minus)));
}

TEST_CASE("float, int32 and int64 vertices give the same bytes as the same numbers as doubles") {
  for (const Workload& work : {random_pslg(50, 20, 80, 7), moved(grid(49), [](Point p) {
                                 return Point{p[0] - 3, p[1] - 3};
                               })}) {
    std::vector<std::array<float, 2>> floats;
    std::vector<std::array<std::int32_t, 2>> ints;
    for (const Point& p : work.points) {
      floats.push_back({static_cast<float>(p[0]), static_cast<float>(p[1])});
      ints.push_back({static_cast<std::int32_t>(p[0]), static_cast<std::int32_t>(p[1])});
    }
    const Triangulation expected = triangulated(work);
    CHECK(same_bytes(solver().triangulate(floats, work.constraints), expected));
    CHECK(same_bytes(solver().triangulate(ints, work.constraints), expected));
    std::vector<std::array<std::int64_t, 2>> longs;
    for (const auto& p : ints) longs.push_back({p[0], p[1]});
    CHECK(same_bytes(solver().triangulate(longs, work.constraints), expected));
  }
  std::vector<std::array<float, 2>> fine;  // 24-bit fractions: exact as floats, and no integers
  Workload work;
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    fine.push_back(
        {static_cast<float>(random.below(1 << 24)) * 0x1p-24f, static_cast<float>(random.below(1 << 24)) * 0x1p-24f});
    work.points.push_back({fine.back()[0], fine.back()[1]});
  }
  CHECK(same_bytes(solver().triangulate(fine), triangulated(work)));
}

TEST_CASE("the device's own check changes no byte") {
  Options options;
  options.check = false;
  for (const Workload& work : samples())
    CHECK(same_bytes(solver().triangulate(work.points, work.constraints, options), triangulated(work)));
}
