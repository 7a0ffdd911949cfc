// SPDX-License-Identifier: Apache-2.0
// The order phase on every device against the oracle.
#include <map>

#include "order_cases.hpp"
#include "phases/maxima.hpp"

using namespace gcdt;
using namespace families;
using namespace order_cases;

TEST_CASE("every family of coordinates gets the grid and the places that the rules say") {
  Engine e(1);
  for (const auto& [name, family] : families::all) {
    CAPTURE(name);
    for (std::size_t n : {1, 2, 3, 5, 20, 20, 60}) check_all(draw(e, n, family, family));
    check_all(draw(e, 20, family, families::all.at("tenths")));
    check_all(draw(e, 20, families::all.at("uniform around 0"), family));
  }
}

TEST_CASE("all four kinds occur in the families") {
  Engine e(2);
  std::map<std::string, Grid::Kind> kinds;
  Device& device = *devices_under_test()[0];
  for (const auto& [name, family] : families::all) kinds[name] = run(device, draw(e, 200, family, family)).grid.kind;
  for (const std::string name : {"31-bit integers", "eighths", "integers above 2^53 in a short range", "few denormals",
                                 "the last digits of a double"}) {
    CAPTURE(name);
    CHECK(kinds[name] == Grid::Kind::binary);
  }
  for (const std::string name :
       {"degrees with 6 decimals", "tenths", "powers of two and ten", "a decimal range far from 0", "22 decimals"}) {
    CAPTURE(name);
    CHECK(kinds[name] == Grid::Kind::decimal);
  }
  for (const std::string name : {"degrees with 7 decimals", "UTM metres to the millimetre",
                                 "uniform in the unit square", "any bits", "23 decimals"}) {
    CAPTURE(name);
    CHECK(kinds[name] == Grid::Kind::rounded);
  }
}

TEST_CASE("no points, one point, two points and equal points are fine") {
  const Read none = check_all({});
  CHECK(none.points.empty());
  CHECK(none.grid.cell() == 1);
  for (const Doubles& points : {Doubles{{0.1, 0.2}}, Doubles(50, {0.1, -7e200}), Doubles{{0.0, 0.0}, {-0.0, 0.0}}}) {
    const Read read = check_all(points);
    CHECK(read.points.size() == 1);
    CHECK(read.merged == points.size() - 1);
    CHECK(read.grid.kind == Grid::Kind::binary);
    CHECK(read.grid.cell() == 1);
    CHECK(!std::signbit(read.grid.origin[0]));
  }
  CHECK(check_all({{0.1, 0.2}, {0.1, 0.3}}).grid.kind == Grid::Kind::decimal);
}

TEST_CASE("the finest cell is taken at the very edge of the grid") {
  const double last = 2147483647.0;
  CHECK(check_all({{0, 0}, {last, 1}}).grid.cell() == 1);
  CHECK(check_all({{0, 0}, {last + 1, 1}}).grid.cell() == 2);
  CHECK(check_all({{0, 0}, {last + 0.4375, 0.5}}).grid.kind == Grid::Kind::rounded);
  CHECK(check_all({{0, 0}, {last + 0.4375, 0.5}}).grid.cell() == 1);
  CHECK(check_all({{0, 0}, {last + 0.5, 0.5}}).grid.cell() == 2);
  CHECK(check_all({{0, 0}, {214748364.7, 0.1}}).grid.cell() == 0.1);
  CHECK(check_all({{0, 0}, {214748364.8, 0.1}}).grid.kind == Grid::Kind::rounded);
  CHECK(check_all({{0.1, 0}, {0.2, 0.1}}).grid.cell() == 1e-10);
}

TEST_CASE("ties go to even and a hair beside a tie decides") {
  // The extent makes the cell 2, so odd numbers are ties.
  const double far = 4294967292.0;
  Doubles points{{0, 0}, {far, 0}};
  for (double v : {1.0, 3.0, 5.0, 7.0, 1001.0, 4294967291.0})
    for (double w : {v, std::nextafter(v, 0.0), std::nextafter(v, 1e10)}) points.push_back({w, w});
  CHECK(check_all(points).grid.kind == Grid::Kind::rounded);
  // An origin below the window: x - o is a hair less or more than a tie.
  for (double hair : {1e-300, -1e-300, 1e-20, -1e-20, 5e-324}) {
    Doubles shifted = points;
    for (auto& p : shifted) p = {p[0] == 0 ? hair : p[0] + 1e-3 - 1e-3, p[1] == 0 ? hair : p[1]};
    shifted[1][1] = hair;
    check_all(shifted);
  }
}

TEST_CASE("floats and integers are taken as the doubles they are") {
  Engine e(3);
  for (auto& device : devices_under_test()) {
    CAPTURE(device->runtime.info().name);
    for (int round = 0; round < 20; ++round) {
      std::vector<std::array<float, 2>> floats(40);
      std::vector<std::array<std::int32_t, 2>> ints(40);
      for (auto& p : floats)
        for (auto& v : p) {
          const std::uint32_t bits = std::uint32_t(e()) >> (round == 1 ? 10 : 0);  // round 1: denormals and small
          std::memcpy(&v, &bits, sizeof v);
          if (round >= 2 || !std::isfinite(v)) v = float(uniform(e, -100, 100));
        }
      for (auto& p : ints)
        for (auto& v : p) v = std::int32_t(round == 0 ? integer(e, -3, 3) : std::int64_t(std::int32_t(e())));
      ints[0] = {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()};
      Doubles from_floats, from_ints;
      for (const auto& p : floats) from_floats.push_back({p[0], p[1]});
      for (const auto& p : ints) from_ints.push_back({double(p[0]), double(p[1])});
      check_same(run(*device, floats), run(*device, from_floats));
      check_same(run(*device, ints), run(*device, from_ints));
      std::vector<std::array<std::int64_t, 2>> longs(40);
      Doubles from_longs;
      for (auto& p : longs)
        for (auto& v : p) v = integer(e, -(std::int64_t(1) << 53), std::int64_t(1) << 53) >> (round % 4 * 16);
      longs[0] = {-(std::int64_t(1) << 53), std::int64_t(1) << 53};
      for (const auto& p : longs) from_longs.push_back({double(p[0]), double(p[1])});
      check_same(run(*device, longs), run(*device, from_longs));
    }
  }
}

TEST_CASE("a fixed grid places points as given, and its report is the caller's grid") {
  Engine e(7);
  for (const char* cell :
       {"1", "0.001", "1e-3", "0.5", "7.25", "0.000000476837158203125", "3e2", "1234567890123456789e-18"}) {
    CAPTURE(cell);
    const FixedGrid fixed{-12.3, 4.5, cell};
    oracle::Choice expected;
    expected.origin = {oracle::exact(fixed.x), oracle::exact(fixed.y)};
    const oracle::Rational edge = oracle::decimal_number(cell);
    Doubles points;
    for (int i = 0; i < 300; ++i) points.push_back({uniform(e, -12.3, 900), uniform(e, 4.5, i % 2 ? 4.6 : 900)});
    oracle::place(expected, points, edge);
    for (auto& device : devices_under_test()) {
      const Read read = run(*device, points, fixed);
      check_numbering(read);
      check_grid_points(read, expected.grid);
      CHECK(read.grid.kind == Grid::Kind::fixed);
      CHECK(read.grid.origin == std::array<double, 2>{fixed.x, fixed.y});
      CHECK(read.grid.cell() == std::strtod(cell, nullptr));
      check_move(read.grid.largest_move, expected.largest_move, edge);
    }
  }
}

TEST_CASE("the launch geometry does not matter") {
  Engine e(5);
  const Doubles points = draw(e, 3000, families::all.at("tenths"), families::all.at("degrees with 6 decimals"));
  const Doubles rounded = draw(e, 3000, families::all.at("uniform around 0"), families::all.at("1e300, 1 and 1e-300"));
  for (auto& device : devices_under_test()) {
    const runtime::Geometry before = device->runtime.geometry();
    const Read expected = run(*device, points), expected_rounded = run(*device, rounded);
    for (const runtime::Geometry& geometry : {runtime::Geometry{1, 1}, runtime::Geometry{3, 5}, runtime::Geometry{7, 3},
                                              runtime::Geometry{64, 1000}, runtime::Geometry{100, 2}}) {
      device->runtime.geometry() = geometry;
      check_same(expected, run(*device, points));
      check_same(expected_rounded, run(*device, rounded));
    }
    device->runtime.geometry() = before;
  }
}

TEST_CASE("the maxima of a table are those of all its rows") {
  Engine e(6);
  for (auto& device : devices_under_test()) {
    const runtime::Geometry before = device->runtime.geometry();
    for (const std::size_t rows : {1u, 1000u, 1025u, 7 * 1024u + 3, 150001u}) {
      CAPTURE(rows);
      device->runtime.geometry() = {1, rows};
      Maxima maxima(device->runtime, rows, 3);
      REQUIRE(maxima.rows == rows);
      // The greatest of a column stands in one row, which is another one for each column.
      std::vector<cl_ulong> table(3 * rows);
      for (cl_ulong& value : table) value = e() >> 8;
      std::vector<cl_ulong> most;
      for (std::size_t column = 0; column < 3; ++column) {
        most.push_back(~cl_ulong{0} - (e() >> 8));
        table[3 * (e() % rows) + column] = most.back();
      }
      device->runtime.write(maxima.table, table.data(), table.size());
      device->runtime.geometry() = before;
      CHECK(maxima.read(device->runtime) == most);
    }
  }
}

TEST_CASE("few vertices and one more come out alike, with equal ones among them, of any type") {
  const auto few = static_cast<int>(Tuning::one_item_orders * Tuning().one_item_vertices);
  Engine e(7);
  for (const int n : {few - 1, few, few + 1})
    for (const char* family : {"tenths", "uniform around 0", "1e300, 1 and 1e-300"}) {
      CAPTURE(n);
      CAPTURE(family);
      Doubles points = draw(e, n, families::all.at(family), families::all.at(family));
      for (std::size_t i = 0; i < 100; ++i) points[points.size() - 1 - 3 * i] = points[5 * i];
      const Read read = check_all(points);
      CHECK(read.merged >= 100);
      std::vector<std::array<float, 2>> floats;
      std::vector<std::array<std::int32_t, 2>> ints;
      for (std::size_t i = 0; i < points.size(); ++i) {
        floats.push_back({float(i % 97) / 10, float(i % 89) * 3});
        ints.push_back({std::int32_t(i * 7919 % 1000), -std::int32_t(i % 31)});
      }
      for (auto& device : devices_under_test()) {
        check_same(run(*devices_under_test()[0], floats), run(*device, floats));
        check_same(run(*devices_under_test()[0], ints), run(*device, ints));
      }
    }
}

TEST_CASE("nothing stays allocated but the vertices") {
  Device& device = *devices_under_test()[0];
  Engine e(6);
  const Doubles points = draw(e, 10000, families::all.at("uniform around 0"), families::all.at("uniform around 0"));
  device.primitives.release();
  const std::uint64_t before = device.runtime.meter().now;
  {
    const OrderResult result = order(device.runtime, device.primitives, plan_for(device.runtime, points, coarsest),
                                     stage(device.runtime, points), {});
    const Vertices& v = result.vertices;
    device.primitives.release();  // the scan's
    CHECK(device.runtime.meter().now - before ==
          v.points.bytes() + v.vertex_input.bytes() + v.input_vertex.bytes() + v.levels_buffer.bytes());
  }
  CHECK(device.runtime.meter().now == before);
}
