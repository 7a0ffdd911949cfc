// SPDX-License-Identifier: Apache-2.0
// gcdt_required_bytes: the device bytes of each step, added up from what its source allocates.
#include <algorithm>

#include <gcdt/types.hpp>

#include "mesh/mesh.hpp"
#include "solve/memory.hpp"

namespace gcdt {

namespace {

// Counters, levels, tables of primitives (256 or 16 counters a part), parts beyond one per constraint, those of
// cleaning and those of enforcement, with a chunk each: everything that does not grow with the input.
constexpr std::uint64_t constant_bytes = 32u << 20;

// Buffers lie in one piece of memory (device_memory.hpp), with gaps between them that none fits in. Measured
// over all generators of tests/support/workloads.hpp: below an eighth of the most that is in use.
constexpr std::uint64_t gaps_share = 8;
// A multiple of every alignment.
constexpr std::uint64_t page = 4096;

struct Sizes {
  std::uint64_t n, m, faces, edges, crossed_faces;
  bool gated;  ///< whether as much is crossed as some device makes gates for
};

// Points, both maps, and the table of levels, which there is where vertices are isolated.
std::uint64_t vertex_bytes(const Sizes& s) { return (8 + 4 + 4 + 8) * s.n; }
std::uint64_t mesh_bytes(const Sizes& s) { return 2 * 16 * s.faces + 12 * s.edges; }  // corners, sides; faces, marks
// Where all is top layer (freeze_all). With nodes it is about half of that: a quarter of the vertices is coarser than
// the last level, a third where isolated ones are (phases/levels.hpp).
std::uint64_t history_bytes(const Sizes& s) { return 32 * s.faces + 4 * s.n; }
// Ends, first sources, sources.
std::uint64_t piece_bytes(const Sizes& s) { return (8 + 4 + 4) * s.m; }
// Of constraints until they are edges: input, pieces, what cleaning says of these (weights, parts, first faces, edges
// passed), and what the sorts keep (other halves of both kinds of keys, and of values).
std::uint64_t cleaned_bytes(const Sizes& s) {
  return 8 * s.m + piece_bytes(s) + (4 + 8 + 4 + 4) * s.m + (8 + 4 + 4) * s.m;
}

// Chains triangulate crossed faces c but for hexagons h. A hole of k of these has k + 2 sides (L8), each a segment
// between vertices that a piece owns one after the other on one side, or its ends: one more than it has triangles
// there. So the sides of all holes, more than h, are at most (c - h) + 2 m, and h <= c / 2 + m.
std::uint64_t hexagons(const Sizes& s) { return std::min(s.crossed_faces, s.crossed_faces / 2 + s.m); }

// Of parts beyond those in constant_bytes, of constraints that cross much or are long (part_pool and long_part_pool,
// mesh/plan.cpp): so many when they are cleaned, and as many more when they are enforced.
std::uint64_t more_parts(const Sizes& s) {
  constexpr std::uint64_t usual = Tuning::gpu_parts, most = Tuning::gpu_long_parts;
  return s.m == 0 ? 0 : std::clamp(s.n / 2, usual, most) - usual;
}

// Chunks of owned vertices, 48 bytes each: one an eighth of a crossed face, and one a part.
std::uint64_t chunk_bytes(const Sizes& s) { return 6 * s.crossed_faces + 48 * (s.m + 2 * more_parts(s)); }

// Gates (phases/gates.hpp): two an edge, of 16 bytes.
std::uint64_t gate_bytes(const Sizes& s) { return 32 * s.edges; }

// What constraints have while they are cleaned: input, ends and number, crossed faces, lines, lengths, places and what
// parts have (beginnings, pieces, faces twice, edges passed, hits, first hits).
std::uint64_t cleaning_bytes(const Sizes& s) { return (8 + 12 + 4 + 16 + 8 + 32) * s.m + 32 * more_parts(s); }

// Gates beside the history, before or while constraints are cleaned. Where they only seemed to cross much by their
// lengths, the history has nodes: 36 bytes a vertex. (Fans, phases/fans.hpp, which are never beside gates, have 12
// bytes a vertex, and 20 for each of at most 2.3 elements a vertex: with a whole history 6 less than this.)
std::uint64_t gate_step(const Sizes& s) {
  return vertex_bytes(s) + mesh_bytes(s) + (s.gated ? history_bytes(s) : 36 * s.n) + gate_bytes(s) + cleaning_bytes(s);
}

// From the walk to the stitching: the nearest piece at both ends of each edge, in place of the work lists; lists of
// crossed faces and edges; of pieces lines, edges and last sides, of parts beginnings, pieces, faces and edges passed,
// those of cleaning among them, an order, and two starts; of hexagons faces and farthest cuts.
std::uint64_t crossed_step(const Sizes& s) {
  return vertex_bytes(s) + mesh_bytes(s) + cleaned_bytes(s) + 8 * s.edges + 4 * (s.faces + s.edges) +
         (16 + 4 + 8 + 4 + 4 + 4 + 4 + 8) * s.m + 2 * 28 * more_parts(s) + 16 * hexagons(s);
}

// Gates in the history's place are 28 bytes a vertex more, and no more than stitching has where so much is crossed.
std::uint64_t walk_step(const Sizes& s) { return crossed_step(s) + history_bytes(s) + chunk_bytes(s); }

// After the last walk the history is gone. An entry of a chain, one for each owned vertex and four a piece, holds 20
// bytes; of a hexagon, which no vertex is owned in, corners 12.
std::uint64_t chain_bytes(const Sizes& s) { return 20 * (s.crossed_faces - hexagons(s) + 4 * s.m) + 12 * hexagons(s); }
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

// ---- Refinement: n vertices become N = n + a ----

Sizes sizes_of(std::uint64_t n, std::uint64_t m) { return {n, m, 2 * n + 1, 3 * n + 3, 0, false}; }

// Subsegments: pieces and edges of the hull, and one more with each vertex added.
std::uint64_t subsegments(const Sizes& before, const Sizes& after) { return before.m + after.n; }

// A round: the mesh with room for all, the pieces of its edges, work lists; of pieces ends and marks; of added vertices
// origins and wanted lengths; areas and regions of the triangles as they were; lists of triangles and subsegments to be
// mended, which of these do not wait, and their urgency; lists of cavities. Of candidates, at most one of each of these
// with a fourth more room, keys, numbers, points, ranks and winners, and the other halves of the sort. And the largest
// buffer once more, while room is made.
std::uint64_t round_step(const Sizes& before, const Sizes& after) {
  const std::uint64_t added = after.n - before.n, asked = subsegments(before, after);
  const std::uint64_t candidates = 5 * (after.faces + asked) / 4;
  return vertex_bytes(before) + 8 * added + mesh_bytes(after) + (4 + 8) * after.edges + 12 * asked +
         piece_bytes(before) + (16 + 4) * added + 4 * after.n + (8 + 16) * before.faces + (16 + 4) * after.faces +
         4 * asked + (8 + 4 + 16 + 4 + 4 + 12) * candidates + 32 * after.faces;
}

// The end: vertices are ordered anew beside those that there were, with their origins twice; then the output, of which
// the hull stays beside the triangles of the domain, and their regions as they were and as they are.
std::uint64_t renewal_step(const Sizes& before, const Sizes& after) {
  const std::uint64_t added = after.n - before.n;
  return vertex_bytes(before) + 60 * after.n + 2 * (16 + 8) * added + 4 * after.edges + piece_bytes(before) +
         8 * subsegments(before, after) + 16 * (before.faces + after.faces) + (12 + 12 + 1 + 4) * after.faces +
         output_step({after.n, subsegments(before, after), after.faces, after.edges, 0, false});
}

std::uint64_t in_pages(std::uint64_t bytes) {
  return (constant_bytes + bytes + bytes / gaps_share) / page * page + page;
}

}  // namespace

std::uint64_t refined_bytes_needed(std::uint64_t n, std::uint64_t m, std::uint64_t crossed, std::uint64_t added) {
  if (added == UINT64_MAX) return UINT64_MAX;
  const Sizes before = sizes_of(n, m), after = sizes_of(n + std::min(added, max_vertices), m);
  return std::max(device_bytes_needed(n, m, crossed),
                  in_pages(std::max(round_step(before, after), renewal_step(before, after))));
}

// Other steps need less, in bytes a vertex and a constraint. Without constraints all but output (190): order (60),
// insertion (186 with its history), domains (180). With constraints walking (236 and 160) is above these as well:
// insertion (222 and 8), cleaning without gates and fans (192 and 132), domains (180 and 76).
std::uint64_t device_bytes_needed(std::uint64_t n, std::uint64_t m, std::uint64_t crossed) {
  const std::uint64_t faces = 2 * n + 1;
  const bool gated = m > 0 && crossed / faces >= Tuning::gpu_crossings_gated;
  const Sizes s = {n, m, faces, 3 * n + 3, m == 0 ? 0 : std::min(faces, crossed), gated};
  const std::uint64_t most =
      m == 0 ? output_step(s) : std::max({output_step(s), gate_step(s), walk_step(s), chain_step(s), stitch_step(s)});
  return in_pages(most);
}

}  // namespace gcdt
