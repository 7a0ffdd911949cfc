// SPDX-License-Identifier: Apache-2.0
// What rounding to the grid did to the vertices: how far they moved, and which became one.
#pragma once

#include <functional>
#include <vector>

#include "mesh/grid.hpp"
#include "mesh/mesh.hpp"

namespace gcdt {

struct InputPoints;

/// The vertices of one input that share their grid point with a vertex of a smaller number, but were given elsewhere.
struct RoundedTogether {
  std::uint64_t count = 0;
  std::array<std::uint32_t, 2> first{};  ///< [1]: the least of these vertices; [0]: the vertex that stands for it
};

/// Whether rounding may have made vertices one. If not, nobody needs the coordinates again.
inline bool may_round_together(const Grid& grid) {
  return (grid.kind == Grid::Kind::rounded || grid.kind == Grid::Kind::fixed) && grid.largest_move > 0;
}

/// For each problem; the inputs of problem p are first_input[p] to first_input[p + 1] - 1. Vertex numbers count within
/// the problem.
std::vector<RoundedTogether> rounded_together(runtime::Runtime& runtime, const InputPoints& points,
                                              const Vertices& vertices, const std::vector<cl_uint>& first_input);

/// The error for Options::distinct, which forbids that rounding makes vertices one.
Error together_error(const RoundedTogether& together);

/// The largest move of a coordinate. `key` is the greatest gcdt_move_key of all, and the result is its move_length().
/// If the key has no place for all digits, the move is computed exactly from the coordinates: bits_at(i) are the bits
/// of coordinate i = 2 * vertex + axis.
double largest_move(std::size_t vertices, const std::function<std::uint64_t(std::size_t)>& bits_at, std::uint64_t key,
                    const device::Scale& scale);

/// The same of the vertices first to end - 1 in device memory, which are read back if the coordinates are needed.
double largest_move(runtime::Runtime& runtime, const InputPoints& points, cl_uint first, cl_uint end, std::uint64_t key,
                    const device::Scale& scale);

/// Whether all vertices are on one line as they were given. Reads them back.
bool given_on_one_line(runtime::Runtime& runtime, const InputPoints& points);

}  // namespace gcdt
