// SPDX-License-Identifier: Apache-2.0
// What is derived from a finished mesh on demand: the hull in order, and the piece along each edge. Corners and
// ends of pieces are input numbers.
#include "common/corners.h"
#include "common/levels.h"
#include "common/pieces.h"

// One work-item per half edge.
// Reads neighbours. Writes flags[h]. Word h has one writer.
// After this kernel the scan of `flags` lists the edges of the hull.
kernel void hull_flags(const uint count, global const int* neighbours, global uint* flags) {
  FOR_EACH(h, count) flags[h] = neighbours[h] < 0 ? 1u : 0u;
}

// The vertex where half edge h starts (`end` 0) or ends (1).
GCDT_INLINE uint end_of(uint h, uint end, global const uint* corners, global const uint* input_vertex) {
  const uint t = h / 3u, k = h % 3u + 1u + end;
  return input_vertex[corners[3u * t + (k >= 3u ? k - 3u : k)]];
}

// One work-item per edge of the hull.
// Reads edges and the mesh. Writes edge_at[v] for the vertex v where the edge starts: in a convex hull one edge;
// *first_rank by atomic_min.
// After this kernel edge_at leads from vertex to edge, and *first_rank is the least rank on the hull.
kernel void hull_starts(const uint count, global const Levels* levels, global const uint* edges,
                        global const uint* corners, global const uint* input_vertex, global uint* edge_at,
                        volatile global uint* first_rank) {
  FOR_EACH(i, count) {
    const uint v = end_of(edges[i], 0u, corners, input_vertex);
    edge_at[v] = i;
    atomic_min(first_rank, gcdt_rank_of_vertex(levels, v));
  }
}

// One work-item per edge of the hull.
// Reads edges, the mesh, edge_at and first_rank. Writes links[i]: the next edge and the steps to it.
// Word i has one writer.
// After this kernel the links lead counter-clockwise to the edge of the first vertex, where they stay.
kernel void hull_links(const uint count, global const Levels* levels, global const uint* edges,
                       global const uint* corners, global const uint* input_vertex, global const uint* edge_at,
                       global const uint* first_rank, global uint2* links) {
  FOR_EACH(i, count) {
    const uint v = end_of(edges[i], 0u, corners, input_vertex), w = end_of(edges[i], 1u, corners, input_vertex);
    links[i] = gcdt_rank_of_vertex(levels, v) == *first_rank ? (uint2)(i, 0u) : (uint2)(edge_at[w], 1u);
  }
}

// One work-item per edge of the hull.
// Reads from. Writes to[i]. Word i has one writer.
// After this kernel every link goes twice as far, or to the first edge.
kernel void hull_double(const uint count, global const uint2* from, global uint2* to) {
  FOR_EACH(i, count) {
    const uint2 link = from[i], beyond = from[link.x];
    to[i] = (uint2)(beyond.x, link.y + beyond.y);
  }
}

// One work-item per edge of the hull.
// Reads links, all of which lead to the first edge. Writes hull: the steps to the first edge differ, so every place
// has one writer.
// After this kernel hull holds the vertices of the hull, as input numbers, counter-clockwise.
kernel void hull_order(const uint count, global const uint* edges, global const uint* corners,
                       global const uint2* links, global uint* hull) {
  FOR_EACH(i, count) {
    const uint steps = links[i].y, k = edges[i] % 3u;
    hull[steps == 0u ? 0u : count - steps] = corners[edges[i] - k + next_corner(k)];
  }
}

// One work-item per end of a piece. Reads ends as input numbers. Writes vertices. Word i has one writer.
kernel void number_ends(const uint count, global const uint* ends, global const uint* input_vertex,
                        global uint* vertices) {
  FOR_EACH(i, count) vertices[i] = input_vertex[ends[i]];
}

// One work-item per half edge.
// Reads the mesh, flags and the pieces' ends as vertices. Writes found[h]. Word h has one writer.
// After this kernel found[h] is the piece along the half edge, -1 if it is not constrained.
kernel void edge_pieces(const uint count, global const Levels* levels, global const uint* corners,
                        global const uchar* constrained, global const uint* input_vertex, const uint pieces,
                        global const uint2* ends, global int* found) {
  FOR_EACH(h, count) {
    int piece = -1;
    if ((constrained[h / 3u] >> (h % 3u)) & 1u)
      piece = (int)find_piece(levels, pieces, ends, end_of(h, 0u, corners, input_vertex),
                              end_of(h, 1u, corners, input_vertex));
    found[h] = piece;
  }
}
