// SPDX-License-Identifier: Apache-2.0
// Whole results: the corpus, the metamorphic statements of docs/contract.md, 5, input types, errors.
#include <doctest/doctest.h>

#include <filesystem>
#include <limits>

#include "agreement.hpp"
#include "corpus.hpp"
#include "device/tuning.hpp"
#include "result_hash.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

const std::string folder = std::string(GCDT_TEST_DATA) + "/corpus";

Triangulation triangulated(const Workload& work, Crossing crossing = Crossing::reject) {
  Options options;
  options.crossing = crossing;
  return solver().triangulate(work.points, work.constraints, options);
}

/// The error that triangulating throws; fails the test if it throws none.
Error error_of(Points points, Constraints constraints = {}, const Options& options = {}) {
  try {
    solver().triangulate(points, constraints, options);
  } catch (const Error& error) {
    return error;
  }
  FAIL_CHECK("nothing was thrown");
  return Error(Status::ok, "nothing was thrown");
}

bool same_bytes(const Triangulation& a, const Triangulation& b) {
#define GCDT_ARRAY(number, name, ...) \
  if (a.name != b.name) return false;
#include <gcdt/arrays.def>
  return true;
}

/// Coordinates of every triangle, corner by corner.
std::vector<std::array<Point, 3>> shape(const Workload& work, const Triangulation& mesh) {
  std::vector<std::array<Point, 3>> result;
  for (const auto& t : mesh.triangles) result.push_back({work.points[t[0]], work.points[t[1]], work.points[t[2]]});
  return result;
}

/// A mixture of what the corpus' ideas are made of, with integer coordinates and no crossings.
std::vector<Workload> samples() {
  std::vector<Workload> result{grid(100),
                               lattice_circle(200),
                               collinear_runs(80),
                               comb(50),
                               nested_squares(60),
                               hub(60),
                               line_and_one(30),
                               parabola(60),
                               random_pslg(40, 8, 80, 1),
                               random_pslg(60, 30, 120, 2),
                               random_pslg(60, 1000, 200, 3)};
  return result;
}

/// `work` with its vertices in another order: vertex i becomes `place[i]`.
Workload renumbered(const Workload& work, const std::vector<std::uint32_t>& place) {
  Workload result{std::vector<Point>(work.points.size()), {}};
  for (std::size_t i = 0; i < place.size(); ++i) result.points[place[i]] = work.points[i];
  for (const Segment& s : work.constraints) result.constraints.push_back({place[s[0]], place[s[1]]});
  return result;
}

template <class Map>
Workload moved(Workload work, Map map) {
  for (Point& p : work.points) p = map(p);
  return work;
}

}  // namespace

TEST_CASE("every corpus file ends with its status, and its mesh is valid and agrees with CGAL") {
  for (const CorpusEntry& entry : read_manifest(folder)) {
    CAPTURE(entry.name);
    const Workload work = read_poly(folder + "/" + entry.name);
    if (entry.status == "invalid") {
      const Status status = error_of(work.points, work.constraints).status();
      CHECK((status == Status::coordinate_not_finite || status == Status::index_out_of_range));
      continue;
    }
    Crossing crossing = Crossing::reject;
    if (entry.status == "crossing") {
      const Error error = error_of(work.points, work.constraints);
      CHECK(error.status() == Status::constraints_cross);
      CHECK(error.pair_count() == static_cast<std::uint64_t>(entry.crossings));
      crossing = Crossing::drop;
    }
    try {
      const Triangulation mesh = triangulated(work, crossing);
      CHECK(fault(work.points, work.constraints, mesh, crossing) == "");
      CHECK(static_cast<long>(mesh.triangles.size()) == entry.triangles);
      CHECK(disagreement(on_grid(work.points, mesh.statistics.grid), work.constraints, mesh, crossing) == "");
      if (entry.triangles == 0) CHECK_FALSE(mesh.statistics.notes.empty());
    } catch (const Error& error) {
      FAIL_CHECK(error.what());
    }
  }
}

TEST_CASE("the minimal failing inputs of wrong constraint rules give valid meshes that agree with CGAL") {
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder + "/minimal")) {
    const Workload work = read_minimal(file.path().string()).input;
    CAPTURE(file.path().string());
    const bool crosses = !crossings(integers(work.points), work.constraints).empty();
    if (crosses) CHECK(error_of(work.points, work.constraints).status() == Status::constraints_cross);
    const Crossing crossing = crosses ? Crossing::drop : Crossing::reject;
    const Triangulation mesh = triangulated(work, crossing);
    CHECK(fault(work.points, work.constraints, mesh, crossing) == "");
    CHECK(disagreement(work, mesh, crossing) == "");
    ++files;
  }
  CHECK(files == 36);
}

TEST_CASE("small inputs of every generator give valid meshes") {
  for (const std::string& name : workload_names()) {
    const Workload work = workload(name, name == "random_pslg" ? 60 : 900);
    CAPTURE(name);
    const Triangulation mesh = triangulated(work);
    CHECK(fault(work.points, work.constraints, mesh) == "");
    CHECK(disagreement(on_grid(work.points, mesh.statistics.grid), work.constraints, mesh) == "");
  }
}

TEST_CASE("few vertices, which one work-item orders, and one more give valid meshes that agree with CGAL") {
  const std::size_t few = Tuning().one_item_vertices;
  for (const std::size_t n : {few - 1, few, few + 1}) {
    std::vector<Workload> all{uniform(n), grid(n), line(n), line_and_one(n), comb(n), parabola(n)};
    all.push_back(uniform(n));
    for (std::size_t i = 0; i < n; i += 2) all.back().points[i] = all.back().points[i / 3];
    all.push_back(Workload{std::vector<Point>(n, Point{0.1, 7}), {}});
    for (const Workload& work : all) {
      CAPTURE(n);
      CAPTURE(&work - all.data());
      const Triangulation mesh = triangulated(work);
      CHECK(fault(work.points, work.constraints, mesh) == "");
      CHECK(disagreement(on_grid(work.points, mesh.statistics.grid), work.constraints, mesh) == "");
    }
  }
}

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
      Triangles triangles = triangulated(moved(work, map)).triangles;  // numbers are the same, so classify in place
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
    Triangles mirrored = triangulated(moved(work, [](Point p) { return Point{-p[0], p[1]}; })).triangles;
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

TEST_CASE("int64 is exact up to 2^53, and beyond that an error that names the coordinate") {
  const std::int64_t most = std::int64_t{1} << 53;
  std::vector<std::array<std::int64_t, 2>> points{
      {most, -most}, {most - 7, -most}, {most - 3, 5 - most}, {most, 9 - most}};
  std::vector<std::array<double, 2>> doubles;
  for (const auto& p : points) doubles.push_back({double(p[0]), double(p[1])});
  const Triangulation mesh = solver().triangulate(points);
  CHECK(mesh.statistics.grid.kind == Grid::Kind::binary);
  CHECK(same_bytes(mesh, solver().triangulate(doubles)));
  CHECK(fault(points, {}, mesh) == "");
  for (const std::int64_t bad : {most + 1, -most - 1, std::numeric_limits<std::int64_t>::min()}) {
    points[2][1] = bad;
    const Error error = error_of(points);
    CHECK(error.status() == Status::coordinate_outside_grid);
    CHECK(error.indices() == std::vector<std::uint64_t>{2, 1});
    MeshView none;
    CHECK(!verify(points, {}, none, mesh.statistics.grid).valid);
  }
}

TEST_CASE("the extremes of int32 are exact") {
  const std::int32_t low = std::numeric_limits<std::int32_t>::min(), high = -1;  // an extent of 2^31 - 1
  const std::vector<std::array<std::int32_t, 2>> points{
      {low, low}, {high, low}, {high, high}, {low, high}, {low + 1, low + 1}};
  const std::vector<Constraint> constraints{{0, 2}};
  const Triangulation mesh = solver().triangulate(points, constraints);
  CHECK(fault(points, constraints, mesh) == "");
  CHECK(mesh.triangles.size() == 4);
  CHECK(mesh.pieces.size() == 2);  // vertex 4 is on the constraint
}

TEST_CASE("the grid of the result is the one the host chooses") {
  for (const char* name :
       {"grid_5x5", "decimals", "huge_values", "huge_extent", "denormals", "mixed_scales", "huge_offset"}) {
    const Workload work = read_poly(folder + "/" + name + ".poly");
    CAPTURE(name);
    const Grid found = triangulated(work).statistics.grid, expected = choose_grid(work.points);
    CHECK(found.kind == expected.kind);
    CHECK(found.origin == expected.origin);
    CHECK(found.cell_units == expected.cell_units);
    CHECK(found.cell_decimals == expected.cell_decimals);
    CHECK(found.cell_exponent == expected.cell_exponent);
    CHECK(found.largest_move == expected.largest_move);
  }
  CHECK(triangulated(grid(25)).statistics.grid.kind == Grid::Kind::binary);
  CHECK(triangulated(read_poly(folder + "/decimals.poly")).statistics.grid.kind == Grid::Kind::decimal);
  CHECK(triangulated(uniform(50)).statistics.grid.kind == Grid::Kind::rounded);
  CHECK(triangulated(uniform(50)).statistics.grid.largest_move > 0);
}

TEST_CASE("a coordinate that is not finite is reported with vertex and axis") {
  for (const double bad :
       {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
    for (const std::uint64_t vertex : {0, 7, 99})
      for (const std::uint64_t axis : {0, 1}) {
        Workload work = grid(100);
        work.points[vertex][axis] = bad;
        const Error error = error_of(work.points);
        CHECK(error.status() == Status::coordinate_not_finite);
        CHECK(error.indices() == std::vector<std::uint64_t>{vertex, axis});
      }
  std::vector<std::array<float, 2>> floats{{0, 0}, {1, 0}, {0, std::numeric_limits<float>::quiet_NaN()}};
  CHECK(error_of(floats).indices() == std::vector<std::uint64_t>{2, 1});
}

TEST_CASE("an index out of range is reported with constraint and end") {
  for (const std::uint32_t bad : {9u, 10u, 0x7fffffffu, 0xffffffffu})
    for (const std::uint64_t end : {0, 1}) {
      Workload work = grid(9);
      work.constraints = {{0, 1}, {3, 4}, {4, 5}};
      work.constraints[2][end] = bad;
      const Error error = error_of(work.points, work.constraints);
      CHECK(error.status() == Status::index_out_of_range);
      CHECK(error.indices() == std::vector<std::uint64_t>{2, end});
    }
}

TEST_CASE("a vertex outside a fixed grid is reported, one between its points is moved") {
  Options options;
  options.grid = FixedGrid{0, 0, "0.5"};
  const std::vector<Point> outside{{0, 0}, {4, 0}, {4, 4}, {0, -1}};
  const Error error = error_of(outside, {}, options);
  CHECK(error.status() == Status::coordinate_outside_grid);
  CHECK(error.indices() == std::vector<std::uint64_t>{3, 1});
  const std::vector<Point> between{{0, 0}, {4.25, 0}, {4.75, 0.125}, {0, 4}};  // half to even: 4.0, 5.0; 0.125 to 0
  const Triangulation mesh = solver().triangulate(between, {}, options);
  CHECK(mesh.statistics.grid.kind == Grid::Kind::fixed);
  CHECK(mesh.statistics.grid.largest_move == 0.25);
  CHECK(on_grid(between, mesh.statistics.grid) == std::vector<GridPoint>{{0, 0}, {8, 0}, {10, 0}, {0, 8}});
  CHECK(fault(between, {}, mesh) == "");
  CHECK(mesh.triangles.size() == 2);
}

TEST_CASE("after an error the solver gives the same bytes as before") {
  const Workload good = random_pslg(50, 9, 80, 9), crossing{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 2}, {1, 3}}};
  const Triangulation before = triangulated(good);
  CHECK(error_of(crossing.points, crossing.constraints).status() == Status::constraints_cross);
  CHECK(same_bytes(before, triangulated(good)));
  const std::vector<Point> bad{{0, 0}, {std::nan(""), 0}, {1, 1}};
  CHECK(error_of(bad).status() == Status::coordinate_not_finite);
  CHECK(same_bytes(before, triangulated(good)));
}

TEST_CASE("the progress callback sees the share grow to at most one and can cancel at every call") {
  const Workload work = fan(3000);
  const Triangulation expected = triangulated(work);
  Options options;
  int calls = 0;
  double last = 0;
  options.progress = [&](const char* phase, double done) {
    CHECK(std::string(phase) != "");
    CHECK(done >= last);
    CHECK(done <= 1);
    last = done;
    return ++calls > 0;
  };
  CHECK(same_bytes(solver().triangulate(work.points, work.constraints, options), expected));
  REQUIRE(calls > 2);
  for (const int stop : {1, 2, calls / 2, calls}) {
    int now = 0;
    options.progress = [&](const char*, double) { return ++now < stop; };
    CHECK(error_of(work.points, work.constraints, options).status() == Status::cancelled);
    CHECK(now == stop);
  }
  CHECK(same_bytes(triangulated(work), expected));
}

TEST_CASE("the device's own check changes no byte") {
  Options options;
  options.check = false;
  for (const Workload& work : samples())
    CHECK(same_bytes(solver().triangulate(work.points, work.constraints, options), triangulated(work)));
}
