// SPDX-License-Identifier: Apache-2.0
// A mesh that was not made here, found again in the triangulation whose constraints are all its edges. Where the mesh
// is valid, each of its triangles is a triangle there: nothing crosses its edges, and no vertex is inside it.
#include "common/levels.h"
#include "common/pieces.h"
#include "common/predicates.h"

// The vertices of triangle t, whose corners are input numbers.
GCDT_INLINE uint3 vertices_of(global const uint* corners, uint t, global const uint* input_vertex) {
  const uint3 c = vload3(t, corners);
  return (uint3)(input_vertex[c.x], input_vertex[c.y], input_vertex[c.z]);
}

// The triangle of a canonical mesh whose first two corners have those ranks; GCDT_NONE if there is none. Ends: high -
// low shrinks.
GCDT_INLINE uint find_triangle(global const Levels* levels, uint triangles, global const uint* corners,
                               global const uint* input_vertex, uint first, uint second) {
  uint low = 0, high = triangles;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    uint found = gcdt_rank_of_vertex(levels, input_vertex[corners[3u * middle]]), wanted = first;
    if (found == wanted) {
      found = gcdt_rank_of_vertex(levels, input_vertex[corners[3u * middle + 1u]]);
      wanted = second;
      if (found == wanted) return middle;
    }
    if (found < wanted)
      low = middle + 1u;
    else
      high = middle;
  }
  return GCDT_NONE;
}

// One work-item per triangle of the mesh.
// Reads corners (input numbers) and the canonical mesh `whole`. Writes found[i]; faults and taken by atomic_min.
// Word i has one writer; the least is the same in any order.
// After this kernel found[i] is the triangle of `whole` with the corners of triangle i; taken[t] is the least i with
// found[i] = t, GCDT_NONE (as before) without one; faults[0] is the least triangle that is not counter-clockwise, and
// faults[1] the least of the others that is not in `whole`.
kernel void find_triangles(const uint count, global const Levels* levels, global const int2* points,
                           global const uint* input_vertex, global const uint* corners, const uint whole_count,
                           global const uint* whole_corners, global uint* found, volatile global uint* taken,
                           volatile global uint* faults) {
  FOR_EACH(i, count) {
    const uint3 v = vertices_of(corners, i, input_vertex);
    uint t = GCDT_NONE;
    if (gcdt_orient2d_finite(vertex_at(points, v.x), vertex_at(points, v.y), vertex_at(points, v.z)) <= 0) {
      atomic_min(&faults[0], i);
    } else {
      const uint a = gcdt_rank_of_vertex(levels, v.x), b = gcdt_rank_of_vertex(levels, v.y),
                 c = gcdt_rank_of_vertex(levels, v.z), least = min(min(a, b), c);
      const uint3 r = least == a ? (uint3)(a, b, c) : least == b ? (uint3)(b, c, a) : (uint3)(c, a, b);
      t = find_triangle(levels, whole_count, whole_corners, input_vertex, r.x, r.y);
      if (t != GCDT_NONE && gcdt_rank_of_vertex(levels, input_vertex[whole_corners[3u * t + 2u]]) != r.z) t = GCDT_NONE;
      if (t == GCDT_NONE)
        atomic_min(&faults[1], i);
      else
        atomic_min(&taken[t], i);
    }
    found[i] = t;
  }
}

// One work-item per triangle of the mesh, all of which were found.
// Reads found and taken. Writes *twice by atomic_min: the least is the same in any order.
// After this kernel *twice is the least triangle that an earlier one has the corners of, GCDT_NONE (as before) if there
// is none.
kernel void find_repeated(const uint count, global const uint* found, global const uint* taken,
                          volatile global uint* twice) {
  FOR_EACH(i, count)
  if (taken[found[i]] != i) atomic_min(twice, i);
}

// One work-item per triangle of the mesh.
// Reads found and taken; `whole`, of which every edge of the mesh is a piece; the pieces, their ends as vertices.
// Replaces corners of triangle i, of which it is the one reader; writes its neighbours and flags.
// Words 3i .. 3i + 2 and byte i have one writer.
// After this kernel corners are representatives; neighbours are those of the mesh, -1 where it has none; and bit k of
// constrained tells whether a source below `sources_below` runs along the edge opposite corner k.
kernel void link_triangles(const uint count, global const Levels* levels, global const uint* vertex_input,
                           global const uint* input_vertex, global const uint* found, global const int* taken,
                           global const uint* whole_corners, global const int* whole_neighbours, const uint pieces,
                           global const uint2* ends, global const uint* source_offsets, global const uint* sources,
                           const uint sources_below, global uint* corners, global int* neighbours,
                           global uchar* constrained) {
  FOR_EACH(i, count) {
    const uint t = found[i];
    const uint3 v = vertices_of(corners, i, input_vertex), w = vertices_of(whole_corners, t, input_vertex);
    const uint turn = w.x == v.x ? 0u : w.y == v.x ? 1u : 2u;  // corner k is corner k + turn there
    uint flags = 0;
    uint3 r = v;
    for (uint k = 0; k < 3; ++k, r = r.yzx) {
      const uint there = k + turn >= 3u ? k + turn - 3u : k + turn;
      const int across = whole_neighbours[3u * t + there];
      neighbours[3u * i + k] = across < 0 ? -1 : taken[across];
      const uint piece = find_piece(levels, pieces, ends, r.y, r.z);
      if (sources[source_offsets[piece]] < sources_below) flags |= 1u << k;
    }
    vstore3((uint3)(vertex_input[v.x], vertex_input[v.y], vertex_input[v.z]), i, corners);
    constrained[i] = (uchar)flags;
  }
}

// One work-item per piece.
// Reads source_offsets and sources, which ascend within a piece. Writes wanted[p] and counts[p]. Words p have one
// writer. Ends: the sources of a piece.
// After this kernel counts[p] is the number of sources below `sources_below`, and wanted[p] is 1 if there are any.
kernel void count_sources(const uint count, const uint sources_below, global const uint* source_offsets,
                          global const uint* sources, global uint* wanted, global uint* counts) {
  FOR_EACH(p, count) {
    uint i = source_offsets[p];
    while (i < source_offsets[p + 1u] && sources[i] < sources_below) ++i;
    counts[p] = i - source_offsets[p];
    wanted[p] = counts[p] != 0u;
  }
}

// One work-item per piece.
// Reads the pieces, and the scans of what count_sources has left. Writes the wanted pieces and their sources: each word
// has one writer. Ends: the sources of a piece.
// After this kernel they stand in the same order, without the others; the last offset is left to the host.
kernel void keep_pieces(const uint count, global const uint* places, global const uint* first_sources,
                        global const uint2* ends, global const uint* source_offsets, global const uint* sources,
                        global uint2* kept_ends, global uint* kept_offsets, global uint* kept_sources) {
  FOR_EACH(p, count) {
    const uint place = places[p], first = first_sources[p], own = first_sources[p + 1u] - first;
    if (own == 0u) continue;
    kept_ends[place] = ends[p];
    kept_offsets[place] = first;
    for (uint i = 0; i < own; ++i) kept_sources[first + i] = sources[source_offsets[p] + i];
  }
}
