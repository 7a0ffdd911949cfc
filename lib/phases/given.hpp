// SPDX-License-Identifier: Apache-2.0
// What rounding to the grid did to the vertices as they were given.
#pragma once

#include <vector>

#include "mesh/grid.hpp"
#include "mesh/mesh.hpp"

namespace gcdt {

struct InputPoints;

/// Vertices of one input that are one on the grid with a lesser one that was given elsewhere.
struct RoundedTogether {
  std::uint64_t count = 0;
  std::array<std::uint32_t, 2> first{};  ///< the least of them, behind the one that stands for it
};

/// Whether rounding may have made vertices one: only then are the coordinates needed again.
inline bool may_round_together(const Grid& grid) {
  return (grid.kind == Grid::Kind::rounded || grid.kind == Grid::Kind::fixed) && grid.largest_move > 0;
}

/// Of each problem, whose inputs begin at first_input (one more element: their number); numbers count in the problem.
std::vector<RoundedTogether> rounded_together(runtime::Runtime& runtime, const InputPoints& points,
                                              const Vertices& vertices, const std::vector<cl_uint>& first_input);

/// What is wrong with them, if vertices that differ must stay apart.
Error together_error(const RoundedTogether& together);

/// The largest move of the coordinates of vertices first to end - 1, whose greatest key is `key` (gcdt_move_key): as
/// move_length() of that; but where the key had no place for all of its digits, exactly, which reads the coordinates
/// back.
double largest_move(runtime::Runtime& runtime, const InputPoints& points, cl_uint first, cl_uint end, std::uint64_t key,
                    const device::Scale& scale);

/// Whether all vertices, as given, are on one line. Reads them back.
bool given_on_one_line(runtime::Runtime& runtime, const InputPoints& points);

}  // namespace gcdt
