// SPDX-License-Identifier: Apache-2.0
// Rounds of flips by sweeps over the marks of all edges: faster than lists while many edges are queued (flip.cl).
#include "flip/rounds.h"

// Edges of a tile: enough that the queued ones among them fill a group.
#define SWEEP_TILE 512u
#define FOR_EACH_SWEEP(tile, edges) FOR_EACH_TILE_OF(tile, SWEEP_TILE, edges)

// Takes the edges first .. first + 3, those that exist, out of the queue; first is a multiple of 4. Bit i: edge
// first + i was in it (or `all`), and is not constrained.
static inline uint take_marks(uint all, global uint* edge_marks, uint first, uint edges) {
  uint marks[4] = {GCDT_MARK_CONSTRAINED, GCDT_MARK_CONSTRAINED, GCDT_MARK_CONSTRAINED, GCDT_MARK_CONSTRAINED};
  if (first + 4u <= edges) {
    const uint4 four = *(global const uint4*)(edge_marks + first);
    marks[0] = four.x, marks[1] = four.y, marks[2] = four.z, marks[3] = four.w;
  } else {
    for (uint i = 0; first + i < edges; ++i) marks[i] = edge_marks[first + i];
  }
  uint taken = 0;
  for (uint i = 0; i < 4u; ++i) {
    if (marks[i] & GCDT_MARK_QUEUED) edge_marks[first + i] = marks[i] & ~GCDT_MARK_QUEUED;
    if ((all || (marks[i] & GCDT_MARK_QUEUED)) && !(marks[i] & GCDT_MARK_CONSTRAINED)) taken |= 1u << i;
  }
  return taken;
}

// The place of bit i among those set: how many are set before it.
GCDT_GIVEN_LOCAL uint place_of_bit(volatile local const uint* taken, uint i) {
  uint before = 0;
  for (uint word = 0; word < i / 32u; ++word) before += popcount(taken[word]);
  return i % 32u == 0u ? before : before + popcount(taken[i / 32u] << (32u - i % 32u));
}

// One work-group per tile of edges. Takes the queued ones (`all`: every one) out of the queue, gathers those that
// are not constrained in local memory, tests them, and lets illegal ones claim their faces. Reads the mesh, which
// nobody changes in this launch. Writes mark words of its own edges, claim words (atomic_max: the
// greatest ticket wins whatever the order) and the list of illegal edges (append.h). After: an illegal edge owns its
// two faces, or one of them has a better claim; no edge is queued.
kernel void flip_sweep(uint all, uint edges, uint round, uint stamp, uint bits, GCDT_MESH_PARAMETERS,
                       global uint* edge_marks, global uint* illegal, volatile global Counters* counters) {
  DECLARE_APPENDER(found);
  local uint queued[SWEEP_TILE];
  volatile local uint taken[SWEEP_TILE / 32u];
  local uint queued_count;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Claim c = make_claim(stamp, bits);
  const Appender a = make_appender(found_items, found_gathered, illegal, &counters->list_flip[round & 1u]);
  FOR_EACH_SWEEP(tile, edges) {
    for (uint i = get_local_id(0); i < SWEEP_TILE / 32u; i += get_local_size(0)) taken[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = GCDT_SWEEP_EDGES * get_local_id(0); i < SWEEP_TILE; i += GCDT_SWEEP_EDGES * get_local_size(0)) {
      const uint four = take_marks(all, edge_marks, tile + i, edges);
      if (four != 0u) atomic_or(taken + i / 32u, four << (i % 32u));
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    // In order: neighbours in a list share cache lines. Each bit has its own place.
    for (uint i = get_local_id(0); i < SWEEP_TILE; i += get_local_size(0))
      if (taken[i / 32u] >> (i % 32u) & 1u) queued[place_of_bit(taken, i)] = tile + i;
    if (get_local_id(0) == 0) queued_count = place_of_bit(taken, SWEEP_TILE);
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint count = queued_count;
    for (uint i = get_local_id(0); i < count; i += get_local_size(0)) test_and_claim(mesh, c, queued[i], a);
    append_flush(a, APPEND_CAPACITY - SWEEP_TILE);
  }
  append_flush(a, 0u);
}

// One work-item per illegal edge, as flip_propagate, but the queue is the marks alone.
kernel void flip_mark(uint round, uint stamp, uint bits, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                      global const uint* illegal, volatile global Counters* counters) {
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Claim c = make_claim(stamp, bits);
  const Queue queue = make_mark_queue(edge_marks);
  const uint count = counters->list_flip[round & 1u];
  if (get_global_id(0) == 0) counters->list_flip[(round + 1u) & 1u] = 0u;
  uint flips = 0;
  FOR_EACH(i, count) flips += flip_if_won(mesh, c, illegal[i], queue);
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
}
