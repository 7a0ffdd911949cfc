// SPDX-License-Identifier: Apache-2.0
// What rounding to the grid does to vertices is said exactly: which it makes one, how far it moves one, whether it puts
// all on one line.
#include <doctest/doctest.h>

#include <cmath>
#include <gcdt/gcdt_pool.hpp>
#include <limits>

#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Doubles = std::vector<std::array<double, 2>>;

struct Together {
  std::uint64_t count = 0;
  std::array<std::uint32_t, 2> first{0, 0};
  bool operator==(const Together& o) const { return count == o.count && first == o.first; }
};

/// By definition, on the host: those that differ, as numbers, from the vertex that stands for them.
template <class Number>
Together together_by_definition(const std::vector<std::array<Number, 2>>& points, Span<std::uint32_t> representative) {
  Together found;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    if (points[representative[v]] == points[v]) continue;
    if (found.count++ == 0) found.first = {representative[v], v};
  }
  return found;
}

Together said(const Triangulation& mesh) {
  return {mesh.statistics.vertices_rounded_together, mesh.statistics.rounded_pair};
}

/// Vertices of which about half have a copy, and half of these a copy that is a little elsewhere.
Doubles crowded(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  Doubles points = {{-180, -90}, {180.0000001234567, 90}};
  while (points.size() < n) {
    points.push_back({random.between(-180, 180), random.between(-90, 90)});
    if (random.below(2)) continue;
    std::array<double, 2> copy = points[random.below(points.size())];
    if (random.below(2)) copy[random.below(2)] += random.between(-1e-8, 1e-8);
    points.push_back(copy);
  }
  shuffle(points, random);
  return points;
}

Options on_grid(const char* cell) {
  Options options;
  options.grid = FixedGrid{-200, -100, cell};
  return options;
}

template <class Call>
Error thrown_by(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  return Error(Status::ok, "");
}

bool has_note(const Triangulation& mesh, const std::string& part) {
  for (const std::string& note : mesh.statistics.notes)
    if (note.find(part) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("vertices that rounding makes one are counted, and the first two named, whatever their number and type") {
  for (const std::size_t n : {10u, 300u, 5000u}) {
    CAPTURE(n);
    const Doubles points = crowded(n, n);
    for (const Options& options : {Options(), on_grid("0.01"), on_grid("7")}) {
      const Triangulation mesh = solver().triangulate(points, {}, options);
      const Together expected = together_by_definition(points, mesh.representative);
      CHECK(said(mesh) == expected);
      CHECK((expected.count > 0 || n < 300));
      CHECK(mesh.statistics.vertices_merged >= expected.count);
      CHECK(assess(points, view(mesh), mesh.statistics.grid).vertices_lost == expected.count);
    }
    std::vector<std::array<float, 2>> floats;
    std::vector<std::array<std::int64_t, 2>> integers;
    for (const auto& [x, y] : points) {
      floats.push_back({static_cast<float>(x), static_cast<float>(y)});
      integers.push_back({std::llround(x * 1e13), std::llround(y * 1e13)});
    }
    const Triangulation narrow = solver().triangulate(floats, {}, on_grid("0.01"));
    CHECK(said(narrow) == together_by_definition(floats, narrow.representative));
    const Triangulation whole = solver().triangulate(integers, {});
    CHECK(whole.statistics.grid.kind == Grid::Kind::rounded);
    CHECK(said(whole) == together_by_definition(integers, whole.representative));
  }
}

TEST_CASE("equal vertices are not rounded together, nor are 0 and -0") {
  const Doubles points = {{0, 0}, {-0.0, 0}, {0.1, 1e-9}, {0.1, 1e-9}, {1, 0}, {1, 1.0 / 3}, {0, -0.0}};
  const Triangulation mesh = solver().triangulate(points, {});
  CHECK(mesh.statistics.grid.kind == Grid::Kind::rounded);
  CHECK(mesh.statistics.vertices_merged == 3);
  CHECK(said(mesh) == Together());
  Options options;
  options.distinct = true;
  CHECK(solver().triangulate(points, {}, options).triangles == mesh.triangles);
}

TEST_CASE("with `distinct`, vertices that rounding makes one are an error that names the first two") {
  for (const std::size_t n : {300u, 5000u}) {
    const Doubles points = crowded(n, n + 1);
    const Triangulation mesh = solver().triangulate(points, {});
    Options options;
    options.distinct = true;
    const Error error = thrown_by([&] { solver().triangulate(points, {}, options); });
    CHECK(error.status() == Status::vertices_coincide);
    const Together first = said(mesh);
    CHECK(error.indices() == std::vector<std::uint64_t>{first.first[0], first.first[1]});
  }
}

TEST_CASE("a batch says of each problem what it would have said alone, and fails those alone that are to be distinct") {
  Batch batch;
  std::vector<Doubles> problems;
  for (std::uint64_t p = 0; p < 30; ++p)
    problems.push_back(p % 2 ? uniform(3 + 7 * p, p).points : crowded(3 + 7 * p, p));
  problems.push_back({});
  for (const Doubles& points : problems) batch.add(points, {});
  Pool pool(test_device());
  const BatchResult made = pool.triangulate(batch);
  Options options;
  options.distinct = true;
  const BatchResult strict = pool.triangulate(batch, options);
  std::size_t with = 0, without = 0;
  for (std::size_t p = 0; p < problems.size(); ++p) {
    CAPTURE(p);
    const auto [count, first] = made.rounded_together(p);
    const Together expected = together_by_definition(problems[p], made.representative(p));
    CHECK(Together{count, first} == expected);
    ++(expected.count > 0 ? with : without);
    const auto error = strict.error(p);
    CHECK(error.has_value() == (expected.count > 0));
    if (!error) continue;
    CHECK(error->status() == Status::vertices_coincide);
    CHECK(error->indices() == std::vector<std::uint64_t>{first[0], first[1]});
  }
  CHECK(with > 5);
  CHECK(without > 5);
}

TEST_CASE("where all is on one line, a note says whether rounding put it there") {
  const double third = 1.0 / 3;
  const Doubles thin = {{0, 0}, {1e6, 0.2}, {5e5, 0.3}, {2e5, third}};
  CHECK(has_note(solver().triangulate(thin, {}, on_grid("1")), "on one line after rounding to the grid"));
  const Doubles straight = {{0, 0}, {third, 0}, {1e6 * third, 0}, {third * 5, 0}};
  CHECK(has_note(solver().triangulate(straight, {}), "all vertices lie on one line: no triangles"));
  const Doubles tiny = {{0.1, 0}, {0.2, 0.1}, {0.15, 0.3}};
  CHECK(has_note(solver().triangulate(tiny, {}, on_grid("1")), "left by rounding to the grid"));
  const Doubles two = {{0.1, 0}, {0.2, 0.1}, {0.2, 0.1}};
  CHECK(has_note(solver().triangulate(two, {}, on_grid("1")), "fewer than three distinct vertices: no triangles"));
}

TEST_CASE("the largest move is the nearest double, denormal or not; on a decimal cell at most 2^-51 of it more") {
  const double denormal = std::numeric_limits<double>::denorm_min();
  const std::vector<Doubles> inputs = {
      {{0, 0}, {1.0 / 64, 1.469368e-39}, {1.469367e-39, 1.0 / 128}, {1.0 / 64, 1.469368e-39}},
      {{0, 0}, {1, 5 * denormal}, {3 * denormal, 1}},
      {{0, 0}, {1e300, 1e-300}, {1.1e-300, 1e300}},
      {{0.1, 0.2}, {1, 1e-30}, {1e-20, 1}},
      {{0, 0}, {0x1p-1000, 7 * denormal}, {0x1p-1001, 0x1p-1000}},
      {{1e-40, -1e-41}, {-3, 4}, {5, 6e-42}}};
  for (const Doubles& input : inputs)
    for (const std::size_t copies : {1u, 2000u}) {  // one work-item orders few vertices, kernels many
      Doubles points;
      for (std::size_t i = 0; i < copies; ++i) points.insert(points.end(), input.begin(), input.end());
      CAPTURE(input[1][1]);
      CAPTURE(copies);
      CHECK(solver().triangulate(points, {}).statistics.grid.largest_move == choose_grid(points).largest_move);
      Batch batch;
      batch.add(points, {});
      batch.add(input, {});
      CHECK(Pool(test_device()).triangulate(batch).grid(1).largest_move == choose_grid(points).largest_move);
    }
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    Doubles points;
    for (int v = 0; v < 5; ++v) points.push_back({random.unit() * std::exp2(-i), random.unit()});
    const Options options = on_grid(i % 2 ? "0.003" : "0.0000123");
    const double exact = choose_grid(points, options.grid).largest_move;
    const double found = solver().triangulate(points, {}, options).statistics.grid.largest_move;
    CHECK(found >= exact);
    CHECK(found - exact <= exact * 0x1p-51);
  }
}

TEST_CASE("numbers with a point so close that a binary grid holds their doubles are those doubles, else as written") {
  // A triangle of 1e-8: doubles near 0.1 are multiples of 2^-56, and the binary grid comes first.
  const Doubles near = {{0.1, 0.1}, {0.10000001, 0.1}, {0.1, 0.10000001}};
  const Triangulation binary = solver().triangulate(near, {});
  CHECK(binary.statistics.grid.kind == Grid::Kind::binary);
  // On a decimal cell of more than a last place they stand where they are written.
  Options options;
  options.grid = FixedGrid{0.1, 0.1, "1e-16"};
  const std::vector<std::array<std::int32_t, 2>> written = {{0, 0}, {100000000, 0}, {0, 100000000}};
  const Triangulation fixed = solver().triangulate(near, {}, options);
  CHECK(grid_points(fixed.statistics.grid, near) == written);
  CHECK(grid_points(binary.statistics.grid, near)[1][0] * binary.statistics.grid.cell() != 1e-8);
  // Farther apart they are decimals.
  const Triangulation decimal = solver().triangulate(Doubles{{0.1, 0.1}, {0.3, 0.1}, {0.1, 0.7}}, {});
  CHECK(decimal.statistics.grid.kind == Grid::Kind::decimal);
}
