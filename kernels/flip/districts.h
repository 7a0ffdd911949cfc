// SPDX-License-Identifier: Apache-2.0
// Flips within districts of the mesh: a work-group does rounds among the faces of a large span, where they are, of the
// edges that are queued. What patches leave on their borders lies within a district nearly always. OpenCL C, and for
// the host the sizes.
#ifndef GCDT_DISTRICTS_H
#define GCDT_DISTRICTS_H

#include "flip/span.h"

// Edges that a district lists at a time: most rounds have fewer.
#define GCDT_DISTRICT_LISTED 2048u
// Local memory of a district with room for so many vertices, in words: its span; the length of its list of edges; the
// list, of their places; bits of its edges, and of its faces.
#define GCDT_DISTRICT_LIST (GCDT_SPAN_WORDS + 1u)
#define GCDT_DISTRICT_QUEUED (GCDT_DISTRICT_LIST + GCDT_DISTRICT_LISTED)
#define GCDT_DISTRICT_TAKEN(room) (GCDT_DISTRICT_QUEUED + GCDT_BIT_WORDS(3u * (room)))
#define GCDT_DISTRICT_WORDS(room) (GCDT_DISTRICT_TAKEN(room) + GCDT_BIT_WORDS(2u * (room)))
#ifdef __OPENCL_VERSION__

// Of an edge in the list of tests: it has both its faces.
#define DISTRICT_WON 0x80000000u

typedef struct District {
  Span span;
  volatile local uint* listed;
  local uint* list;                     // of edges to be tested
  volatile local uint *queued, *taken;  // bits of edges to be tested; of faces that an edge has
} District;

// Called by the whole group. The district of a span, with a list and bits that are empty.
GCDT_GIVEN_LOCAL District make_district(Span span, local uint* memory, uint room) {
  const District d = {.span = span,
                      .listed = memory + GCDT_SPAN_WORDS,
                      .list = memory + GCDT_DISTRICT_LIST,
                      .queued = memory + GCDT_DISTRICT_QUEUED,
                      .taken = memory + GCDT_DISTRICT_TAKEN(room)};
  FOR_ALL_TILES(tile, GCDT_BIT_WORDS(3u * room)) {
    if (tile + get_local_id(0) < GCDT_BIT_WORDS(3u * room)) d.queued[tile + get_local_id(0)] = 0u;
  }
  if (get_local_id(0) == 0) *d.listed = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  return d;
}

// Takes the queued edges of the vertex with this place out of the queue of the whole mesh.
GCDT_GIVEN_LOCAL void take_queued(District d, Mesh mesh, global uint* edge_marks, uint place) {
  const uint e = new_edge(mesh, vertex_at_place(d.span, place), 0u);
  const uint m0 = edge_marks[e], m1 = edge_marks[e + 1u], m2 = edge_marks[e + 2u];
  if (m0 & GCDT_MARK_QUEUED) edge_marks[e] = m0 & ~GCDT_MARK_QUEUED, set_bit(d.queued, 3u * place);
  if (m1 & GCDT_MARK_QUEUED) edge_marks[e + 1u] = m1 & ~GCDT_MARK_QUEUED, set_bit(d.queued, 3u * place + 1u);
  if (m2 & GCDT_MARK_QUEUED) edge_marks[e + 2u] = m2 & ~GCDT_MARK_QUEUED, set_bit(d.queued, 3u * place + 2u);
}

// Lists those of eight edges that are queued, as many as there is room for, and takes their bits. Ends: a bit goes in
// each step.
GCDT_GIVEN_LOCAL void list_eight(District d, uint eight) {
  const uint word = eight / 4u, mask = 0xFFu << (eight % 4u * 8u);
  uint bits = d.queued[word] & mask;
  if (bits == 0u) return;
  uint at = atomic_add(d.listed, popcount(bits)), left = bits;
  for (; left != 0u && at < GCDT_DISTRICT_LISTED; left &= left - 1u)
    d.list[at++] = 32u * word + 31u - clz(left & (0u - left));
  atomic_and(d.queued + word, ~(bits & ~left));
}

// Tests the edge with this place. True if it is illegal and has both its faces. One that leads out of the district is
// left to others.
GCDT_GIVEN_LOCAL bool wins_in_district(District d, Mesh mesh, global uint* edge_marks, uint place) {
  const uint e = edge_at_place(d.span, mesh, place), marks = edge_marks[e];
  const uint2 refs = faces_of_edge(mesh, e);
  if ((marks & GCDT_MARK_CONSTRAINED) || refs.x == GCDT_NONE || refs.y == GCDT_NONE) return false;
  const uint t = place_of_face(d.span, mesh, GCDT_REF_FACE(refs.x)),
             u = place_of_face(d.span, mesh, GCDT_REF_FACE(refs.y));
  if (t == GCDT_NONE || u == GCDT_NONE) {
    atomic_or(edge_marks + e, GCDT_MARK_QUEUED);
    return false;
  }
  if (!is_illegal(mesh, refs.x, refs.y)) return false;
  if (take_both(d.taken, t, u)) return true;
  set_bit(d.queued, place);
  return false;
}

// Edge e is to be tested: by this district if its number is the district's, else by whoever comes after this launch.
GCDT_GIVEN_LOCAL void queue_in_district(District d, Mesh mesh, global uint* edge_marks, uint e) {
  const uint place = place_of_edge(d.span, mesh, e);
  if (place == GCDT_NONE)
    atomic_or(edge_marks + e, GCDT_MARK_QUEUED);
  else
    set_bit(d.queued, place);
}

GCDT_GIVEN_LOCAL void flip_in_district(District d, Mesh mesh, global uint* edge_marks, uint place) {
  const uint e = edge_at_place(d.span, mesh, place);
  const uint2 refs = faces_of_edge(mesh, e);
  uint around[4];
  flip_edge(mesh, e, refs, mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.x))],
            mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.y))], around);
  queue_in_district(d, mesh, edge_marks, GCDT_SIDE_EDGE(around[0]));
  queue_in_district(d, mesh, edge_marks, GCDT_SIDE_EDGE(around[1]));
  queue_in_district(d, mesh, edge_marks, GCDT_SIDE_EDGE(around[2]));
  queue_in_district(d, mesh, edge_marks, GCDT_SIDE_EDGE(around[3]));
}

// What the district has not done is to be tested after this launch.
GCDT_GIVEN_LOCAL void leave_queued(District d, Mesh mesh, global uint* edge_marks, uint place) {
  const uint e = new_edge(mesh, vertex_at_place(d.span, place), 0u);
  for (uint j = 0; j < 3u; ++j)
    if (is_set(d.queued, 3u * place + j)) atomic_or(edge_marks + e + j, GCDT_MARK_QUEUED);
}

// Called by the whole group. Up to `most` rounds among the district's `vertices` vertices, adding to `flips`. Returns
// how many were done. Ends: after `most`.
GCDT_GIVEN_LOCAL uint rounds_of_district(District d, Mesh mesh, global uint* edge_marks, uint vertices, uint most,
                                         private uint* flips) {
  const uint edges = 3u * vertices;
  uint round = 0;
  for (; round < most; ++round) {
    FOR_ALL_TILES(tile, (edges + 7u) / 8u) {
      const uint i = tile + get_local_id(0);
      if (8u * i < edges) list_eight(d, i);
      if (32u * i < 2u * vertices) d.taken[i] = 0u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint count = min(*d.listed, GCDT_DISTRICT_LISTED);
    if (count == 0u) break;
    FOR_ALL_TILES(tile, count) {
      const uint i = tile + get_local_id(0);
      if (i < count && wins_in_district(d, mesh, edge_marks, d.list[i])) d.list[i] |= DISTRICT_WON;
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    if (get_local_id(0) == 0) *d.listed = 0u;
    FOR_ALL_TILES(tile, count) {
      const uint i = tile + get_local_id(0);
      if (i >= count || !(d.list[i] & DISTRICT_WON)) continue;
      flip_in_district(d, mesh, edge_marks, d.list[i] & ~DISTRICT_WON);
      ++*flips;
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  }
  return round;
}

#endif  // __OPENCL_VERSION__

#endif
