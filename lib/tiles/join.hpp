// SPDX-License-Identifier: Apache-2.0
// The final triangles of the tiles and those of the seam as one result.
#pragma once

#include "tiles/seam.hpp"

namespace gcdt::tiles {

/// All that a problem's result is made of. Every part must outlive the joining.
struct Solved {
  const GridInput& input;
  const Partition& all;
  const std::vector<SolvedTile>& tiles;
  const Seam& seam;
  const SolvedSeam& between;
};

/// Makes room for one of a result's arrays.
template <class T>
T* room(ForestResult& result, std::int32_t array, std::size_t count) {
  const auto slot = static_cast<std::size_t>(array);
  result.begins[slot] = {0, count};
  return result.arrays[slot].make<T>(count);
}

template <class T>
Span<T> array_of(const ForestResult& result, std::int32_t array) {
  const auto slot = static_cast<std::size_t>(array);
  return {reinterpret_cast<const T*>(result.arrays[slot].bytes.get()),
          static_cast<std::size_t>(result.begins[slot].back())};
}

/// The arrays of the result in canonical order, as one device would have made them (docs/scale.md, T4), with their
/// counts in the statistics. `dropped`: ascending. With `check`, throws check_failed unless the mesh has as many
/// triangles as its vertices ask for, and is locally Delaunay at the border of the final triangles; what is on either
/// side, the calls have checked.
ForestResult join(const Solved& solved, const std::vector<std::uint32_t>& dropped, bool check);

}  // namespace gcdt::tiles
