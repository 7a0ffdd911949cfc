// SPDX-License-Identifier: Apache-2.0
// Which boxes tell a tile's vertices from those that are far away: of its grid points, and of coordinates as given.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "tiles/cuts.hpp"

using namespace gcdt;
using tiles::Box;
using tiles::Cuts;
using tiles::GridInput;
using tiles::KeyBox;

namespace {

constexpr std::uint64_t codes = 1u << 12;

void check_boxes(const Cuts& cuts) {
  for (std::size_t tile = 0; tile + 1 < cuts.tiles(); ++tile) {
    const auto [first, last] = cuts.codes_of(tile);
    CAPTURE(first);
    CAPTURE(last);
    const std::optional<Box> found = cuts.box_of(tile);
    REQUIRE(found.has_value() == (first <= last));
    if (!found) continue;
    Box least{{codes, codes}, {-1, -1}};
    for (std::uint64_t code = first; code <= last; ++code)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const std::int64_t at = tiles::point_of(code)[axis];
        least.least[axis] = std::min(least.least[axis], at), least.most[axis] = std::max(least.most[axis], at);
      }
    CHECK(found->least == least.least);
    CHECK(found->most == least.most);
  }
}

std::uint64_t bits_of(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return device::gcdt_without_negative_zero(bits);
}

bool has(const KeyBox& keys, double value, std::size_t axis) {
  const std::uint64_t key = device::gcdt_ordered(bits_of(value));
  return key >= keys.least[axis] && key <= keys.most[axis];
}

/// Where a coordinate is on the grid, which it must not be outside of.
std::int64_t placed(const ChosenGrid& chosen, double value, std::size_t axis) {
  std::array<double, 2> point{chosen.grid.origin};
  point[axis] = value;
  const Points one = Points::pairs(point.data(), 1);
  return GridInput{{one, 0, {}, 1}, chosen, {}, {}, {}}.at(0)[axis];
}

bool is_on(const ChosenGrid& chosen, double value, std::size_t axis) {
  Survey surveyed;
  for (std::size_t i = 0; i < 2; ++i) surveyed.least[i] = surveyed.most[i] = bits_of(chosen.grid.origin[i]);
  surveyed.most[axis] = bits_of(value);
  return !tiles::some_outside(chosen, surveyed);
}

/// The doubles around a number, some by their last digits.
std::vector<double> around(double value) {
  std::vector<double> all{value};
  for (double up = value, down = value; all.size() < 9;) {
    all.push_back(up = std::nextafter(up, std::numeric_limits<double>::infinity()));
    all.push_back(down = std::nextafter(down, -std::numeric_limits<double>::infinity()));
  }
  return all;
}

/// Boxes between some columns and rows of the grid: what is placed in them has its keys in their keys, and nothing else
/// that is on the grid.
void check_keys(const ChosenGrid& chosen, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> any(0, GCDT_GRID_LAST);
  const double cell = chosen.grid.cell();
  for (int i = 0; i < 40; ++i) {
    Box box{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::int64_t a = i == 0 ? 0 : any(random), b = i < 2 ? GCDT_GRID_LAST : i % 3 == 0 ? a : any(random);
      box.least[axis] = std::min(a, b), box.most[axis] = std::max(a, b);
    }
    const KeyBox keys = tiles::keys_of(chosen, box);
    for (std::size_t axis = 0; axis < 2; ++axis)
      for (const std::int64_t column : {box.least[axis] - 1, box.least[axis], box.most[axis], box.most[axis] + 1})
        for (const double part : {-0.5, -0.25, 0.0, 0.5})
          for (const double value : around(chosen.grid.origin[axis] + (static_cast<double>(column) + part) * cell)) {
            if (!is_on(chosen, value, axis)) continue;
            CAPTURE(value);
            const std::int64_t at = placed(chosen, value, axis);
            CHECK(has(keys, value, axis) == (at >= box.least[axis] && at <= box.most[axis]));
          }
  }
}

ChosenGrid on(double x, double y, const char* cell) { return fixed_grid(FixedGrid{x, y, cell}); }

ChosenGrid chosen_for(double least, double most, int decimals) {
  const Survey surveyed{{bits_of(least), bits_of(least)}, {bits_of(most), bits_of(most)}, -1074};
  const GridChoice choice = choose_grid(surveyed);
  return decimals < 0 ? choice.grid : choice.with_decimals(decimals);
}

}  // namespace

TEST_CASE("the box of a tile is the least that has all of its grid points") {
  check_boxes(Cuts({0, 1, 2, 3, 4, 8, 8, 12, 64, 65, 1000, 1024, 2048, 3000, codes}));
  std::mt19937_64 random(7);
  for (int i = 0; i < 50; ++i) {
    std::vector<std::uint64_t> first_codes(8);
    for (std::uint64_t& code : first_codes) code = random() % codes;
    std::sort(first_codes.begin(), first_codes.end());
    check_boxes(Cuts(first_codes));
  }
}

TEST_CASE("tiles at the ends of the grid have boxes to there") {
  const Cuts whole({}), halves({std::uint64_t{1} << 61});
  const auto last = static_cast<std::int64_t>(GCDT_GRID_LAST), middle = (last + 1) / 2;
  CHECK(whole.box_of(0)->most == std::array<std::int64_t, 2>{last, last});
  CHECK(halves.box_of(0)->most == std::array<std::int64_t, 2>{last, middle - 1});
  CHECK(halves.box_of(1)->least == std::array<std::int64_t, 2>{0, middle});
  CHECK(halves.box_of(1)->most == std::array<std::int64_t, 2>{last, last});
}

TEST_CASE("a box of the grid is one of coordinates as they were given") {
  check_keys(on(0, 0, "1"), 1);
  check_keys(on(-5.25, 1e9, "0.001"), 2);
  check_keys(on(1e-3, -1e-3, "3e-15"), 3);
  check_keys(on(-1e22, 5, "7e20"), 4);
  check_keys(on(0, -1e-320, "4.76837158203125e-07"), 5);
  check_keys(chosen_for(-1, 1, -1), 6);
  check_keys(chosen_for(1e9, 1e9 + 1, -1), 7);
  check_keys(chosen_for(-1e300, 1e300, -1), 8);
  check_keys(chosen_for(0, 1e-310, -1), 9);
}

TEST_CASE("a box of a decimal grid is one of decimals as they were given") {
  for (const auto [least, most] : {std::array<double, 2>{-12.5, 100.125}, {5, 7}, {-9000.125, -1}}) {
    CAPTURE(least);
    const ChosenGrid chosen = chosen_for(least, most, 3);
    REQUIRE(chosen.decimals);
    std::mt19937_64 random(11);
    std::uniform_int_distribution<long long> some(std::llround(least * 1000), std::llround(most * 1000));
    std::vector<double> given(60);
    for (double& value : given) value = static_cast<double>(some(random)) / 1000;
    for (int i = 0; i < 40; ++i) {
      std::int64_t a = placed(chosen, given[random() % given.size()], 0) + static_cast<std::int64_t>(random() % 3) - 1;
      std::int64_t b = placed(chosen, given[random() % given.size()], 0) + static_cast<std::int64_t>(random() % 3) - 1;
      a = std::max<std::int64_t>(a, 0), b = std::max<std::int64_t>(b, 0);
      const Box box{{std::min(a, b), std::min(a, b)}, {std::max(a, b), std::max(a, b)}};
      const KeyBox keys = tiles::keys_of(chosen, box);
      for (const double value : given)
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const std::int64_t at = placed(chosen, value, axis);
          CHECK(has(keys, value, axis) == (at >= box.least[axis] && at <= box.most[axis]));
        }
    }
  }
}
