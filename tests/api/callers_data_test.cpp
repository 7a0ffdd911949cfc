// SPDX-License-Identifier: Apache-2.0
// Arguments that are wrong, through C and through C++: an error that names the row, and nothing of the caller's is
// written. What is given lies in memory that ends the process if it is written to or read beyond its end; what is to be
// filled has a pattern, which must still be there.
#include <doctest/doctest.h>

#include <limits>

#include <gcdt/gcdt_pool.hpp>

#include "read_only.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Indices = std::vector<std::uint64_t>;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();

/// Six vertices and four constraints, of which the first two cross nothing.
template <class T>
std::vector<T> corners() {
  return {0, 0, 8, 0, 8, 6, 0, 6, 2, 3, 5, 3};
}
const std::vector<std::uint32_t> sides = {0, 1, 1, 2, 2, 3, 3, 0};

template <class T>
std::vector<T> with(std::vector<T> values, std::size_t at, T value) {
  values[at] = value;
  return values;
}

/// What a call left behind: its status and what gcdt_last_error says of it.
struct Said {
  std::int32_t status;
  std::string message;
  Indices indices;
};
Said said(std::int32_t status) {
  gcdt_error error = GCDT_ERROR_INIT;
  REQUIRE(gcdt_last_error(nullptr, &error) == GCDT_OK);
  if (status != GCDT_OK) CHECK(error.status == status);
  return {status, error.message, {error.indices, error.indices + error.index_count}};
}
/// The status, the indices, and each index as a word of the message.
void check_said(const Said& all, std::int32_t status, const Indices& indices, const std::string& word) {
  CAPTURE(all.message);
  CHECK(all.status == status);
  CHECK(all.indices == indices);
  CHECK(all.message.find(word) != std::string::npos);
}
/// The same of what C++ throws.
template <class Call>
void check_thrown(Call&& call, Status status, const Indices& indices, const std::string& word) {
  try {
    call();
    FAIL("no error");
  } catch (const Error& error) {
    CAPTURE(std::string(error.what()));
    CHECK(error.status() == status);
    CHECK(error.indices() == indices);
    CHECK(std::string(error.what()).find(word) != std::string::npos);
  }
}

/// Memory to be filled, with a pattern.
template <class T>
struct Filled {
  std::vector<T> values;
  explicit Filled(std::size_t count) : values(count) { std::memset(values.data(), 0x5A, count * sizeof(T)); }
  T* data() { return values.data(); }
  bool untouched() const { return std::memcmp(values.data(), Filled(values.size()).values.data(), bytes()) == 0; }
  std::size_t bytes() const { return values.size() * sizeof(T); }
};

/// Where a call puts its handle.
template <class Handle>
struct Out {
  Handle* const pattern = reinterpret_cast<Handle*>(static_cast<std::uintptr_t>(0x5A5A5A50));
  Handle* handle = pattern;
  Handle** operator&() { return &handle; }
  bool untouched() const { return handle == pattern; }
};

gcdt_input input_of(std::int32_t type, const void* vertices, const ReadOnly<std::uint32_t>& constraints) {
  gcdt_input input = GCDT_INPUT_INIT;
  input.coordinate_type = type, input.vertices = vertices, input.vertex_count = 6;
  input.constraints = constraints.data(), input.constraint_count = constraints.size() / 2;
  return input;
}

/// A vertex of the input, number 4, has a y that makes no sense: every function that reads the input says so.
template <class T>
void check_coordinate(std::int32_t type, T wrong, std::int32_t status) {
  const ReadOnly<T> vertices(with(corners<T>(), 9, wrong));
  const ReadOnly<std::uint32_t> constraints(sides);
  const gcdt_input input = input_of(type, vertices.data(), constraints);
  Out<gcdt_result> result;
  check_said(said(gcdt_triangulate(solver().handle(), &input, nullptr, &result)), status, {4, 1}, "vertex 4");
  CHECK(result.untouched());
  Filled<gcdt_grid> grid(1);
  check_said(said(gcdt_choose_grid(&input, nullptr, grid.data())), status, {4, 1}, "vertex 4");
  CHECK(grid.untouched());
  const ReadOnly<std::uint64_t> offsets({0, 3, 6}), polygons({0, 1, 2});
  gcdt_rings rings = GCDT_RINGS_INIT;
  rings.ring_offsets = offsets.data(), rings.ring_count = 2;
  rings.polygon_offsets = polygons.data(), rings.polygon_count = 2;
  Filled<std::uint32_t> made(12);
  check_said(said(gcdt_ring_constraints(&input, &rings, made.data(), 6)), status, {4, 1}, "vertex 4");
  CHECK(made.untouched());
  const Points points = Points::pairs(vertices.data(), 6);
  const Status thrown =
      status == GCDT_ERROR_COORDINATE_NOT_FINITE ? Status::coordinate_not_finite : Status::coordinate_outside_grid;
  check_thrown([&] { solver().triangulate(points); }, thrown, {4, 1}, "vertex 4");
  check_thrown([&] { choose_grid(points); }, thrown, {4, 1}, "vertex 4");
}

/// The result of the right input, for functions that ask one.
Result asked() {
  static const std::vector<std::array<double, 2>> points = {{0, 0}, {8, 0}, {8, 6}, {0, 6}, {2, 3}, {5, 3}};
  static const std::vector<Constraint> constraints = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  return solver().solve(points, constraints);
}

Pool& pool() {
  static Pool instance(test_device());
  return instance;
}

}  // namespace

TEST_CASE("a coordinate that makes no sense is named, and nothing is written") {
  for (const double wrong : {not_a_number, infinity, -infinity}) {
    check_coordinate<double>(GCDT_FLOAT64, wrong, GCDT_ERROR_COORDINATE_NOT_FINITE);
    check_coordinate<float>(GCDT_FLOAT32, static_cast<float>(wrong), GCDT_ERROR_COORDINATE_NOT_FINITE);
  }
  for (const std::int64_t wrong : {(std::int64_t{1} << 53) + 1, std::numeric_limits<std::int64_t>::min()})
    check_coordinate<std::int64_t>(GCDT_INT64, wrong, GCDT_ERROR_COORDINATE_OUTSIDE_GRID);
}

TEST_CASE("a constraint's end that does not exist is named, and constraints that cross are; nothing is written") {
  const ReadOnly<double> vertices(corners<double>());
  const Points points = Points::pairs(vertices.data(), 6);
  Out<gcdt_result> result;
  for (const std::uint32_t wrong : {6u, 1u << 31, UINT32_MAX})
    for (const std::uint32_t end : {0u, 1u}) {
      const ReadOnly<std::uint32_t> constraints(with(sides, 4 + end, wrong));
      const gcdt_input input = input_of(GCDT_FLOAT64, vertices.data(), constraints);
      const std::string word = end == 0 ? "constraint 2: its first end" : "constraint 2: its second end";
      for (std::int32_t crossing = 0; crossing < 3; ++crossing) {
        gcdt_options options = GCDT_OPTIONS_INIT;
        options.crossing = crossing;
        const Said all = said(gcdt_triangulate(solver().handle(), &input, &options, &result));
        check_said(all, GCDT_ERROR_INDEX_OUT_OF_RANGE, {2, end}, word);
      }
      const Constraints pairs = {reinterpret_cast<const Constraint*>(constraints.data()), 4};
      check_thrown([&] { solver().triangulate(points, pairs); }, Status::index_out_of_range, {2, end}, word);
    }
  const ReadOnly<std::uint32_t> crossing({0, 1, 0, 2, 1, 3, 4, 5});
  const gcdt_input input = input_of(GCDT_FLOAT64, vertices.data(), crossing);
  const Said all = said(gcdt_triangulate(solver().handle(), &input, nullptr, &result));
  check_said(all, GCDT_ERROR_CONSTRAINTS_CROSS, {1, 2, 1, 3, 2, 3}, "");
  CHECK(result.untouched());
}

TEST_CASE("options that make no sense are named by their row, and nothing is written") {
  const ReadOnly<double> vertices(corners<double>()), seeds({1, 1, 7, 5, 2, not_a_number}), areas({1, 1, -1});
  const ReadOnly<double> sizes({1, 1, 1, 0, 1, 1}), sound({1, 1, 7, 5, 2, 2});
  const ReadOnly<std::uint32_t> constraints(sides);
  const gcdt_input input = input_of(GCDT_FLOAT64, vertices.data(), constraints);
  Out<gcdt_result> result;
  const auto tried = [&](const gcdt_options& options) {
    const Said all = said(gcdt_triangulate(solver().handle(), &input, &options, &result));
    CHECK(result.untouched());
    return all;
  };
  gcdt_options options = GCDT_OPTIONS_INIT;
  options.domain = GCDT_DOMAIN_HOLES, options.hole_seeds = seeds.data(), options.hole_seed_count = 3;
  check_said(tried(options), GCDT_ERROR_COORDINATE_NOT_FINITE, {2, 1}, "hole_seeds: seed 2");
  options.hole_seeds = nullptr, options.hole_seed_count = 0;
  options.region_seeds = seeds.data(), options.region_seed_count = 3;
  check_said(tried(options), GCDT_ERROR_COORDINATE_NOT_FINITE, {2, 1}, "region_seeds: seed 2");
  options.region_seeds = sound.data();
  gcdt_refinement refine = GCDT_REFINEMENT_INIT;
  options.refine = &refine;
  refine.region_areas = areas.data(), refine.region_area_count = 3;
  check_said(tried(options), GCDT_ERROR_INVALID_ARGUMENT, {2}, "region_areas");
  refine.region_areas = nullptr, refine.region_area_count = 0;
  refine.sizes = sizes.data(), refine.size_count = 6;
  check_said(tried(options), GCDT_ERROR_INVALID_ARGUMENT, {3}, "sizes");
  gcdt_options fixed = GCDT_OPTIONS_INIT;
  fixed.fixed_grid = 1, fixed.grid_x = 1, fixed.grid_cell = "0.001";
  check_said(tried(fixed), GCDT_ERROR_COORDINATE_OUTSIDE_GRID, {0, 0}, "vertex 0");
}

TEST_CASE("functions on the host name what is wrong, and leave what they were to fill") {
  const ReadOnly<double> vertices(with(corners<double>(), 9, not_a_number)), sound(corners<double>());
  const ReadOnly<std::uint32_t> constraints(sides);
  const gcdt_input bad = input_of(GCDT_FLOAT64, vertices.data(), constraints);
  const gcdt_input good = input_of(GCDT_FLOAT64, sound.data(), constraints);
  Filled<std::uint32_t> rings_of(12);
  const ReadOnly<std::uint64_t> offsets({0, 3, 6}), falling({0, 4, 3}), polygons({0, 1, 2});
  gcdt_rings rings = GCDT_RINGS_INIT;
  rings.ring_offsets = offsets.data(), rings.ring_count = 2;
  rings.polygon_offsets = polygons.data(), rings.polygon_count = 2;
  const auto ring = [&](const gcdt_input& input, std::uint64_t room) {
    const Said all = said(gcdt_ring_constraints(&input, &rings, rings_of.data(), room));
    CHECK(rings_of.untouched());
    return all;
  };
  check_said(ring(bad, 6), GCDT_ERROR_COORDINATE_NOT_FINITE, {4, 1}, "vertex 4");
  check_said(ring(good, 5), GCDT_ERROR_BUFFER_TOO_SMALL, {6, 5}, "");
  rings.ring_offsets = falling.data();
  check_said(ring(good, 6), GCDT_ERROR_INVALID_ARGUMENT, {1}, "ring_offsets: element 1");

  const gcdt_grid grid = detail::grid(choose_grid(Points::pairs(sound.data(), 6)));
  Filled<std::int32_t> places(12);
  check_said(said(gcdt_grid_points(&grid, vertices.data(), 6, places.data())), GCDT_ERROR_COORDINATE_NOT_FINITE, {4, 1},
             "point 4");
  const ReadOnly<double> outside(with(corners<double>(), 4, 1e300));
  check_said(said(gcdt_grid_points(&grid, outside.data(), 6, places.data())), GCDT_ERROR_COORDINATE_OUTSIDE_GRID,
             {2, 0}, "point 2");
  CHECK(places.untouched());
  Filled<double> coordinates(4);
  const ReadOnly<std::int32_t> negative({0, 0, 5, -1});
  check_said(said(gcdt_grid_coordinates(&grid, negative.data(), 2, coordinates.data())), GCDT_ERROR_INVALID_ARGUMENT,
             {1, 1}, "point 1");
  const ReadOnly<std::uint32_t> crossings({0, 1, 2, 4});
  const ReadOnly<double> added({1, 1, 2, 2}), values({1, 2, 3, 4, 5, 6});
  check_said(said(gcdt_added_values(&good, added.data(), crossings.data(), 2, values.data(), coordinates.data())),
             GCDT_ERROR_INVALID_ARGUMENT, {1, 4}, "added vertex 1");
  const ReadOnly<std::uint32_t> origins({0, 1, UINT32_MAX, UINT32_MAX, 2, 8, UINT32_MAX, UINT32_MAX});
  check_said(said(gcdt_refined_values(&good, added.data(), crossings.data(), origins.data(), 2, values.data(),
                                      coordinates.data())),
             GCDT_ERROR_INVALID_ARGUMENT, {1}, "added vertex 1");
  CHECK(coordinates.untouched());
}

TEST_CASE("questions to a result name the point that is wrong, and leave what they were to fill") {
  const Result result = asked();
  const ReadOnly<double> points(with(corners<double>(), 7, infinity)), values({1, 2, 3, 4, 5, 6});
  Filled<std::int32_t> triangles(6);
  Filled<double> weights(18), found(6);
  check_said(said(gcdt_locate(result.handle(), GCDT_FLOAT64, points.data(), 6, triangles.data(), weights.data())),
             GCDT_ERROR_COORDINATE_NOT_FINITE, {3, 1}, "point 3");
  check_said(said(gcdt_interpolate(result.handle(), GCDT_FLOAT64, points.data(), 6, values.data(), -1, found.data())),
             GCDT_ERROR_COORDINATE_NOT_FINITE, {3, 1}, "point 3");
  const ReadOnly<std::int64_t> whole(with(corners<std::int64_t>(), 10, std::int64_t{1} << 60));
  check_said(said(gcdt_locate(result.handle(), GCDT_INT64, whole.data(), 6, triangles.data(), weights.data())),
             GCDT_ERROR_COORDINATE_OUTSIDE_GRID, {5, 0}, "point 5");
  CHECK((triangles.untouched() && weights.untouched() && found.untouched()));
  const Points queries = Points::pairs(points.data(), 6);
  for (const std::size_t before : {std::size_t{0}, std::size_t{2}, std::size_t{9}}) {
    std::vector<std::array<double, 3>> kept(before, {7, 8, 9});
    check_thrown([&] { result.locate(queries, &kept); }, Status::coordinate_not_finite, {3, 1}, "point 3");
    CHECK(kept == std::vector<std::array<double, 3>>(before, {7, 8, 9}));
  }
  check_thrown([&] { result.interpolate(queries, values.span(), -1); }, Status::coordinate_not_finite, {3, 1},
               "point 3");
}

TEST_CASE("a mesh with a corner that does not exist is refused by its triangle, and nothing is written") {
  const ReadOnly<double> vertices(corners<double>());
  const ReadOnly<std::uint32_t> constraints(sides), triangles({0, 1, 5, 0, 5, 6});
  const gcdt_input input = input_of(GCDT_FLOAT64, vertices.data(), constraints);
  gcdt_mesh mesh = GCDT_MESH_INIT;
  mesh.triangles = triangles.data(), mesh.triangle_count = 2;
  Out<gcdt_result> result;
  check_said(said(gcdt_adopt(solver().handle(), &input, &mesh, nullptr, &result)), GCDT_ERROR_INVALID_ARGUMENT, {1, 2},
             "triangle 1");
  CHECK(result.untouched());
  const gcdt_grid grid = detail::grid(choose_grid(Points::pairs(vertices.data(), 6)));
  CHECK(gcdt_verify(&input, &mesh, &grid, GCDT_CROSSING_REJECT) == GCDT_ERROR_NOT_VALID);
  gcdt_refinement refine = GCDT_REFINEMENT_INIT;
  gcdt_options options = GCDT_OPTIONS_INIT;
  options.refine = &refine;
  Filled<std::uint8_t> excuses(2);
  gcdt_refined_report report = {};
  report.struct_size = sizeof report, report.far = 77;
  CHECK(gcdt_verify_refined(&input, &mesh, &grid, &options, &report, excuses.data()) == GCDT_ERROR_NOT_VALID);
  CHECK((excuses.untouched() && report.far == 77));
}

TEST_CASE("a batch names the problem's own rows, and offsets that fall; nothing is written") {
  std::vector<double> all = corners<double>();
  all.insert(all.end(), all.begin(), all.end());
  const ReadOnly<double> vertices(with(all, 21, not_a_number));
  const ReadOnly<std::uint32_t> constraints({0, 1, 0, 6, 0, 1, 1, 2});
  const ReadOnly<std::uint64_t> offsets({0, 6, 12}), ends({0, 2, 4}), falling({0, 6, 5});
  gcdt_batch_input input = GCDT_BATCH_INPUT_INIT;
  input.problem_count = 2, input.vertices = vertices.data(), input.vertex_offsets = offsets.data();
  input.constraints = constraints.data(), input.constraint_offsets = ends.data();
  gcdt_batch* batch = nullptr;
  REQUIRE(gcdt_pool_triangulate(pool().handle(), &input, nullptr, &batch) == GCDT_OK);
  const BatchResult result(batch);
  const auto problem = [&](std::size_t p) { throw result.error(p).value(); };
  check_thrown([&] { problem(0); }, Status::index_out_of_range, {1, 1}, "constraint 1: its second end");
  check_thrown([&] { problem(1); }, Status::coordinate_not_finite, {4, 1}, "vertex 4");
  Out<gcdt_batch> none;
  input.vertex_offsets = falling.data();
  check_said(said(gcdt_pool_triangulate(pool().handle(), &input, nullptr, &none)), GCDT_ERROR_INVALID_ARGUMENT, {1},
             "vertex_offsets fall from problem 1");
  CHECK(none.untouched());
  Filled<std::uint32_t> triangles(3);
  Filled<std::uint64_t> begins(3);
  const ReadOnly<double> sound(all);
  input.vertices = sound.data(), input.vertex_offsets = offsets.data();
  REQUIRE(gcdt_pool_triangulate(pool().handle(), &input, nullptr, &batch) == GCDT_OK);
  const BatchResult one(batch);
  const Said small = said(gcdt_batch_copy(batch, GCDT_TRIANGLES, triangles.data(), 1, begins.data()));
  check_said(small, GCDT_ERROR_BUFFER_TOO_SMALL, {one.triangles(1).size(), 1}, "");
  CHECK((triangles.untouched() && begins.untouched()));
}
