// SPDX-License-Identifier: Apache-2.0
#include "query/adopt.hpp"

#include <algorithm>

#include "query/derived.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

std::string named(const Constraint& edge) { return std::to_string(edge[0]) + "-" + std::to_string(edge[1]); }

[[noreturn]] void refuse(std::uint64_t triangle, const char* why, const Grid& grid) {
  const bool rounded = grid.largest_move > 0;
  throw Error(Status::check_failed,
              "triangle " + std::to_string(triangle) + " of the mesh " + why +
                  (rounded ? "; the coordinates were rounded to a grid, which can turn thin triangles over" : ""),
              {triangle});
}

/// The pieces with a source below `limit`, and those sources only.
Pieces kept_pieces(Runtime& runtime, Primitives& primitives, const Pieces& all, std::uint32_t limit) {
  const cl_uint count = all.count;
  auto places = runtime.allocate<cl_uint>("places of pieces", std::size_t{count} + 1);
  auto first_sources = runtime.allocate<cl_uint>("first sources", std::size_t{count} + 1);
  if (count != 0)
    runtime.launch("adopt", "count_sources", over(count), count, cl_uint{limit}, all.source_offsets, all.sources,
                   places, first_sources);
  Pieces kept;
  kept.count = primitives.scan_total(places, count);
  kept.source_count = primitives.scan_total(first_sources, count);
  kept.ends = runtime.allocate<cl_uint2>("pieces", kept.count);
  kept.source_offsets = runtime.allocate<cl_uint>("source offsets", std::size_t{kept.count} + 1);
  kept.sources = runtime.allocate<cl_uint>("sources of pieces", kept.source_count);
  if (kept.count != 0)
    runtime.launch("adopt", "keep_pieces", over(count), count, places, first_sources, all.ends, all.source_offsets,
                   all.sources, kept.ends, kept.source_offsets, kept.sources);
  runtime.fill<cl_uint>(kept.source_offsets, kept.source_count, 1, kept.count);
  primitives.release();
  return kept;
}

/// The triangle of `whole` for each of `mesh`; `taken` is set to the reverse, -1 where there is none.
Buffer<cl_uint> find(Runtime& runtime, const DeviceTriangulation& whole, const OrderedMesh& mesh,
                     Buffer<cl_int>& taken) {
  auto found = runtime.allocate<cl_uint>("triangles found", mesh.triangles);
  auto faults = runtime.filled<cl_uint>("faulty triangles", 3, GCDT_NONE);
  taken = runtime.filled<cl_int>("places of triangles", whole.mesh.triangles, -1);
  if (mesh.triangles == 0) return found;
  runtime.launch("adopt", "find_triangles", over(mesh.triangles), cl_uint{mesh.triangles}, whole.vertices.levels_buffer,
                 whole.vertices.points, whole.vertices.input_vertex, mesh.corners, cl_uint{whole.mesh.triangles},
                 whole.mesh.corners, found, taken, faults);
  cl_uint fault[2];
  runtime.read(faults, fault, 2);
  if (fault[0] != GCDT_NONE) refuse(fault[0], "is not counter-clockwise on the grid", whole.vertices.grid);
  if (fault[1] != GCDT_NONE)
    refuse(fault[1], "overlaps others, or has a vertex inside it or inside an edge", whole.vertices.grid);
  auto twice = runtime.filled<cl_uint>("repeated triangle", 1, GCDT_NONE);
  runtime.launch("adopt", "find_repeated", over(mesh.triangles), cl_uint{mesh.triangles}, found, taken, twice);
  if (const cl_uint repeated = runtime.read_one(twice); repeated != GCDT_NONE)
    refuse(repeated, "has the corners of an earlier one", whole.vertices.grid);
  return found;
}

}  // namespace

std::vector<Constraint> edges_of(Triangles triangles, std::uint64_t vertices) {
  std::vector<Constraint> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint64_t t = 0; t < triangles.size(); ++t)
    for (std::uint64_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a >= vertices)
        throw Error(Status::invalid_argument,
                    "triangle " + std::to_string(t) + ": corner " + std::to_string(a) + " is no vertex; there are " +
                        std::to_string(vertices),
                    {t, k});
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

Error mesh_error(const Error& crossing, Constraints constraints, Span<Constraint> edges) {
  if (crossing.status() != Status::constraints_cross) return crossing;
  const std::uint64_t a = crossing.indices().at(0), b = crossing.indices().at(1);
  auto edge = [&](std::uint64_t c) { return edges[c - constraints.size()]; };
  if (b < constraints.size())
    return Error(Status::constraints_cross,
                 "constraints " + std::to_string(a) + " (" + named(constraints[a]) + ") and " + std::to_string(b) +
                     " (" + named(constraints[b]) + ") cross",
                 {a, b}, crossing.pair_count());
  const bool own = a < constraints.size();
  return Error(Status::check_failed,
               (own ? "constraint " + std::to_string(a) + " (" + named(constraints[a]) + ") crosses edge "
                    : "edges " + named(edge(a)) + " and ") +
                   named(edge(b)) + (own ? " of the mesh" : " of the mesh cross"),
               own ? std::vector<std::uint64_t>{a} : std::vector<std::uint64_t>{});
}

DeviceTriangulation adopt(Runtime& runtime, Primitives& primitives, DeviceTriangulation whole, Triangles triangles,
                          std::uint32_t constraints) {
  OrderedMesh mesh = make_ordered(runtime, triangles.size());
  if (mesh.triangles != 0) runtime.write(mesh.corners, triangles.data()->data(), std::size_t{3} * mesh.triangles);
  const Buffer<cl_uint> found = find(runtime, whole, mesh, whole.kept);
  const Vertices& vertices = whole.vertices;
  const Pieces& all = whole.pieces;
  const Buffer<cl_uint2> ends = ends_as_vertices(runtime, vertices, all);
  if (mesh.triangles != 0)
    runtime.launch("adopt", "link_triangles", over(mesh.triangles), cl_uint{mesh.triangles}, vertices.levels_buffer,
                   vertices.vertex_input, vertices.input_vertex, found, whole.kept, whole.mesh.corners,
                   whole.mesh.neighbours, cl_uint{all.count}, ends, all.source_offsets, all.sources,
                   cl_uint{constraints}, mesh.corners, mesh.neighbours, mesh.constrained);
  whole.pieces = kept_pieces(runtime, primitives, all, constraints);
  runtime.finish();
  Statistics& s = whole.statistics;
  s.m = constraints;
  s.triangles = mesh.triangles;
  s.triangles_removed = whole.mesh.triangles - mesh.triangles;
  s.constraints_pieces = whole.pieces.count;
  s.constraints_overlapping = whole.pieces.source_count - whole.pieces.count;
  whole.hull = std::move(whole.mesh);
  whole.mesh = std::move(mesh);
  whole.adopted = true;
  return whole;
}

}  // namespace gcdt
