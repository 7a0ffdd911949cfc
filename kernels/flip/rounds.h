// SPDX-License-Identifier: Apache-2.0
// Rounds of flips: what a work-item does with an edge, a group with a tile of them, and a group by itself with whole
// rounds. flip.cl has the rounds, and why they are right. OpenCL C only.
#ifndef GCDT_ROUNDS_H
#define GCDT_ROUNDS_H

#include "common/append.h"
#include "flip/flip.h"

// Where edges go that are to be tested in the next round: their marks and, if `listed`, a list.
typedef struct Queue {
  volatile global uint* marks;
  bool listed;
  Appender list;
} Queue;

GCDT_GIVEN_LOCAL Queue make_list_queue(volatile global uint* marks, Appender list) {
  const Queue q = {.marks = marks, .listed = true, .list = list};
  return q;
}

static inline Queue make_mark_queue(volatile global uint* marks) {
  const Queue q = {.marks = marks, .listed = false};
  return q;
}

// Into the list at most once: the mark bit decides by atomic_or.
static inline void queue_edge(Queue q, uint e) {
  const uint old = atomic_or(q.marks + e, GCDT_MARK_QUEUED);
  if (q.listed && !(old & GCDT_MARK_QUEUED)) append(q.list, e);
}

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
#if GCDT_FLIP_CHAIN > 1
  return propagate(mesh, c, ticket, around, queue);
#else
  // A constrained edge leaves the queue unseen.
  for (uint i = 0; i < 4u; ++i) queue_edge(queue, GCDT_SIDE_EDGE(around[i]));
  return 1;
#endif
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

// Lists of edges that one work-group works off by itself, and how long they are.
typedef struct OwnLists {
  global uint *list, *illegal;
  volatile global uint *tests, *found;
} OwnLists;

// One work-group, all of it with the same arguments. Up to `most` rounds, of which the first tests the edges of the
// list; barriers order what two kernels do otherwise, and the same arguments hold for each part. Nobody else touches
// the faces that these edges lead to. Ends when the list is empty or after `most` rounds. Returns how many were done;
// the list is what is left.
GCDT_GIVEN_LOCAL uint flip_in_group(Mesh mesh, global uint* edge_marks, uint stamp, uint bits, uint most, OwnLists own,
                                    local uint* items, local uint* gathered, private uint* flips) {
  uint done = 0;
  for (;;) {
    const uint tests = *own.tests;
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (tests == 0u || done == most) break;
    const Claim c = make_claim(stamp + done, bits);
    if (get_local_id(0) == 0) {
      *own.tests = 0u;
      *own.found = 0u;
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    const Appender illegal = make_appender(items, gathered, own.illegal, own.found);
    FOR_ALL_TILES(tile, tests) test_tile(mesh, edge_marks, c, own.list, tests, tile, illegal);
    append_flush(illegal, 0u);
    barrier(CLK_GLOBAL_MEM_FENCE);
    const uint count = *own.found;
    const Appender queue = make_appender(items, gathered, own.list, own.tests);
    FOR_ALL_TILES(tile, count) {
      *flips += flip_tile(mesh, c, own.illegal, count, tile, make_list_queue(edge_marks, queue));
    }
    append_flush(queue, 0u);
    barrier(CLK_GLOBAL_MEM_FENCE);
    ++done;
  }
  return done;
}

#endif
