// SPDX-License-Identifier: Apache-2.0
// Phase 3: parallel edge flipping with propagation (paper, section 7, algorithm 2).
//
// A round: every edge in the list is tested, and an illegal one claims its two faces (flip_test); an edge that owns
// both is flipped, and its work-item goes on flipping around it, taking faces that nobody claimed in this round by
// try-lock (flip_propagate). One round is these two kernels, or one pass of flip_rounds or flip_problems, which do
// whole rounds inside one work-group with the same functions.
//
// The queue: the edges to be tested next have the mark GCDT_MARK_QUEUED. While they are many, that is all, and a
// round finds them by a sweep over the marks: in order of their numbers, which is nearly the order in the plane, so
// that neighbours are tested together (flip_sweep, flip_mark). When they are few they stand in a list too
// (flip_gather, then flip_test and flip_propagate).
//
// An edge that is not queued for the next round is legal or constrained. Proof: a flip puts the four edges around it
// into the local worklist or the queue; an edge leaves the worklist only if it is constrained, has no other side, is
// flipped, is legal with both its faces owned here (a later change of either is made here too, and puts it back), or
// is queued. An edge that is legal against a face owned elsewhere is queued as well: two work-items that change its
// two faces at the same time may each see the other's old face, both find it legal, and both be wrong.
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

// ---- Rounds by sweeps -----------------------------------------------------------------------------

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

// One work-item per edge. Puts those that are queued (`all`: every one) into the list for `round`, whose length was
// 0; marks stay. No race: append.h. After: list_test of the round counts the list.
kernel void flip_gather(uint all, uint edges, uint round, global const uint* edge_marks, global uint* list,
                        volatile global Counters* counters) {
  DECLARE_APPENDER(queued);
  const Appender a = make_appender(queued_items, queued_gathered, list, &counters->list_test[round % 3u]);
  FOR_EACH_TILE(tile, edges) {
    const uint e = tile + get_local_id(0);
    if (e < edges && (all || (edge_marks[e] & GCDT_MARK_QUEUED))) append(a, e);
    append_flush(a, APPEND_CAPACITY / 2u);
  }
  append_flush(a, 0u);
}

// ---- Rounds by lists ------------------------------------------------------------------------------

// One work-item per edge in list_test[round % 3]. Reads the mesh, which nobody changes in this launch.
// Writes the edge's own mark word (an edge stands in the list once), the claim words of its faces
// (atomic_max: the greatest ticket wins whatever the order) and the list of illegal edges (append.h).
// Work-item 0 empties the list that this round's flips will fill. After: an illegal edge owns its two
// faces, or one of them has a better claim.
kernel void flip_test(uint round, uint stamp, uint bits, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                      global const uint* list, global uint* illegal, volatile global Counters* counters) {
  DECLARE_APPENDER(found);
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Claim c = make_claim(stamp, bits);
  const Appender a = make_appender(found_items, found_gathered, illegal, &counters->list_flip[round & 1u]);
  const uint count = counters->list_test[round % 3u];
  if (get_global_id(0) == 0) counters->list_test[(round + 1u) % 3u] = 0u;
  FOR_EACH_TILE(tile, count) test_tile(mesh, edge_marks, c, list, count, tile, a);
  append_flush(a, 0u);
}

// One work-item per illegal edge. Writes words of faces that it owns: claimed in flip_test (both), or
// taken by try_lock; never given back in this launch, so no word has two owners (L1). A stale read
// of a face that it does not own is harmless: if the face changed in this launch it is locked and the
// try-lock fails; if not, the read is right. Mark words by atomics, the list by append.h. Work-item 0
// empties the list of illegal edges of the next round. After: every flip was of an illegal edge, and
// list_test of the next round holds every edge that may be illegal.
kernel void flip_propagate(uint round, uint stamp, uint bits, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                           global const uint* illegal, global uint* list, volatile global Counters* counters) {
  DECLARE_APPENDER(queued);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Claim c = make_claim(stamp, bits);
  const Appender a = make_appender(queued_items, queued_gathered, list, &counters->list_test[(round + 1u) % 3u]);
  const uint count = counters->list_flip[round & 1u];
  if (get_global_id(0) == 0) counters->list_flip[(round + 1u) & 1u] = 0u;
  uint flips = 0;
  FOR_EACH_TILE(tile, count) flips += flip_tile(mesh, c, illegal, count, tile, make_list_queue(edge_marks, a));
  append_flush(a, 0u);
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
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

// One work-group. Does up to `most` rounds from `round` on. After: list_test of the next round holds what is left;
// counters->rounds the rounds done.
kernel void flip_rounds(uint round, uint stamp, uint bits, uint most, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                        global uint* list, global uint* illegal, volatile global Counters* counters) {
  DECLARE_APPENDER(gathered);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const OwnLists own = {.list = list,
                        .illegal = illegal,
                        .tests = &counters->list_test[round % 3u],
                        .found = &counters->list_flip[round & 1u]};
  uint flips = 0;
  const uint done = flip_in_group(mesh, edge_marks, stamp, bits, most, own, gathered_items, gathered_gathered, &flips);
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) == 0) {
    counters->list_test[(round + done) % 3u] = *own.tests;
    counters->list_flip[0] = counters->list_flip[1] = 0u;
    counters->rounds += done;
  }
}

#ifdef GCDT_FOREST

static inline uint problem_of_face(Mesh mesh, uint face) {
  const uint v = mesh.face_data[GCDT_CORNERS(face)].x;
  return v < mesh.n ? problem_of(mesh.points, mesh.n, v) : (v - mesh.n) / 3u;
}

// The part of each list that is problem p's: as long as it has edges.
static inline uint place_of_problem(Mesh mesh, uint p) { return 3u * (first_rank(mesh.points, mesh.n, p) + p); }

// One work-item per edge. Deals those that may be flipped to the lists of their problems. (Which edges are whose is not
// said by their numbers: where constraints were enforced, problems may have exchanged slots.)
// Reads: the mesh. Writes: list, and lengths[2p], which were 0, by atomic_inc, which gives each place once.
// After: list has lengths[2p] edges of problem p from its place on, in any order.
kernel void flip_deal(uint edges, GCDT_MESH_PARAMETERS, global const uint* edge_marks, global uint* list,
                      volatile global uint* lengths) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(e, edges) {
    const uint2 refs = faces_of_edge(mesh, e);
    if (refs.x == GCDT_NONE || refs.y == GCDT_NONE || (edge_marks[e] & GCDT_MARK_CONSTRAINED)) continue;
    const uint p = problem_of_face(mesh, GCDT_REF_FACE(refs.x));
    list[place_of_problem(mesh, p) + atomic_inc(lengths + 2u * p)] = e;
  }
}

// One work-group per problem from `begin` up to `end`. Does up to `most` rounds, of which the first tests the edges of
// the problem's list. Reads, writes: the problem's faces and edges, its part of both lists, and lengths[2p], lengths[2p
// + 1], theirs. A problem has one work-group, and a flip leads to no other problem (forest.h). After: list_test[0] is
// greater by the problems that have edges left; counters->rounds is the most rounds done.
kernel void flip_problems(uint begin, uint end, uint stamp, uint bits, uint most, GCDT_MESH_PARAMETERS,
                          global uint* edge_marks, global uint* list, global uint* illegal,
                          volatile global uint* lengths, volatile global Counters* counters) {
  DECLARE_APPENDER(gathered);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  uint flips = 0, rounds = 0;
  FOR_EACH_OF_GROUPS(p, begin, end) {
    const uint place = place_of_problem(mesh, p);
    OwnLists own;
    own.list = list + place;
    own.illegal = illegal + place;
    own.tests = lengths + 2u * p;
    own.found = own.tests + 1;
    const uint done =
        flip_in_group(mesh, edge_marks, stamp, bits, most, own, gathered_items, gathered_gathered, &flips);
    rounds = max(rounds, done);
    if (get_local_id(0) == 0 && *own.tests > 0u) atomic_inc(&counters->list_test[0]);
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) == 0) atomic_max(&counters->rounds, rounds);
}

#endif
