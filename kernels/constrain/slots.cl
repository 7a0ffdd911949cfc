// SPDX-License-Identifier: Apache-2.0
// Phase 2: which slots new triangles and edges get, of those of crossed ones. Any are right; but flips begin within
// parts of the mesh that own faces and edges by number (flip/span.h), so in a large mesh it pays that a triangle has
// the slot of a face that was there, and an edge an edge's. So crossed faces and edges are listed piece by piece, as
// pieces stand along the curve, where triangles are numbered in that order, too. In a small mesh all that is left out:
// faces are listed as they come, and all edges are spare.
//
// Triangles: those of a piece's left chain, then of its right one. As many as the crossed faces that are no hexagons:
// the triangle with number i has the slot of the i-th. Those of hexagons' holes have the hexagons', behind all others.
//
// Edges: one between each two triangles of a piece that follow one another. In a chain that is an edge between a
// triangle and its parent (retriangulate.cl): of two neighbours x, x + 1 in the chain one comes before the other in the
// tree of minima, say x + 1; then the triangles of the places behind the last one before x + 1 with a smaller distance,
// up to x, are one subtree, whose root has x + 1 for its parent. No other triangle has x + 1 for its parent on that
// side. Between the last triangle left of a piece and the first one right of it the edge is the piece. So a piece with
// k triangles has k - 1 edges, in the slots of the edges that are listed with it, while there are any. Further ones,
// and those between chains of different pieces (stitch.cl), have spare slots, which their pieces have no use for.
#include "common/append.h"
#include "constrain/chains.h"
#include "constrain/slots.h"

// One work-item per crossed face in any order. Writes it to its place in `grouped`: hexagons behind all others, by
// number; the others by next[c], which is where piece c's begin, and afterwards where they end: atomic_inc gives each
// place once.
kernel void slots_of_faces(uint count, uint hexagons, uint claim, global uint4* face_data, global const uint* near,
                           global const uint* crossed, volatile global uint* next, global uint* grouped) {
  FOR_EACH(i, count) {
    const uint t = crossed[i], word = *claim_word(face_data, t);
    const uint at = word >= claim ? count - hexagons + (word - claim)
                                  : atomic_inc(next + piece_of_face(near_words(near, face_data[GCDT_SIDES(t)])));
    grouped[at] = t;
  }
}

// The same of crossed edges.
kernel void slots_of_edges(uint count, global const uint* near, global const uint* crossed_edges,
                           volatile global uint* next, global uint* grouped) {
  FOR_EACH(i, count) {
    const uint e = crossed_edges[i];
    grouped[atomic_inc(next + near[2u * e])] = e;
  }
}

// The triangles of piece c, left and right of it, and those of pieces before it: owned vertices.
typedef struct PieceTriangles {
  uint before, left, right;
} PieceTriangles;

static inline PieceTriangles triangles_of_piece(global const uint* begins, global const uint* starts, uint capacity,
                                                uint c) {
  const uint first = begins[c], last = begins[c + 1u];
  PieceTriangles t;
  t.before = starts[first] + (starts[capacity + first] - starts[capacity]);
  t.left = starts[last] - starts[first];
  t.right = starts[capacity + last] - starts[capacity + first];
  return t;
}

// One work-item per piece. Writes its own record (slots.h): of its slots of edges it has use for one less than it has
// triangles. edge_ends: `next` of slots_of_edges.
kernel void slots_of_pieces(uint pieces, uint capacity, global const uint* begins, global const uint* starts,
                            global const uint* edge_ends, global uint4* records) {
  FOR_EACH(c, pieces) {
    const PieceTriangles t = triangles_of_piece(begins, starts, capacity, c);
    const uint slot = c == 0u ? 0u : edge_ends[c - 1u], made = max(t.left + t.right, 1u) - 1u;
    records[c] = (uint4)(t.before - (left_begin(starts, begins[c], c) + 1u),
                         t.before + t.left - (right_begin(starts, capacity, pieces, begins[c], c) + 1u),
                         slot - t.before, min(slot + made, edge_ends[c]));
  }
}

// One work-item per listed edge, which piece near[2e] has. Lists it as spare if the piece has no use for it.
kernel void slots_spare(uint count, global const uint* near, global const uint4* records, global const uint* grouped,
                        global uint* spare, volatile global Counters* counters) {
  DECLARE_APPENDER(list);
  const Appender list = make_appender(list_items, list_gathered, spare, &counters->spare_edges);
  FOR_EACH_TILE(tile, count) {
    const uint i = tile + get_local_id(0), e = i < count ? grouped[i] : 0u;
    if (i < count && i >= records[near[2u * e]].w) append(list, e);
    append_flush(list, APPEND_CAPACITY / 2u);
  }
  append_flush(list, 0u);
}
