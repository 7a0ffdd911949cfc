// SPDX-License-Identifier: Apache-2.0
#include "phases/locate.hpp"

#include <algorithm>
#include <array>

#include "mesh/grid.hpp"
#include "query/locate.h"

namespace gcdt {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

struct Queries {
  cl_uint count;
  Buffer<cl_ulong> keys;
  Buffer<cl_uint> numbers;
  unsigned bits = 0;  ///< of the keys, on which they may differ
};

// Queries of one cell of the curve that walk in any order, about: what they go through is small enough for a cache.
constexpr std::uint32_t queries_of_cell = 32;

/// Of a query with such a coordinate.
Error not_placed(cl_uint type, std::uint64_t coordinate) {
  const bool whole = type == GCDT_COORDINATES_INT64;
  return Error(whole ? Status::coordinate_outside_grid : Status::coordinate_not_finite,
               std::string(coordinate % 2 ? "y" : "x") + " of point " + std::to_string(coordinate / 2) +
                   (whole ? " is beyond 2^53" : " is not a finite number"),
               {coordinate / 2, coordinate % 2});
}

Queries place(Runtime& runtime, const Vertices& vertices, const InputPoints& points, std::uint64_t first) {
  Queries queries = {points.n, runtime.allocate<cl_ulong>("keys of queries", points.n),
                     runtime.allocate<cl_uint>("numbers of queries", points.n)};
  const cl_uint by_decimals = vertices.decimals.has_value();
  const auto scale = runtime.upload_one("scale", scale_of(vertices.grid));
  const auto decimals = runtime.upload_one("decimals", query_decimals(vertices.grid, vertices.decimals));
  auto found = runtime.filled<cl_uint>("bad and least queries", 3, GCDT_NONE);
  runtime.launch("locate", "place_queries", over(points.n), points.n, points.type, points.coordinates, by_decimals,
                 scale, decimals, queries.keys, queries.numbers, found);
  std::array<cl_uint, 3> words;
  runtime.read(found, words.data(), words.size());
  if (words[0] != GCDT_NONE) throw not_placed(points.type, 2 * first + words[0]);
  queries.bits = GCDT_MORTON_BITS - 32 + bit_width(words[1] ^ ~words[2]);
  return queries;
}

// By the highest bits that differ. Results do not depend on the order.
void put_in_order(Primitives& primitives, Queries& queries) {
  const unsigned cells = bit_width(queries.count / queries_of_cell);
  primitives.sort_high(queries.keys, queries.numbers, queries.count, queries.bits, std::min(queries.bits, cells));
  primitives.release();
}

void find_fans(Runtime& runtime, Primitives& primitives, const SearchMesh& mesh) {
  PhaseCounters counters(runtime);
  counters.zero();
  Fans fans = make_result_fans(runtime, primitives, mesh.vertices, mesh.all, mesh.by_input, counters);
  if (counters.read().failed) throw Error(Status::check_failed, "locate: triangles around a vertex form no fan");
  mesh.fans = std::move(fans);
  primitives.release();
}

void walk(Runtime& runtime, Primitives& primitives, const SearchMesh& mesh, const Queries& queries,
          const Located& located) {
  auto places = runtime.allocate<cl_uint>("places of queries", queries.count);
  auto pending = runtime.allocate<cl_uint>("queries on their way", 1);
  const Buffer<cl_int> none = runtime.allocate<cl_int>("no selection", 0);
  if (!mesh.fans.begins.allocated()) mesh.fans = no_fans(runtime);
  // A straight way has at most as many triangles as there are; a walk that also turns back is given sixteen
  // times that.
  const std::uint64_t limit = 16 + 16ull * mesh.all.triangles / GCDT_LOCATE_STEPS;
  cl_uint begun = 0;
  for (std::uint64_t round = 0; round < limit; ++round, begun += GCDT_LOCATE_STEPS) {
    runtime.fill<cl_uint>(pending, 0, 1);
    runtime.launch("locate", "locate_walk", over(queries.count), queries.count, begun, mesh.all.corners,
                   mesh.all.neighbours, cl_uint{mesh.by_input}, mesh.vertices.input_vertex, mesh.vertices.n(),
                   mesh.vertices.points, cl_uint{mesh.fans.made}, mesh.fans.begins, mesh.fans.faces,
                   mesh.vertices.levels_buffer, queries.keys, queries.numbers, mesh.starts,
                   cl_uint{mesh.kept != nullptr}, mesh.kept ? *mesh.kept : none, mesh.result.corners, mesh.least,
                   places, located.triangles, located.corners, located.areas, pending);
    if (runtime.read_one(pending) == 0) return;
    if (!mesh.fans.made) find_fans(runtime, primitives, mesh);
  }
  throw Error(Status::round_limit, "locate: queries have not arrived after the limit of rounds");
}

}  // namespace

Buffer<cl_uint> least_triangles(Runtime& runtime, const Vertices& vertices, const OrderedMesh& mesh, bool by_input) {
  auto least = runtime.filled<cl_uint>("least triangles", vertices.n(), GCDT_NONE);
  if (mesh.triangles != 0)
    runtime.launch("locate", "least_triangles", over(mesh.triangles), cl_uint{mesh.triangles}, cl_uint{by_input},
                   vertices.input_vertex, mesh.corners, least);
  return least;
}

Buffer<cl_int> least_triangles_by_input(Runtime& runtime, const Vertices& vertices, const Buffer<cl_uint>& least) {
  const auto inputs = static_cast<cl_uint>(vertices.input_vertex.size());
  auto triangles = runtime.allocate<cl_int>("triangles of vertices", inputs);
  if (inputs != 0)
    runtime.launch("locate", "number_least", over(inputs), inputs, vertices.input_vertex, least, triangles);
  return triangles;
}

Located locate(Runtime& runtime, Primitives& primitives, const SearchMesh& mesh, const InputPoints& points,
               std::uint64_t first) {
  Located located = {runtime.allocate<cl_int>("triangles of queries", points.n),
                     runtime.allocate<cl_uint>("corners of queries", std::size_t{3} * points.n),
                     runtime.allocate<cl_long>("areas of queries", std::size_t{3} * points.n)};
  if (points.n == 0) return located;
  Queries queries = place(runtime, mesh.vertices, points, first);
  if (mesh.all.triangles == 0) {
    runtime.fill<cl_int>(located.triangles, -1, points.n);
    runtime.fill<cl_uint>(located.corners, 0, std::size_t{3} * points.n);
    runtime.fill<cl_long>(located.areas, 0, std::size_t{3} * points.n);
    return located;
  }
  put_in_order(primitives, queries);
  walk(runtime, primitives, mesh, queries, located);
  return located;
}

}  // namespace gcdt
