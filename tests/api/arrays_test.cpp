// SPDX-License-Identifier: Apache-2.0
// The table of arrays (gcdt/arrays.def): every number of gcdt.h has a row, and every row the elements that are right.
// What is expected is worked out by hand from what gcdt.h says.
#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "opencl_app.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Pair = std::array<std::int32_t, 2>;
using Triple = std::array<std::int32_t, 3>;

/// By name: a result's elements, as bytes.
using Elements = std::map<std::string, std::vector<unsigned char>>;

template <class T>
std::vector<unsigned char> bytes_of(const Array<T>& values) {
  std::vector<unsigned char> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// A square, its lower left corner given twice, and its diagonals, one given twice: they cross in its centre, which
// becomes vertex 5. Three sides are constraints that wind clockwise, the upper side is open.
//
//   3---------2
//   | \  3  / |
//   |  \  /   |      triangles: 0 on the left, 1 below, 2 on the right, 3 above
//   | 0  5  2 |
//   |  / \    |
//   | /  1  \ |
//   0,4-------1
const std::vector<std::array<std::int32_t, 2>> square = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}};
const std::vector<Constraint> diagonals_and_sides = {{4, 2}, {1, 3}, {2, 1}, {1, 0}, {0, 3}, {1, 3}};

Options with_all() {
  Options options;
  options.grid = FixedGrid{};
  options.crossing = Crossing::split;
  options.regions = true;
  return options;
}

// Z-order of the places: 0, 5, 1, 3, 2 (the Morton codes 0, 12, 16, 32, 48).
Elements expected_of_split(bool seeded) {
  Elements all;
  all["triangles"] = bytes_of<Triple>({{0, 5, 3}, {0, 1, 5}, {5, 1, 2}, {5, 2, 3}});
  all["neighbours"] = bytes_of<Triple>({{3, -1, 1}, {2, 0, -1}, {-1, 3, 1}, {-1, 0, 2}});
  all["constrained"] = bytes_of<std::uint8_t>({7, 7, 7, 6});
  all["representative"] = bytes_of<std::uint32_t>({0, 1, 2, 3, 0, 5});
  all["pieces"] = bytes_of<Pair>({{0, 5}, {0, 1}, {0, 3}, {5, 1}, {5, 3}, {5, 2}, {1, 2}});
  all["source_offsets"] = bytes_of<std::uint32_t>({0, 1, 2, 3, 5, 7, 8, 9});
  all["sources"] = bytes_of<std::uint32_t>({0, 3, 4, 1, 5, 1, 5, 0, 2});
  all["dropped"] = {};
  all["added_on_grid"] = bytes_of<Pair>({{2, 2}});
  all["added_crossing"] = bytes_of<Pair>({{0, 1}});
  all["added_origin"] = {};
  all["region"] = bytes_of<std::uint32_t>({0, 1, 2, 3});
  all["depth"] = bytes_of<std::uint32_t>({1, 1, 1, 0});
  all["winding"] = bytes_of<std::int32_t>({-1, -1, -1, 0});
  all["region_seed"] = bytes_of<std::int32_t>({seeded ? 1 : -1, seeded ? 0 : -1, -1, -1});
  all["excuse"] = {};
  all["vertex_triangles"] = bytes_of<std::int32_t>({0, 1, 2, 0, 0, 0});
  all["hull"] = bytes_of<std::uint32_t>({0, 1, 2, 3});
  all["edge_pieces"] = bytes_of<Triple>({{4, 2, 0}, {3, 0, 1}, {6, 5, 3}, {-1, 4, 5}});
  return all;
}

/// Without the arrays that batches do not have.
Elements in_batches(Elements all) {
  for (const char* name : {"vertex_triangles", "hull", "edge_pieces"}) all.erase(name);
  return all;
}

/// The rows of the table, by number.
std::map<std::int32_t, std::string> rows() {
  std::map<std::int32_t, std::string> all;
#define GCDT_ARRAY(number, name, ...) CHECK(all.emplace(number, #name).second);
#define GCDT_DERIVED_ARRAY GCDT_ARRAY
#include <gcdt/arrays.def>
  return all;
}

Elements copied_by_c(const Result& result) {
  Elements all;
  for (const auto& [number, name] : rows()) {
    std::vector<unsigned char>& bytes = all[name];
    bytes.resize(result.count(number) * gcdt_element_bytes(number));
    REQUIRE(gcdt_result_copy(result.handle(), number, bytes.data(), result.count(number)) == GCDT_OK);
  }
  return all;
}

Elements copied_by_cpp(const Result& result) {
  Elements all;
#define GCDT_ARRAY(number, name, ...) all[#name] = bytes_of(result.name());
#define GCDT_DERIVED_ARRAY GCDT_ARRAY
#include <gcdt/arrays.def>
  return all;
}

Elements elements_of(const Triangulation& mesh) {
  Elements all;
#define GCDT_ARRAY(number, name, ...) all[#name] = bytes_of(mesh.name);
#include <gcdt/arrays.def>
  return all;
}

Elements copied_on_device(const App& app, const Result& result) {
  Elements all;
  for (const auto& [number, name] : rows()) {
    const std::size_t bytes = result.count(number) * gcdt_element_bytes(number);
    if (bytes == 0) {
      all[name] = {};
      continue;
    }
    const cl::Buffer to = app.buffer(bytes);
    enqueue_copy(result, number, app.queue, to, result.count(number)).wait();
    all[name] = app.read<unsigned char>(to, bytes);
  }
  return all;
}

void check_equal(const Elements& found, const Elements& expected) {
  for (const auto& [name, bytes] : expected) {
    CAPTURE(name);
    REQUIRE(found.count(name) == 1);
    CHECK(found.at(name) == bytes);
  }
  CHECK(found.size() == expected.size());
}

}  // namespace

TEST_CASE("every number in gcdt.h has a row, and only those") {
  std::ifstream file(GCDT_TEST_DATA "/../include/gcdt/gcdt.h");
  std::stringstream text;
  text << file.rdbuf();
  const std::string header = text.str();
  const std::size_t begin = header.find("/* ---- The result ---"), end = header.find("};", begin);
  REQUIRE(end != std::string::npos);
  const std::string section = header.substr(begin, end - begin);
  const std::regex enumerator("(GCDT_[A-Z_]+) = ([0-9]+)");
  std::map<std::string, std::int32_t> numbers, found;
  for (std::sregex_iterator i(section.begin(), section.end(), enumerator), last; i != last; ++i)
    numbers[i->str(1)] = std::stoi(i->str(2));
#define GCDT_ARRAY(number, ...) found[#number] = number;
#define GCDT_DERIVED_ARRAY GCDT_ARRAY
#include <gcdt/arrays.def>
  CHECK(numbers == found);
  for (std::int32_t number = -1; number < 100; ++number)
    CHECK((gcdt_element_bytes(number) != 0) == (rows().count(number) != 0));
}

TEST_CASE("every array of a result, by C, by C++ and on the device") {
  const App app;
  Options options = with_all();
  options.region_seeds = {{2, 1}, {1, 2}};  // in triangles 1 and 0
  Solver solver = make_solver(app.queue);
  const Result result = solver.solve(square, diagonals_and_sides, options);
  const Elements expected = expected_of_split(true);
  check_equal(copied_by_c(result), expected);
  check_equal(copied_by_cpp(result), expected);
  check_equal(copied_on_device(app, result), expected);
  check_equal(elements_of(result.download()), in_batches(expected));
}

TEST_CASE("what a result does not have is empty, and constraints that were dropped are an array") {
  Options drop;
  drop.grid = FixedGrid{};
  drop.crossing = Crossing::drop;
  const Result result = solver().solve(square, diagonals_and_sides, drop);
  CHECK(result.dropped() == std::vector<std::uint32_t>{1, 5});
  std::set<std::string> empty;
  for (const auto& [name, bytes] : copied_by_c(result))
    if (bytes.empty()) empty.insert(name);
  CHECK(empty == std::set<std::string>{"added_on_grid", "added_crossing", "added_origin", "region", "depth", "winding",
                                       "region_seed", "excuse"});
}

TEST_CASE("every array of a problem in a batch: of one that is split, and of one among others") {
  Pool pool(test_device());
  const std::vector<std::array<double, 2>> points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}};
  Batch batch;
  batch.add({{1, 1}, {9, 1}, {5, 8}}, {{0, 1}});
  batch.add(points, diagonals_and_sides);
  const BatchResult split = pool.triangulate(batch, with_all());
  REQUIRE(!split.error(1));
  check_equal(elements_of(detail::triangulation(split, 1)), in_batches(expected_of_split(false)));

  Options drop = with_all();
  drop.crossing = Crossing::drop;
  const BatchResult dropped = pool.triangulate(batch, drop);
  REQUIRE(!dropped.error(1));
  check_equal(elements_of(detail::triangulation(dropped, 1)),
              elements_of(solver().triangulate(points, diagonals_and_sides, drop)));
  CHECK(dropped.dropped(1)[0] == 1);
  CHECK(dropped.region_seed(1).size() == 2);
}
