// SPDX-License-Identifier: Apache-2.0
// Phase 2, last step: joins the sides of new triangles that retriangulate.cl has left open (GCDT_NONE), to each other
// and to the faces around them, by a hash table of directed edges. Open addressing, nothing is removed.
//
// Entries: every directed edge u -> v of a crossed face that is not crossed itself, and that no walk has found along a
// chain (it stays, and its side waits for the new triangle that has it), and for every new edge {u, v}, u < v, that is
// made here, the direction v -> u, whose triangle comes second.
#include "common/append.h"
#include "constrain/slots.h"

typedef struct Table {
  u32 capacity;
  // Three words a slot, together in memory: the side code, or GCDT_NONE: empty; from and to, GCDT_NONE until written.
  volatile global uint* slots;
} Table;

#define TABLE_PARAMETERS uint capacity, volatile global uint *slots

static inline Table make_table(TABLE_PARAMETERS) {
  Table table;
  table.capacity = capacity;
  table.slots = slots;
  return table;
}

static inline uint first_slot(Table table, uint u, uint v) {
  uint x = u * 0x9E3779B1u ^ (v * 0x85EBCA6Bu + 0x165667B1u);
  x ^= x >> 15;
  x *= 0xC2B2AE35u;
  x ^= x >> 16;
  return (uint)(((ulong)x * table.capacity) >> 32);
}

// Ends: the table has more slots than entries. False if it does not.
static bool insert_direction(Table table, uint u, uint v, uint code) {
  uint slot = first_slot(table, u, v);
  for (uint probe = 0; probe < table.capacity; ++probe) {
    volatile global uint* at = table.slots + 3u * (size_t)slot;
    if (atomic_cmpxchg(at, GCDT_NONE, code) == GCDT_NONE) {
      at[1] = u;
      at[2] = v;
      return true;
    }
    slot = slot + 1u == table.capacity ? 0u : slot + 1u;
  }
  return false;
}

// What a slot holds.
typedef struct Entry {
  uint code, from, to;
} Entry;

static inline Entry entry_at(Table table, uint slot) {
  volatile global const uint* at = table.slots + 3u * (size_t)slot;
  const Entry entry = {at[0], at[1], at[2]};
  return entry;
}

// The side code of u -> v, if it was inserted in an earlier launch, else GCDT_NONE; `entry` is that of its first slot.
// An entry inserted meanwhile has the opposite kind of direction (v < u against u < v), so even a half-written one,
// with GCDT_NONE as one end, cannot be taken for it. Ends as insert_direction.
static uint find_from(Table table, uint u, uint v, uint slot, Entry entry) {
  for (uint probe = 0; probe < table.capacity; ++probe) {
    if (entry.code == GCDT_NONE) return GCDT_NONE;
    if (entry.from == u && entry.to == v) return entry.code;
    slot = slot + 1u == table.capacity ? 0u : slot + 1u;
    entry = entry_at(table, slot);
  }
  return GCDT_NONE;
}

static inline uint find_direction(Table table, uint u, uint v) {
  const uint slot = first_slot(table, u, v);
  return find_from(table, u, v, slot, entry_at(table, slot));
}

// The same for the sides of a face with corners c that are set in `open`; for the others GCDT_NONE. Their first slots
// are read at once.
GCDT_APART uint4 find_sides(Table table, uint4 c, uint open) {
  const uint4 slots =
      (uint4)(first_slot(table, c.y, c.z), first_slot(table, c.z, c.x), first_slot(table, c.x, c.y), 0u);
  const Entry none = {GCDT_NONE, GCDT_NONE, GCDT_NONE};
  const Entry x = open & 1u ? entry_at(table, slots.x) : none, y = open & 2u ? entry_at(table, slots.y) : none,
              z = open & 4u ? entry_at(table, slots.z) : none;
  return (uint4)(find_from(table, c.y, c.z, slots.x, x), find_from(table, c.z, c.x, slots.y, y),
                 find_from(table, c.x, c.y, slots.z, z), GCDT_NONE);
}

// One work-item per crossed face, before its slot is overwritten. Enters its sides that wait. Slots are taken by
// compare-and-exchange; where an entry lands does not matter.
kernel void stitch_keep(uint count, global const uint* crossed, global const uint4* face_data, global const uint* near,
                        TABLE_PARAMETERS, volatile global Counters* counters) {
  const Table table = make_table(capacity, slots);
  FOR_EACH(i, count) {
    const uint4 s = face_data[GCDT_SIDES(crossed[i])];
#pragma unroll 1  // drivers take as long as the text is
    for (uint k = 0; k < 3u; ++k) {
      const uint code = element(s, k);
      if (near[code] != GCDT_NONE) continue;
      const uint4 c = face_data[GCDT_CORNERS(crossed[i])];
      if (!insert_direction(table, element(c, next_corner(k)), element(c, previous_corner(k)), code))
        atomic_or(&counters->failed, GCDT_FAILED_MATCH);
    }
  }
}

// The open sides of a face with corners c and sides s, as bits, whose direction u -> v has u > v (second), or u < v.
static uint open_sides(uint4 c, uint4 s, bool second) {
  uint open = 0;
  for (uint k = 0; k < 3u; ++k)
    if (element(s, k) == GCDT_NONE && (element(c, next_corner(k)) > element(c, previous_corner(k))) == second)
      open |= 1u << k;
  return open;
}

// One work-item per new triangle: its open directions u -> v with u < v. A direction in the table takes the
// side that waits there; otherwise it makes a new edge in a spare slot (slots.cl) and enters the other
// direction. A work-group takes slots for all its new edges at once (any numbering does). Writes its own
// face's side words, the sides found (each direction occurs once among the new triangles of a valid mesh,
// which stitch_prove checks), and new edges' words. After: no direction u < v is open.
kernel void stitch_first(uint grouped, uint count, global const uint* crossed, global uint4* face_data,
                         global uint* edge_faces, global uint* edge_marks, global const uint* spare, TABLE_PARAMETERS,
                         volatile global Counters* counters) {
  local uint taken[2];
  const uint spare_edges = grouped ? counters->spare_edges : counters->crossed_edges;
  const Table table = make_table(capacity, slots);
  FOR_EACH_TILE(tile, count) {
    const uint i = tile + get_local_id(0);
    const uint t = i < count ? crossed[i] : GCDT_NONE;
    uint4 c = (uint4)(0u), s = (uint4)(0u);
    if (t != GCDT_NONE) c = face_data[GCDT_CORNERS(t)], s = face_data[GCDT_SIDES(t)];
    const uint open = open_sides(c, s, false);
    const uint4 found = find_sides(table, c, open);
    uint wanted = 0;
    for (uint k = 0; k < 3u; ++k) wanted += ((open >> k) & 1u) != 0u && element(found, k) == GCDT_NONE ? 1u : 0u;
    uint slot = take_numbers(taken, &counters->new_edges, wanted);
    // Ends: a bit is taken away each time.
#pragma unroll 1
    for (uint left = open; left != 0u; left &= left - 1u) {
      const uint k = left & 1u ? 0u : left & 2u ? 1u : 2u;
      uint code = element(found, k);
      if (code == GCDT_NONE) {
        if (slot >= spare_edges) {
          atomic_or(&counters->failed, GCDT_FAILED_MATCH);
          continue;
        }
        const uint e = spare[slot++];
        code = GCDT_SIDE(e, 0u);
        edge_marks[e] = 0u;
        edge_faces[GCDT_SIDE(e, 1u)] = GCDT_NONE;
        if (!insert_direction(table, element(c, previous_corner(k)), element(c, next_corner(k)), GCDT_SIDE(e, 1u)))
          atomic_or(&counters->failed, GCDT_FAILED_MATCH);
      }
      join(face_data, edge_faces, t, k, code);
    }
  }
}

// One work-item per new triangle, after stitch_first: its open directions u -> v with u > v, all of which are in
// the table now. Writes as there.
kernel void stitch_second(uint count, global const uint* crossed, global uint4* face_data, global uint* edge_faces,
                          TABLE_PARAMETERS, volatile global Counters* counters) {
  const Table table = make_table(capacity, slots);
  FOR_EACH(i, count) {
    const uint t = crossed[i];
    const uint4 c = face_data[GCDT_CORNERS(t)], s = face_data[GCDT_SIDES(t)];
    const uint open = open_sides(c, s, true);
    const uint4 found = find_sides(table, c, open);
    for (uint k = 0; k < 3u; ++k) {
      if (!((open >> k) & 1u)) continue;
      const uint code = element(found, k);
      if (code == GCDT_NONE)
        atomic_or(&counters->failed, GCDT_FAILED_MATCH);
      else
        join(face_data, edge_faces, t, k, code);
    }
  }
}

// One work-item per new triangle. Checks that it is counter-clockwise and that each of its side codes is
// its own. That proves the mesh: the 3C sides of C triangles then are distinct, as many as the sides that stay and both
// sides of the new edges, so every direction met its reverse; counter-clockwise triangles whose edges pair up
// cover what the crossed ones covered, once. No race: only the failure bits are written.
kernel void stitch_prove(uint count, global const uint* crossed, GCDT_MESH_PARAMETERS,
                         volatile global Counters* counters) {
  FOR_EACH(i, count) {
    const uint t = crossed[i];
    const uint4 c = face_data[GCDT_CORNERS(t)], s = face_data[GCDT_SIDES(t)];
    bool right =
        gcdt_orient2d(load_vertex(points, n, c.x), load_vertex(points, n, c.y), load_vertex(points, n, c.z)) > 0;
    for (uint k = 0; k < 3u; ++k) {
      const uint code = element(s, k);
      right =
          right && code < 2u * gcdt_forest_edges(n, root_count(points, n)) && edge_faces[code] == GCDT_FACE_REF(t, k);
    }
    if (!right) atomic_or(&counters->failed, GCDT_FAILED_MATCH);
  }
}

// One work-item per piece. Marks the edge of a piece that was walked and has no edge yet: that of its one triangle
// with the piece as base (roots), or one between two other chains. Pieces are distinct edges, so no two write the same
// word. After: every piece is a marked edge, or a failure bit is set.
kernel void stitch_mark(uint pieces, global const uint2* ends, global const uint* piece_edge, global const uint2* roots,
                        global const uint4* face_data, global uint* edge_marks, TABLE_PARAMETERS,
                        volatile global Counters* counters) {
  const Table table = make_table(capacity, slots);
  FOR_EACH(c, pieces) {
    if (piece_edge[c] != GCDT_NONE) continue;
    const uint root = min(roots[c].x, roots[c].y);
    const uint code = root != GCDT_NONE ? face_data[GCDT_SIDES(root)].z
                                        : find_direction(table, max(ends[c].x, ends[c].y), min(ends[c].x, ends[c].y));
    if (code == GCDT_NONE)
      atomic_or(&counters->failed, GCDT_FAILED_MISSING);
    else
      edge_marks[GCDT_SIDE_EDGE(code)] = GCDT_MARK_CONSTRAINED;
  }
}
