// SPDX-License-Identifier: Apache-2.0
// Made-up multi-polygons on a lattice whose areas are known: each polygon is a set of cells, its rings are the borders
// of the set (outer ones counter-clockwise, holes clockwise). Neighbours share borders, corners touch, sets nest and
// overlap; borders meet in lattice points only, so no two constraints cross.
#pragma once

#include <map>

#include "solver_fixture.hpp"

namespace gcdt::test {

struct Polygons {
  std::int64_t columns = 0, rows = 0;
  std::vector<std::array<std::int32_t, 2>> points;
  std::vector<Constraint> constraints;
  std::vector<int> winding;            ///< by cell: polygons that cover it, those with reversed rings counted -1
  std::vector<std::int64_t> shoelace;  ///< by polygon: twice the area by its rings, as they are directed
  std::int64_t cell_area = 0;          ///< twice the area of a cell
};

/// A lattice point after a linear map that keeps orientation, so that borders run in skew directions.
inline std::array<std::int32_t, 2> skewed(std::int64_t x, std::int64_t y) {
  return {static_cast<std::int32_t>(7 * x + 2 * y), static_cast<std::int32_t>(11 * y - 3 * x + 3000)};
}

/// The cells of one more polygon, of which none may be `taken` unless polygons overlap.
inline std::vector<int> choose_cells(Polygons& made, std::vector<int>& taken, double share, bool overlap, bool reversed,
                                     Random& random) {
  std::vector<int> in(taken.size(), 0);
  for (std::size_t c = 0; c < in.size(); ++c) {
    in[c] = random.unit() < share && (overlap || !taken[c]);
    taken[c] |= in[c];
    made.winding[c] += reversed ? -in[c] : in[c];
  }
  return in;
}

/// `count` polygons of about `share` of the cells each; `overlap`: a cell may be in several.
/// `reversible`: some polygons have all their rings reversed.
inline Polygons make_polygons(std::int64_t columns, std::int64_t rows, int count, double share, bool overlap,
                              bool reversible, std::uint64_t seed) {
  Random random(seed);
  Polygons made;
  made.columns = columns, made.rows = rows;
  made.winding.assign(columns * rows, 0);
  made.cell_area = 2 * (7 * 11 + 2 * 3);
  std::vector<int> taken(columns * rows, 0);
  std::map<std::array<std::int64_t, 2>, std::uint32_t> numbers;
  auto number = [&](std::int64_t x, std::int64_t y) {
    const auto [found, fresh] = numbers.emplace(std::array<std::int64_t, 2>{x, y}, made.points.size());
    if (fresh) made.points.push_back(skewed(x, y));
    return found->second;
  };
  for (std::int64_t i = 0; overlap && i <= rows * (columns + 1) + columns; ++i)
    number(i % (columns + 1), i / (columns + 1));  // runs of two polygons may meet inside both
  for (int p = 0; p < count; ++p) {
    const bool reversed = reversible && random.below(2);
    const std::vector<int> in = choose_cells(made, taken, share, overlap, reversed, random);
    auto inside = [&](std::int64_t x, std::int64_t y) {
      return x >= 0 && y >= 0 && x < columns && y < rows && in[y * columns + x] != 0;
    };
    std::int64_t area = 0;
    auto border = [&](std::array<std::int64_t, 2> a, std::array<std::int64_t, 2> b) {
      if (reversed) std::swap(a, b);
      const auto s = skewed(a[0], a[1]), t = skewed(b[0], b[1]);
      area += std::int64_t{s[0]} * t[1] - std::int64_t{t[0]} * s[1];
      made.constraints.push_back({number(a[0], a[1]), number(b[0], b[1])});
    };
    // Runs of borders along a lattice line are one constraint, or several: vertices on them do not matter.
    auto runs = [&](std::int64_t lines, std::int64_t length, auto&& side, auto&& at) {
      for (std::int64_t line = 0; line <= lines; ++line)
        for (std::int64_t from = 0; from < length;) {
          const int s = side(line, from);
          std::int64_t to = from + 1;
          while (to < length && side(line, to) == s && random.below(4) != 0) ++to;
          if (s > 0) border(at(line, from), at(line, to));
          if (s < 0) border(at(line, to), at(line, from));
          from = to;
        }
    };
    runs(
        rows, columns, [&](std::int64_t y, std::int64_t x) { return int(inside(x, y)) - int(inside(x, y - 1)); },
        [](std::int64_t y, std::int64_t x) {
          return std::array<std::int64_t, 2>{x, y};
        });
    runs(
        columns, rows, [&](std::int64_t x, std::int64_t y) { return int(inside(x - 1, y)) - int(inside(x, y)); },
        [](std::int64_t x, std::int64_t y) {
          return std::array<std::int64_t, 2>{x, y};
        });
    made.shoelace.push_back(area);
  }
  shuffle(made.constraints, random);
  return made;
}

/// Twice the area of all triangles.
inline std::int64_t doubled_area(const std::vector<std::array<std::int32_t, 2>>& points, const Triangulation& mesh) {
  std::int64_t sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += (std::int64_t{points[b][0]} - points[a][0]) * (std::int64_t{points[c][1]} - points[a][1]) -
           (std::int64_t{points[b][1]} - points[a][1]) * (std::int64_t{points[c][0]} - points[a][0]);
  return sum;
}

}  // namespace gcdt::test
