// SPDX-License-Identifier: Apache-2.0
// The whole input as the host sees it: vertices go to their common grid when they are asked for, one by one.
#pragma once

#include <optional>
#include <vector>

#include "common/levels.h"
#include "common/predicates.h"
#include "mesh/grid.hpp"

namespace gcdt::tiles {

/// A vertex on the grid; both are in [0, 2^31 - 1].
using GridPoint = std::array<std::int32_t, 2>;
using GridPoints = Array<GridPoint>;

/// A box of grid points, its border included.
struct Box {
  std::array<std::int64_t, 2> least, most;
};

/// The Morton code of a grid point, by which the Z-order goes.
inline std::uint64_t code_of(const GridPoint& p) {
  return device::gcdt_morton(static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]));
}

inline GridPoint point_of(std::uint64_t code) {
  return {static_cast<std::int32_t>(device::gcdt_gather_bits(code)),
          static_cast<std::int32_t>(device::gcdt_gather_bits(code >> 1))};
}

inline device::Vertex vertex_at(const GridPoint& p) { return device::gcdt_finite_vertex(p[0], p[1]); }
/// Twice the signed area of (a, b, c): > 0 counter-clockwise.
inline std::int64_t orient2d(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return device::gcdt_orient2d_finite(vertex_at(a), vertex_at(b), vertex_at(c));
}

/// Which vertices of the input a process has. Numbers are input numbers.
struct GivenVertices {
  Points points;
  std::uint64_t first = 0;        ///< the number of the first one, if they follow each other
  Span<std::uint32_t> numbers{};  ///< else of each, ascending
  std::uint64_t count = 0;        ///< of all processes together

  /// The place of a vertex among `points`. Throws check_failed if it is not there.
  std::size_t place_of(std::uint64_t vertex) const;
  [[noreturn]] static void throw_absent();
};

/// Which constraints of the input a process has.
struct GivenConstraints {
  Constraints ends;
  std::uint64_t first = 0;                       ///< the number of the first one, if they follow each other
  Array<std::uint32_t> numbers{};                ///< else of each, ascending; links of one constraint have its number
  std::uint64_t count = 0;                       ///< of all processes together
  Array<std::array<GridPoint, 2>> end_points{};  ///< empty: the process has all vertices

  std::size_t size() const { return ends.size(); }
  std::uint32_t number_of(std::size_t c) const {
    return numbers.empty() ? static_cast<std::uint32_t>(first + c) : numbers[c];
  }
};

/// One planar straight-line graph, or what a process has of one. The arrays are the caller's.
struct GridInput {
  GivenVertices given;
  ChosenGrid chosen;
  GridPoints added;  ///< vertices behind those given, on the grid already; every process has all
  GivenConstraints constraints;
  Box box{};  ///< around all vertices, if there are any

  /// Of all processes.
  std::uint64_t n() const { return given.count + added.size(); }
  /// A vertex that the process has, by its number; throws check_failed if it has none such.
  GridPoint at(std::uint64_t vertex) const {
    if (vertex < given.count) return at_place(given.place_of(vertex));
    if (vertex >= n()) GivenVertices::throw_absent();
    return added[vertex - given.count];
  }
  /// The vertex at a place among those given.
  GridPoint at_place(std::size_t place) const;
  GridPoint end_of(std::size_t constraint, std::size_t end) const {
    return constraints.end_points.empty() ? at(constraints.ends[constraint][end])
                                          : constraints.end_points[constraint][end];
  }
};

/// A box of coordinates as they are given: of the bits of doubles, gcdt_ordered().
struct KeyBox {
  std::array<std::uint64_t, 2> least, most;
};
/// Has all coordinates that are placed in the box, and on a grid that is not decimal no others.
KeyBox keys_of(const ChosenGrid& chosen, const Box& box);

/// Where a point that is no vertex is on the grid: as locate() has it. None if it is outside.
std::optional<GridPoint> place_query(const ChosenGrid& chosen, const std::array<double, 2>& point);

/// Whether one of a few vertices has a coordinate that cannot be written with so many decimals: of measured or random
/// numbers nearly each, and nobody has to look at the others.
bool some_need_more(const Points& points, int decimals);

/// The box around vertices on a grid, if there are any.
Box box_of(const ChosenGrid& chosen, const Survey& surveyed);

/// Whether a vertex of all that were surveyed is outside the grid.
bool some_outside(const ChosenGrid& chosen, const Survey& surveyed);
/// What check_outside() takes: 0, or for the least coordinate outside the grid the complement of its number.
std::uint64_t outside_of(const GridInput& input);

/// The largest move of a coordinate that the process has; `key` is the greatest gcdt_move_key of all.
double move_of(const GridInput& input, std::uint64_t key);

}  // namespace gcdt::tiles
