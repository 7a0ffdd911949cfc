// SPDX-License-Identifier: Apache-2.0
// Whole results: the corpus, generated inputs, the limits of input types, errors, progress.
#include <filesystem>
#include <limits>

#include "agreement.hpp"
#include "corpus.hpp"
#include "device/tuning.hpp"
#include "tuned_solver.hpp"
#include "whole_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

const std::string folder = std::string(GCDT_TEST_DATA) + "/corpus";

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
  for (const std::size_t n : {few - 1, few, few + 1, most_here(), most_here() + 1}) {
    std::vector<Workload> all{uniform(n), grid(n), line_and_one(n), comb(n), parabola(n)};
    if (n <= few + 1) all.push_back(line(n));  // its constraints overlap: pieces grow with their square
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
