// SPDX-License-Identifier: Apache-2.0
// Rounds of flips: what a work-item does with an edge, a group with a tile of them, and a group by itself with whole
// rounds. flip.cl has the rounds, and why they are right. OpenCL C only.
#ifndef GCDT_ROUNDS_H
#define GCDT_ROUNDS_H

#include "flip/flip.h"
#include "flip/queue.h"

// Edge e, not constrained.
GCDT_GIVEN_LOCAL void test_and_claim(Mesh mesh, Claim c, uint e, Appender illegal) {
  const uint2 refs = faces_of_edge(mesh, e);
  if (refs.x == GCDT_NONE || refs.y == GCDT_NONE || !is_illegal(mesh, refs.x, refs.y)) return;
  const uint ticket = make_ticket(c.stamp, c.bits, e);
  atomic_max(claim_word(mesh.face_data, GCDT_REF_FACE(refs.x)), ticket);
  atomic_max(claim_word(mesh.face_data, GCDT_REF_FACE(refs.y)), ticket);
  append(illegal, e);
}

// Takes e out of the queue; true if it is to be tested.
static inline bool leaves_queue(global uint* edge_marks, uint e) {
  const uint marks = edge_marks[e];
  edge_marks[e] = marks & ~GCDT_MARK_QUEUED;
  return !(marks & GCDT_MARK_CONSTRAINED);
}

// Goes on flipping around e, which was flipped under `ticket`. Ends: every pass takes
// an edge from the worklist, and edges are added only by flips, at most GCDT_FLIP_CHAIN.
static uint propagate(Mesh mesh, Claim c, uint ticket, private uint* around, Queue queue) {
  uint work[GCDT_FLIP_WORKLIST];
  uint size = 0, flips = 1;
  for (uint i = 0; i < 4u; ++i) work[size++] = around[i];
  while (size > 0u) {
    const uint code = work[--size];
    const uint edge = GCDT_SIDE_EDGE(code);
    if (queue.marks[edge] & GCDT_MARK_CONSTRAINED) continue;
    if (flips == GCDT_FLIP_CHAIN) {
      queue_edge(queue, edge);
      continue;
    }
    const uint near = mesh.edge_faces[code], far = mesh.edge_faces[code ^ 1u];
    if (far == GCDT_NONE) continue;
    const uint face = GCDT_REF_FACE(far);
    const bool owned = *claim_word(mesh.face_data, face) == ticket;
    const bool illegal = is_illegal(mesh, near, far);
    if (owned && !illegal) continue;
    if (!illegal || (!owned && !try_lock(mesh, face, ticket, c))) {
      queue_edge(queue, edge);
      continue;
    }
    const uint2 refs = faces_of_edge(mesh, edge);
    flip_edge(mesh, edge, refs, mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.x))],
              mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.y))], around);
    ++flips;
    for (uint i = 0; i < 4u; ++i) {
      if (size < GCDT_FLIP_WORKLIST)
        work[size++] = around[i];
      else
        queue_edge(queue, GCDT_SIDE_EDGE(around[i]));
    }
  }
  return flips;
}

// The same, if work-items propagate here; else leaves the edges around to the next round, where a constrained one
// leaves the queue unseen.
static inline uint go_on_around(Mesh mesh, Claim c, uint ticket, private uint* around, Queue queue) {
#if GCDT_FLIP_CHAIN > 1
  return propagate(mesh, c, ticket, around, queue);
#else
  queue_around(queue, around);
  return 1;
#endif
}

// Flips e if it owns both its faces; they were claimed before this launch or not at all, so corners read with the
// ticket beside them are right. Returns the number of flips.
static uint flip_if_won(Mesh mesh, Claim c, uint e, Queue queue) {
  uint around[4];
  const uint ticket = make_ticket(c.stamp, c.bits, e);
  const uint2 refs = faces_of_edge(mesh, e);
  const uint4 ct = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.x))],
              cu = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.y))];
  if (ct.w != ticket || cu.w != ticket) {
    queue_edge(queue, e);
    return 0;
  }
  flip_edge(mesh, e, refs, ct, cu, around);
  return go_on_around(mesh, c, ticket, around, queue);
}

// A tile of the edges to be tested, by the whole group.
static void test_tile(Mesh mesh, global uint* edge_marks, Claim c, global const uint* list, uint count, uint tile,
                      Appender illegal) {
  const uint i = tile + get_local_id(0);
  if (i < count && leaves_queue(edge_marks, list[i])) test_and_claim(mesh, c, list[i], illegal);
  append_flush(illegal, APPEND_CAPACITY / 2u);
}

// A tile of illegal edges, by the whole group. Returns the work-item's flips.
static uint flip_tile(Mesh mesh, Claim c, global const uint* illegal, uint count, uint tile, Queue queue) {
  const uint i = tile + get_local_id(0);
  const uint flips = i < count ? flip_if_won(mesh, c, illegal[i], queue) : 0u;
  append_flush(queue.list, APPEND_CAPACITY / 2u);
  return flips;
}

// ---- Rounds of one work-group ----------------------------------------------------------------------

// Lists of edges that one work-group works off by itself: those to be tested, which `tests` counts, and those that are
// illegal.
typedef struct OwnLists {
  global uint *list, *illegal;
  volatile global uint* tests;
} OwnLists;

// In local memory: the list's first edges, and how many edges are to be tested and are illegal, each for rounds of even
// and of odd numbers.
typedef struct RoundsMemory {
  local uint* items;  // APPEND_CAPACITY
  volatile local uint *tests, *found;
} RoundsMemory;

// Declared in the kernel itself, as OpenCL C 1.2 asks.
#define DECLARE_ROUNDS(name)                \
  local uint name##_items[APPEND_CAPACITY]; \
  volatile local uint name##_counts[4];     \
  const RoundsMemory name = {.items = name##_items, .tests = name##_counts, .found = name##_counts + 2}

// An edge that a work-item keeps from its test to its flip.
typedef struct Kept {
  uint e;                              // GCDT_NONE: nothing is to be flipped
  uint2 refs;                          // of its faces
  uint4 corners_t, corners_u, st, su;  // their corners and sides
} Kept;

// What is known of an edge that has two faces. What may be wanted is read at once: few edges wait for memory, and for
// nothing else.
static inline Kept keep_edge(Mesh mesh, uint e, uint2 refs) {
  const uint t = GCDT_REF_FACE(refs.x), u = GCDT_REF_FACE(refs.y);
  Kept k;
  k.e = e;
  k.refs = refs;
  k.corners_t = mesh.face_data[GCDT_CORNERS(t)];
  k.corners_u = mesh.face_data[GCDT_CORNERS(u)];
#ifdef GCDT_CONTIGUOUS
  k.st = k.su = (uint4)(0u);
#else
  k.st = mesh.face_data[GCDT_SIDES(t)];
  k.su = mesh.face_data[GCDT_SIDES(u)];
#endif
  return k;
}

// Takes e out of the queue; if it is illegal, claims its faces and keeps it.
GCDT_APART Kept test_and_keep(Mesh mesh, global uint* edge_marks, Claim c, uint e) {
  Kept k = {.e = GCDT_NONE};
  const uint marks = edge_marks[e];
  const uint2 refs = faces_of_edge(mesh, e);
  edge_marks[e] = marks & ~GCDT_MARK_QUEUED;
  if ((marks & GCDT_MARK_CONSTRAINED) || refs.x == GCDT_NONE || refs.y == GCDT_NONE) return k;
  k = keep_edge(mesh, e, refs);
  if (!is_illegal_between(mesh, refs.x, refs.y, k.corners_t, k.corners_u)) {
    k.e = GCDT_NONE;
    return k;
  }
  const uint ticket = make_ticket(c.stamp, c.bits, e);
  atomic_max(claim_word(mesh.face_data, GCDT_REF_FACE(refs.x)), ticket);
  atomic_max(claim_word(mesh.face_data, GCDT_REF_FACE(refs.y)), ticket);
  return k;
}

// Whether the illegal edge k.e, which has claimed its two faces, owns them.
static inline bool owns_faces(Mesh mesh, Claim c, Kept k) {
  const uint ticket = make_ticket(c.stamp, c.bits, k.e);
  const uint of_t = *claim_word(mesh.face_data, GCDT_REF_FACE(k.refs.x)),
             of_u = *claim_word(mesh.face_data, GCDT_REF_FACE(k.refs.y));
  return of_t == ticket && of_u == ticket;
}

// Flips the illegal edge k.e if it owns both its faces: then nobody has changed what is kept of them since it claimed
// them, whenever that was read. (If it does not, that may be worthless.) Returns the number of flips.
static inline uint flip_kept(Mesh mesh, Claim c, Kept k, bool owns, Queue queue) {
  const uint ticket = make_ticket(c.stamp, c.bits, k.e);
  if (!owns) {
    queue_edge(queue, k.e);
    return 0u;
  }
  uint around[4];
  k.corners_t.w = k.corners_u.w = ticket;
  flip_side_with(mesh, GCDT_SIDE(k.e, 0u), k.refs, k.corners_t, k.corners_u, k.st, k.su, around);
  return go_on_around(mesh, c, ticket, around, queue);
}

// Into local memory, before the first round: the list, and how long it is.
GCDT_GIVEN_LOCAL void begin_rounds(OwnLists own, RoundsMemory memory) {
  const uint me = get_local_id(0), size = (uint)get_local_size(0), begun = *own.tests;
  for (uint i = me; i < min(begun, APPEND_CAPACITY); i += size) memory.items[i] = own.list[i];
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  if (me == 0) {
    *own.tests = APPEND_CAPACITY;  // the place where append() goes on when `items` are full
    memory.tests[0] = begun;
    memory.tests[1] = memory.found[0] = memory.found[1] = 0u;
  }
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
}

// And back, after `done` rounds.
GCDT_GIVEN_LOCAL void end_rounds(OwnLists own, RoundsMemory memory, uint done) {
  const uint me = get_local_id(0), size = (uint)get_local_size(0), left = memory.tests[done & 1u];
  for (uint i = me; i < min(left, APPEND_CAPACITY); i += size) own.list[i] = memory.items[i];
  if (me == 0) *own.tests = left;
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
}

// The first half of round `done`: tests the list's edges, `tests` of them. Returns the work-item's first illegal edge;
// its others are listed.
GCDT_GIVEN_LOCAL Kept test_listed(Mesh mesh, global uint* edge_marks, Claim c, uint tests, uint done, OwnLists own,
                                  RoundsMemory memory) {
  volatile local uint* const found = memory.found + (done & 1u);
  if (get_local_id(0) == 0) {
    memory.found[~done & 1u] = 0u;
    if (tests > APPEND_CAPACITY) *own.tests = APPEND_CAPACITY;
  }
  Kept kept = {.e = GCDT_NONE};
  FOR_ALL_TILES(tile, tests) {
    const uint i = tile + get_local_id(0);
    if (i >= tests) continue;
    const Kept k = test_and_keep(mesh, edge_marks, c, i < APPEND_CAPACITY ? memory.items[i] : own.list[i]);
    if (tile == 0u)
      kept = k;
    else if (k.e != GCDT_NONE)
      own.illegal[atomic_inc(found)] = k.e;
  }
  return kept;
}

// Where the second half of round `done` queues edges.
GCDT_GIVEN_LOCAL Queue queue_of_round(global uint* edge_marks, uint done, OwnLists own, RoundsMemory memory) {
  const Appender list = {
      .items = memory.items, .gathered = memory.tests + (~done & 1u), .list = own.list, .length = own.tests};
  return make_list_queue(edge_marks, list);
}

// The second half of round `done`: flips the illegal edges, the work-item's first of them if it is kept. Returns the
// number of the work-item's flips.
GCDT_GIVEN_LOCAL uint flip_listed(Mesh mesh, Claim c, Kept kept, bool owns, uint done, OwnLists own,
                                  RoundsMemory memory, Queue queue) {
  const uint count = memory.found[done & 1u], size = (uint)get_local_size(0);
  uint flips = 0;
  if (get_local_id(0) == 0) memory.tests[done & 1u] = 0u;
  for (uint i = get_local_id(0);; i += size) {
    if (kept.e != GCDT_NONE) flips += flip_kept(mesh, c, kept, owns, queue);
    if (i >= count) return flips;
    kept = keep_edge(mesh, own.illegal[i], faces_of_edge(mesh, own.illegal[i]));
    owns = owns_faces(mesh, c, kept);
  }
}

// One work-group, all of it with the same arguments. Up to `most` rounds, of which the first tests the edges of the
// list; two barriers a round order what two kernels do otherwise, and the same arguments hold for each part. Nobody
// else touches the faces that these edges lead to. A round of few edges waits for loads that depend on one another, so
// there are few of them: each work-item keeps its first edge from test to flip, and the list and its counts stay in
// local memory. The list's edge i stands in items[i], or from APPEND_CAPACITY on in own.list[i].
//
// No race: a round tests while nobody appends to the list, and appends while nobody reads it. A count is reset in the
// other half of a round than it is read in or added to: that of illegal edges, read after the first barrier, when the
// next round tests; that of the list, read before it, when edges are flipped.
//
// Ends when the list is empty or after `most` rounds. Returns how many were done; the list is what is left.
GCDT_GIVEN_LOCAL uint flip_in_group(Mesh mesh, global uint* edge_marks, uint stamp, uint bits, uint most, OwnLists own,
                                    RoundsMemory memory, private uint* flips) {
  uint done = 0;
  begin_rounds(own, memory);
  for (;;) {
    const uint tests = memory.tests[done & 1u];
    if (tests == 0u || done == most) break;
    const Claim c = make_claim(stamp + done, bits);
    const Kept kept = test_listed(mesh, edge_marks, c, tests, done, own, memory);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    const bool owns = kept.e != GCDT_NONE && owns_faces(mesh, c, kept);
    *flips += flip_listed(mesh, c, kept, owns, done, own, memory, queue_of_round(edge_marks, done, own, memory));
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    ++done;
  }
  end_rounds(own, memory, done);
  return done;
}

#endif
