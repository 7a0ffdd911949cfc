// SPDX-License-Identifier: Apache-2.0
#include "batch/single.hpp"

#include "solve/triangulate.hpp"

namespace gcdt {

using runtime::Runtime;

namespace {

/// Copies the arrays that the call left on the device.
void copy_single(Runtime& runtime, const DeviceTriangulation& made, ForestResult& result) {
  for (const ResultArray& array : result_arrays) {
    if (array.there == There::on_demand || !has(made, array)) continue;
    const auto slot = static_cast<std::size_t>(array.number);
    const std::uint64_t count = elements(made, array);
    const auto bytes = static_cast<std::size_t>(count) * array.element_bytes;
    result.begins[slot] = {0, count};
    runtime.read_bytes(array.memory(made), 0, result.arrays[slot].make<unsigned char>(bytes), bytes);
  }
  if (!made.routed.allocated()) return;
  std::vector<cl_uint> marks(made.routed.size());
  runtime.read(made.routed, marks.data(), marks.size());
  for (std::uint32_t c = 0; c < marks.size(); ++c)
    if (marks[c] != 0) result.routed.push_back(c);
}

}  // namespace

ForestResult triangulate_single(Runtime& runtime, Primitives& primitives, const BatchInput& batch, std::uint32_t number,
                                const Options& options) {
  Options own = options;
  own.canonical = true;
  if (own.refine && !own.refine->sizes.empty())
    own.refine->sizes = {own.refine->sizes.data() + batch.vertex_offsets[number],
                         static_cast<std::size_t>(batch.n(number))};
  const Points points = part_of(batch.type, batch.vertices, static_cast<std::size_t>(batch.vertex_offsets[number]),
                                static_cast<std::size_t>(batch.n(number)));
  const Constraints constraints = {batch.constraints + batch.constraint_offsets[number],
                                   static_cast<std::size_t>(batch.m(number))};
  runtime.memory().begin_call();
  const DeviceTriangulation made = triangulate(runtime, primitives, source_of(runtime, points, constraints), own);
  ForestResult result;
  runtime.tracer().begin_phase("copy");
  copy_single(runtime, made, result);
  runtime.tracer().end_phase();
  result.problems = {number};
  result.grids = {made.statistics.grid};
  result.together = {{made.statistics.vertices_rounded_together, made.statistics.rounded_pair}};
  result.statistics = made.statistics;
  return result;
}

}  // namespace gcdt
