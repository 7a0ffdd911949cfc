// SPDX-License-Identifier: Apache-2.0
#include "query/imported.hpp"

#include "mesh/phase.hpp"
#include "phases/check.hpp"

namespace gcdt {

using runtime::over;
using runtime::Runtime;

namespace {

Pieces order_pieces(Runtime& runtime, Primitives& primitives, const Vertices& vertices, Constraints constraints) {
  Pieces pieces;
  const auto count = static_cast<cl_uint>(constraints.size());
  pieces.count = count;
  pieces.ends = runtime.allocate<cl_uint2>("pieces", count);
  if (count == 0) return pieces;
  const auto inputs = static_cast<cl_uint>(vertices.input_vertex.size());
  const cl_uint bits = std::max(1u, bit_width(vertices.n()));
  const auto given = stage(runtime, constraints);
  auto keys = runtime.allocate<cl_ulong>("keys of pieces", count);
  auto numbers = runtime.allocate<cl_uint>("numbers of pieces", count);
  auto bad = runtime.filled<cl_uint>("bad pieces", 2, GCDT_NONE);
  runtime.launch("imported", "piece_keys", over(count), count, inputs, bits, vertices.levels_buffer, given,
                 vertices.input_vertex, keys, numbers, bad);
  const cl_uint wrong = runtime.read_one(bad);
  if (wrong != GCDT_NONE) {
    const Constraint& c = constraints[wrong];
    const std::string name = "constraint " + std::to_string(wrong);
    for (std::uint64_t end = 0; end < 2; ++end)
      if (c[end] >= inputs) throw Error(Status::index_out_of_range, name + ": an end is no vertex", {wrong, end});
    throw Error(Status::invalid_argument, name + " has both ends at one place", {wrong});
  }
  primitives.sort(keys, numbers, count, 2 * bits);
  runtime.launch("imported", "piece_ends", over(count), count, bits, vertices.levels_buffer, keys, numbers, pieces.ends,
                 bad);
  const cl_uint twice = runtime.read_one(bad);
  if (twice != GCDT_NONE)
    throw Error(Status::invalid_argument, "constraint " + std::to_string(twice) + " is given twice", {twice});
  return pieces;
}

}  // namespace

void check_imported(Runtime& runtime, Primitives& primitives, Points points, Constraints constraints,
                    const MeshView& mesh, const std::optional<FixedGrid>& grid) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const Vertices vertices =
      order(runtime, primitives, make_plan(runtime, {1, n, n}), stage(runtime, points), grid).vertices;
  const Pieces pieces = order_pieces(runtime, primitives, vertices, constraints);
  primitives.release();
  const OrderedMesh ordered = make_ordered(runtime, mesh.triangles.size());
  const std::size_t corners = std::size_t{3} * ordered.triangles;
  if (corners != 0) {
    runtime.write(ordered.corners, mesh.triangles.data()->data(), corners);
    runtime.write(ordered.neighbours, mesh.neighbours->data(), corners);
    runtime.write(ordered.constrained, mesh.constrained, ordered.triangles);
    runtime.launch("imported", "corners_to_vertices", over(corners), static_cast<cl_uint>(corners),
                   static_cast<cl_uint>(vertices.input_vertex.size()), vertices.input_vertex, vertices.vertex_input,
                   ordered.corners);
  }
  check(runtime, make_plan(runtime, vertices), ordered, vertices, pieces);
}

}  // namespace gcdt
