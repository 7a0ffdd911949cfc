// SPDX-License-Identifier: Apache-2.0
// gcdt_required_bytes: the device bytes of each step, added up from what its source allocates.
#include <algorithm>

#include "mesh.hpp"

namespace gcdt {

namespace {

// Counters, levels, tables of primitives (256 or 16 counters a part), parts beyond one per constraint, those of
// cleaning and those of enforcement, with a chunk each: everything that does not grow with the input.
constexpr std::uint64_t constant_bytes = 32u << 20;

// Buffers lie in one piece of memory (device_memory.hpp), with gaps between them that none fits in. Measured
// over all generators of tests/workloads.hpp: below an eighth of the most that is in use.
constexpr std::uint64_t gaps_share = 8;
// A multiple of every alignment.
constexpr std::uint64_t page = 4096;

struct Sizes {
  std::uint64_t n, m, faces, edges, crossed_faces;
};

std::uint64_t vertex_bytes(const Sizes& s) { return (8 + 4 + 4) * s.n; }              // points, both maps
std::uint64_t mesh_bytes(const Sizes& s) { return 2 * 16 * s.faces + 12 * s.edges; }  // corners, sides; faces, marks
std::uint64_t list_bytes(const Sizes& s) { return 8 * s.edges; }
// Top layer (a quarter of the vertices) and nodes (three quarters); small inputs have one level. With constraints, on a
// CPU, all is top layer (freeze_all).
std::uint64_t history_bytes(const Sizes& s) {
  if (s.m > 0) return 32 * (2 * s.n + 3) + 4 * s.n;
  return 32 * (s.n / 2 + 3) + 4 * (s.n / 4 + 1) + 20 * (s.n * 3 / 4 + 256);
}
// Ends, first sources, sources.
std::uint64_t piece_bytes(const Sizes& s) { return (8 + 4 + 4) * s.m; }
// Of constraints until they are edges: input, pieces, what cleaning says of these (weights, parts, first faces), and
// what the sorts keep (other halves of both kinds of keys, and of values).
std::uint64_t cleaned_bytes(const Sizes& s) { return 8 * s.m + piece_bytes(s) + (4 + 8 + 4) * s.m + (8 + 4 + 4) * s.m; }

// Coordinates, Morton codes and numbers, and the other halves of the sort.
std::uint64_t order_step(const Sizes& s) { return (16 + 2 * 12 + 4 + 16) * s.n; }

std::uint64_t insert_step(const Sizes& s) { return vertex_bytes(s) + mesh_bytes(s) + list_bytes(s) + history_bytes(s); }

// Beside what stays: of constraints list, ends and places, first parts, hits of parts, faces crossed and parts of whole
// ones; keys of pieces, where those of a constraint begin, and which are the first of equal ones.
std::uint64_t clean_step(const Sizes& s) {
  return insert_step(s) + cleaned_bytes(s) + (4 + 8 + 4 + 4 + 4 + 4 + 8 + 8 + 4 + 4) * s.m;
}

// Chunks of owned vertices, 80 bytes each: one an eighth of a crossed face, and one a part.
std::uint64_t chunk_bytes(const Sizes& s) { return 10 * s.crossed_faces + 80 * s.m; }

// From the walk to the stitching: the nearest piece at both ends of each edge, in place of the work lists; lists of
// crossed faces and edges; of pieces lines, edges and last sides, of parts beginnings, pieces, faces and two starts.
std::uint64_t crossed_step(const Sizes& s) {
  return vertex_bytes(s) + mesh_bytes(s) + cleaned_bytes(s) + 8 * s.edges + 4 * (s.faces + s.edges) +
         (16 + 4 + 8 + 4 + 4 + 4 + 8) * s.m;
}

// A crossed face owns a vertex or is a hexagon: face and farthest cuts.
std::uint64_t walk_step(const Sizes& s) {
  return crossed_step(s) + history_bytes(s) + chunk_bytes(s) + 16 * s.crossed_faces;
}

// After the last walk the history is gone. An entry of a chain, one for each owned vertex and four a piece, holds 20
// bytes; a hexagon 12 more: its corners.
std::uint64_t chain_bytes(const Sizes& s) { return 28 * s.crossed_faces + 20 * 4 * s.m; }
std::uint64_t chain_step(const Sizes& s) { return crossed_step(s) + chain_bytes(s) + chunk_bytes(s); }

// Without the chunks. Minima hold 8/15 of a word an entry, the table 12 bytes a slot, 3/2 slots an entry: three a
// crossed face less one a crossed edge. Crossed faces c and edges e: a crossed face has a crossed edge, which two
// share, so e >= c/2; and the faces of a piece are a path along crossed edges, so these join all crossed faces to at
// most as many components as there are pieces: e >= c - m. (Where the pieces' roots are made, the nearest pieces are
// gone.)
std::uint64_t stitch_step(const Sizes& s) {
  const std::uint64_t entries = std::min(5 * s.crossed_faces / 2 + 1, 2 * s.crossed_faces + s.m);
  return crossed_step(s) + chain_bytes(s) + 8 * (s.crossed_faces + 4 * s.m) / 15 + 18 * entries;
}

// Keys and face references with the other halves of their sort, buckets and long runs; then the result and positions.
std::uint64_t output_step(const Sizes& s) {
  const std::uint64_t sorting = 24 * s.faces + 4 * s.n + s.faces / 8, gathered = (12 + 12 + 1 + 4 + 4) * s.faces;
  return vertex_bytes(s) + mesh_bytes(s) + piece_bytes(s) + std::max(sorting, gathered);
}

// With a domain. Labels and their scan, or the places of arcs (three a face); then arcs, at most two a piece, with
// the other half of their sort, and six words a region; or the kept triangles, what is said of them, and the seeds.
// A piece separates two regions at most, so there are no more regions than pieces and one.
std::uint64_t domain_step(const Sizes& s) {
  const std::uint64_t hull = vertex_bytes(s) + piece_bytes(s) + 4 * s.m + 25 * s.faces + 4 * s.faces;
  const std::uint64_t arcs = 16 * 2 * s.m + 24 * s.m, listing = 4 * 3 * s.faces + 8 * 2 * s.m;
  const std::uint64_t keeping = (4 + 4 + 25 + 16) * s.faces + 16 * s.m;
  return hull + std::max({arcs, listing, keeping});
}

}  // namespace

std::uint64_t device_bytes_needed(std::uint64_t n, std::uint64_t m, std::uint64_t crossed) {
  const std::uint64_t faces = 2 * n + 1;
  const Sizes s = {n, m, faces, 3 * n + 3, m == 0 ? 0 : std::min(faces, crossed)};
  std::uint64_t most = std::max({order_step(s), insert_step(s), output_step(s), domain_step(s)});
  if (m > 0) most = std::max({most, clean_step(s), walk_step(s), chain_step(s), stitch_step(s)});
  return (constant_bytes + most + most / gaps_share) / page * page + page;
}

}  // namespace gcdt
