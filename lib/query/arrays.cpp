// SPDX-License-Identifier: Apache-2.0
#include "query/arrays.hpp"

#include <iterator>

namespace gcdt {

namespace {

constexpr bool ascending() {
  for (std::size_t i = 1; i < std::size(result_arrays); ++i)
    if (result_arrays[i - 1].number >= result_arrays[i].number) return false;
  return true;
}
static_assert(ascending(), "the rows of gcdt/arrays.def are in the order of their numbers");

}  // namespace

const ResultArray* result_array(std::int32_t number) {
  const auto* found = std::lower_bound(std::begin(result_arrays), std::end(result_arrays), number,
                                       [](const ResultArray& array, std::int32_t n) { return array.number < n; });
  return found != std::end(result_arrays) && found->number == number ? found : nullptr;
}

bool has(const DeviceTriangulation& made, const ResultArray& array) {
  if (array.there == There::with_origins) return made.added.origins.allocated();
  return array.there != There::with_regions || made.regions.region.allocated();
}

std::uint64_t elements(const DeviceTriangulation& made, const ResultArray& array) {
  if (!has(made, array)) return 0;
  switch (array.per) {
    case Per::triangle: return made.mesh.triangles;
    case Per::vertex: return made.representatives.size();
    case Per::piece: return made.pieces.count;
    case Per::piece_bound: return std::uint64_t{made.pieces.count} + 1;
    case Per::source: return made.pieces.source_count;
    case Per::dropped: return made.dropped.size();
    case Per::added: return made.added.count;
    case Per::hull_vertex: return hull_count(made);
  }
  return 0;
}

}  // namespace gcdt
