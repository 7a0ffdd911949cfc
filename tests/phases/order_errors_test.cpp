// SPDX-License-Identifier: Apache-2.0
// What the order phase refuses, and how it names it, on every device.
#include "order_cases.hpp"

using namespace gcdt;
using namespace families;
using namespace order_cases;

TEST_CASE("a point outside a fixed grid is an error that names the least such vertex, never clipped") {
  for (auto& device : devices_under_test()) {
    Engine e(8);
    Doubles points =
        draw(e, 3000, families::all.at("uniform in the unit square"), families::all.at("uniform in the unit square"));
    auto expect = [&](const FixedGrid& fixed, std::vector<std::uint64_t> indices) {
      try {
        run(*device, points, fixed);
        FAIL("no error");
      } catch (const Error& error) {
        CHECK(error.status() == Status::coordinate_outside_grid);
        CHECK(error.indices() == indices);
      }
    };
    points[2000] = {-0.2, -1};
    points[1000] = {0.5, 3e9};
    expect({0, 0, "1"}, {1000, 1});
    points[1000] = {0.5, 2147483647.5};
    expect({0, 0, "1"}, {1000, 1});
    points[1000] = {0.5, 2147483647.25};
    expect({0, 0, "1"}, {2000, 1});
    expect({0, 0, "0.1"}, {1000, 1});
    points[1000] = points[2000] = {-0.5, -0.5};
    CHECK(run(*device, points, FixedGrid{0, 0, "1"}).points.size() == 4);
    CHECK_THROWS_AS(run(*device, points, FixedGrid{0, 0, "-1"}), Error);
    CHECK_THROWS_AS(run(*device, Doubles{}, FixedGrid{0, 0, "-1"}), Error);
    CHECK(run(*device, Doubles{}, FixedGrid{0, 0, "2"}).grid.cell() == 2);
  }
}

TEST_CASE("whole numbers on the grid of whole numbers stay as they are, and those below 0 are outside") {
  for (auto& device : devices_under_test()) {
    Engine e(19);
    std::vector<std::array<std::int32_t, 2>> points(3000);
    for (auto& p : points)
      for (std::int32_t& c : p) c = static_cast<std::int32_t>(e() >> 33);
    points[7] = {0, 2147483647}, points[8] = {2147483647, 0};
    Doubles same;
    for (const auto& p : points) same.push_back({double(p[0]), double(p[1])});
    const FixedGrid whole{0, 0, "1"};
    check_same(run(*device, points, whole), run(*device, same, whole));
    // Other grids are not those of whole numbers.
    for (const FixedGrid& other : {FixedGrid{0, 0, "2"}, FixedGrid{-3, 0, "1"}, FixedGrid{0, -1, "1"}}) {
      points[7] = points[8] = {1, 1};
      same[7] = same[8] = {1, 1};
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t axis = 0; axis < 2; ++axis) same[i][axis] = points[i][axis] /= 2;
      check_same(run(*device, points, other), run(*device, same, other));
    }
    for (const auto& [outside, axis] : {std::pair<std::array<std::int32_t, 2>, std::uint64_t>{{5, -1}, 1},
                                        {{-1, 5}, 0},
                                        {{-2147483647 - 1, -1}, 0}}) {
      points[2000] = {-1, -1};
      points[1000] = outside;
      try {
        run(*device, points, whole);
        FAIL("no error");
      } catch (const Error& error) {
        CHECK(error.status() == Status::coordinate_outside_grid);
        CHECK(error.indices() == std::vector<std::uint64_t>{1000, axis});
      }
      points[2000] = points[1000] = {1, 1};
    }
  }
}

TEST_CASE("the least vertex that is not finite is named, x before y") {
  const double infinite = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& device : devices_under_test())
    for (double bad : {infinite, -infinite, nan, -nan}) {
      Engine e(4);
      Doubles points = draw(e, 5000, families::all.at("uniform around 0"), families::all.at("uniform around 0"));
      points[4000][0] = bad;
      points[1234][1] = bad;
      std::vector<std::array<float, 2>> floats;
      for (const auto& p : points) floats.push_back({float(p[0]), float(p[1])});
      for (const Points& view : {Points(points), Points(floats)})
        for (const std::optional<FixedGrid>& fixed :
             {std::optional<FixedGrid>(), std::optional<FixedGrid>(FixedGrid{5, 5, "1"})})
          try {
            run(*device, view, fixed);
            FAIL("no error");
          } catch (const Error& error) {
            CHECK(error.status() == Status::coordinate_not_finite);
            CHECK(error.indices() == std::vector<std::uint64_t>{1234, 1});
          }
    }
}

TEST_CASE("more vertices than can be numbered are refused before they are read") {
  try {
    run(*devices_under_test()[0], Points::pairs(static_cast<const double*>(nullptr), max_vertices + 1));
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(error.status() == Status::too_many_vertices);
  }
}
