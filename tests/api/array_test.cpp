// SPDX-License-Identifier: Apache-2.0
// The type of results' arrays: a vector that does not write its elements before their owner does.
#include <doctest/doctest.h>

#include <numeric>

#include "whole_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

TEST_CASE("resizing writes nothing to elements without a value") {
  for (const std::size_t count : {std::size_t{1}, std::size_t{1000}, std::size_t{5} << 20}) {
    Array<std::uint8_t> array(count);
    std::iota(array.begin(), array.end(), std::uint8_t{1});
    const Array<std::uint8_t> before = array;
    const std::uint8_t* place = array.data();
    array.clear();
    array.resize(count);
    CHECK(array.data() == place);
    CHECK(array == before);
    array.clear();
    array.resize(count, 7);  // a value is one
    CHECK(std::count(array.begin(), array.end(), std::uint8_t{7}) == static_cast<std::ptrdiff_t>(count));
  }
}

TEST_CASE("large arrays begin with a huge page") {
  const Array<std::array<std::uint32_t, 3>> large(std::size_t{1} << 20);
#ifdef __linux__
  CHECK(reinterpret_cast<std::uintptr_t>(large.data()) % (std::size_t{1} << 21) == 0);
#endif
  CHECK_THROWS_AS(ArrayAllocator<double>().allocate(~std::size_t{0}), std::bad_alloc);
}

TEST_CASE("it is like a vector, and compares with one") {
  Array<std::uint32_t> array = {3, 1, 2};
  array.push_back(4);
  array.insert(array.begin(), 9);
  const std::vector<std::uint32_t> vector = {9, 3, 1, 2, 4}, other = {9, 3, 1, 2, 5}, shorter = {9, 3, 1, 2};
  CHECK(array == vector);
  CHECK(vector == array);
  CHECK_FALSE(array != vector);
  for (const auto& different : {other, shorter, std::vector<std::uint32_t>()}) {
    CHECK(array != different);
    CHECK(different != array);
    CHECK_FALSE(array == different);
  }
  CHECK(std::vector<std::uint32_t>(array.begin(), array.end()) == vector);
  const Array<std::uint32_t> copy = array;
  array[0] = 8;
  CHECK(copy[0] == 9);
}

TEST_CASE("what results return goes back into the library as it is") {
  const Workload work = random_crossing(60, 30, 40, 2);
  Options options;
  options.crossing = Crossing::split;
  const Triangulation mesh = solver().triangulate(work.points, work.constraints, options);
  REQUIRE(mesh.added.size() > 0);
  Array<std::array<double, 2>> vertices(work.points.begin(), work.points.end());
  vertices.insert(vertices.end(), mesh.added.begin(), mesh.added.end());
  options.grid.reset();
  const Triangulation again = solver().triangulate(vertices, mesh.pieces);
  CHECK(again.statistics.n == work.points.size() + mesh.added.size());
  CHECK(again.statistics.m == mesh.pieces.size());
  const Result adopted = solver().adopt(vertices, again.triangles, again.pieces);
  CHECK(adopted.triangles() == again.triangles);
  std::vector<std::array<double, 3>> in_vector;
  Array<std::array<double, 3>> in_array;
  const Array<std::int32_t> found = adopted.locate(vertices, &in_vector);
  CHECK(adopted.locate(vertices, &in_array) == found);
  CHECK(adopted.locate(vertices) == found);
  CHECK(in_array == in_vector);
  CHECK(in_array.size() == vertices.size());
}

TEST_CASE("downloading to arrays that are there uses their memory again, but not far too much of it") {
  const Workload large = uniform(3000), small = uniform(300);
  Triangulation mesh = solver().triangulate(large.points);
  const Triangulation expected = mesh;
  const auto* place = mesh.triangles.data();
  const Result again = solver().solve(large.points);
  again.download(mesh);
  CHECK(mesh.triangles.data() == place);
  CHECK(same_bytes(mesh, expected));
  const Result less = solver().solve(small.points);
  less.download(mesh);
  CHECK(same_bytes(mesh, less.download()));
  CHECK(mesh.triangles.capacity() < 4 * (mesh.triangles.size() + 1));
  again.download(mesh);
  CHECK(same_bytes(mesh, expected));
}
