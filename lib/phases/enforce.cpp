// SPDX-License-Identifier: Apache-2.0
#include "phases/enforce.hpp"

#include "phases/clean.hpp"

namespace gcdt {

using runtime::over;
using runtime::over_large;

EnforceResult enforce_problems(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices, Mesh& mesh,
                               const runtime::Buffer<cl_uint>& first_constraint,
                               const runtime::Buffer<cl_uint2>& constraints, bool past_crossings,
                               PhaseCounters& counters) {
  const cl_uint problems = vertices.roots, given = cl_uint(constraints.size());
  counters.zero();
  EnforceResult result;
  auto vertex_face = runtime.allocate<cl_uint>("faces of vertices", mesh.n);
  auto offsets = runtime.allocate<cl_uint>("pieces of constraints", std::size_t{given} + 1);
  auto crosses = runtime.allocate<cl_uint>("crossing constraints", given);
  {
    auto crossed = runtime.allocate<cl_uint4>("crossed faces", mesh.faces());
    auto stack = runtime.allocate<cl_uint4>("stacks of chains", mesh.faces());
    runtime.launch("enforce", "enforce_problems", over_large(problems), problems,
                   static_cast<cl_uint>(vertices.input_vertex.size()), cl_uint{past_crossings}, mesh.n, vertices.points,
                   mesh.face_data, mesh.edge_faces, first_constraint, constraints, vertices.input_vertex,
                   mesh.edge_marks, vertex_face, crossed, stack, offsets, crosses, counters.buffer());
  }
  const device::Counters c = counters.read();
  if (c.failed & GCDT_FAILED_WALK)
    throw Error(Status::check_failed, "enforce: a walk along a constraint left the mesh");
  result.wrong_index = (c.failed & GCDT_FAILED_INDEX) != 0;
  if (result.wrong_index) return result;
  if (c.failed & GCDT_FAILED_CROSSING) {
    result.crosses.resize(given);
    runtime.read(crosses, result.crosses.data(), given);
  }
  result.zero_length = c.zero_length;
  result.hits = c.hits;
  result.existing_edges = c.existing_edges;
  result.chain_vertices = c.owned_left;
  result.crossed_pairs = wide(c.pairs_low, c.pairs_high);
  result.flips = wide(c.flips_low, c.flips_high);

  // Where none is left out, each constraint of a length is a piece and one more for each vertex on it: no wait to know.
  const bool all = c.failed == 0;
  if (all) primitives.exclusive_scan(offsets, offsets, given);
  const cl_uint count = all ? given - c.zero_length + c.hits : primitives.scan_total(offsets, given);
  auto keys = runtime.allocate<cl_ulong>("keys of pieces", count);
  auto sources = runtime.allocate<cl_uint>("sources of pieces", count);
  {
    auto places = runtime.allocate<cl_uint>("places of pieces", mesh.n);
    auto unsorted_keys = runtime.allocate<cl_ulong>("unsorted keys of pieces", count);
    auto unsorted_sources = runtime.allocate<cl_uint>("unsorted sources of pieces", count);
    runtime.launch("enforce", "enforce_pieces", over_large(problems), problems, vertices.levels_buffer, mesh.n,
                   vertices.points, mesh.face_data, mesh.edge_faces, first_constraint, constraints,
                   vertices.input_vertex, vertex_face, offsets, places, unsorted_keys, unsorted_sources, keys, sources);
  }
  auto firsts = runtime.allocate<cl_uint>("first pieces", std::size_t{count} + 1);
  runtime.launch("order", "mark_first", over(count), count, keys, firsts);
  Pieces& pieces = result.pieces;
  pieces = merge_runs(runtime, primitives, firsts, count);
  pieces.ends = runtime.allocate<cl_uint2>("pieces", pieces.count);
  runtime.launch("enforce", "enforce_ends", over(pieces.count), pieces.count, vertices.levels_buffer, keys,
                 pieces.source_offsets, pieces.ends);
  pieces.sources = std::move(sources);
  return result;
}

}  // namespace gcdt
