// SPDX-License-Identifier: Apache-2.0
// The arrays of a result (gcdt/arrays.def) as the library knows them: how many elements of what, and where.
#pragma once

#include "query/derived.hpp"

namespace gcdt {

/// What an array has one element for. `piece_bound`: where each piece's sources begin, and where the last one's end.
enum class Per { triangle, vertex, piece, piece_bound, source, dropped, added, hull_vertex };

/// Which results have an array. `with_added`: those of one problem, though often without elements. `with_origins`: of
/// these the refined ones.
enum class There { always, with_added, with_origins, with_regions, on_demand };

struct ResultArray {
  std::int32_t number;  ///< GCDT_TRIANGLES ...
  const char* name;
  std::size_t element_bytes;
  Per per;
  There there;
  runtime::Memory (*memory)(const DeviceTriangulation& made);  ///< null on demand
  runtime::Memory (*derive)(runtime::Runtime& runtime, Primitives& primitives, Derived& derived,
                            const DeviceTriangulation& made);  ///< makes it if it is not there; null unless on demand
};

// clang-format off
#define GCDT_ARRAY(number, name, type, width, per, there, buffer)                                     \
  ResultArray{number, #name, sizeof(type) * width, Per::per, There::there,                            \
              [](const DeviceTriangulation& made) { return (buffer).memory(); }, nullptr},
#define GCDT_DERIVED_ARRAY(number, name, type, width, per, buffer)                                    \
  ResultArray{number, #name, sizeof(type) * width, Per::per, There::on_demand, nullptr,               \
              []([[maybe_unused]] runtime::Runtime& runtime, [[maybe_unused]] Primitives& primitives, \
                 Derived& derived, const DeviceTriangulation& made) { return (buffer).memory(); }},
/// All, by ascending numbers.
inline constexpr ResultArray result_arrays[] = {
#include <gcdt/arrays.def>
};
// clang-format on

/// A slot for each number of an array that is not made on demand.
inline constexpr std::size_t array_slots = [] {
  std::int32_t most = 0;
  for (const ResultArray& array : result_arrays)
    if (array.there != There::on_demand && array.number > most) most = array.number;
  return static_cast<std::size_t>(most) + 1;
}();

/// Null if no array has the number.
const ResultArray* result_array(std::int32_t number);

/// Whether the result has it, or can make it on demand.
bool has(const DeviceTriangulation& made, const ResultArray& array);

/// Its elements; 0 if the result does not have it.
std::uint64_t elements(const DeviceTriangulation& made, const ResultArray& array);

}  // namespace gcdt
