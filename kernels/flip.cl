// SPDX-License-Identifier: Apache-2.0
// Phase 3: parallel edge flipping with propagation (paper, section 7, algorithm 2).
//
// A round: every edge in the list is tested, and an illegal one claims its two faces (flip_test); an
// edge that owns both is flipped, and its work-item goes on flipping around it, taking faces that
// nobody claimed in this round by try-lock (flip_propagate). One round is these two kernels, or one
// pass of flip_rounds, which does whole rounds inside one work-group with the same functions.
//
// Lists: an edge that is not in the list for the next round is legal or constrained. Proof: a flip puts
// the four edges around it into the local worklist or the list; an edge leaves the worklist only if
// it is constrained, has no other side, is flipped, is legal with both its faces owned here (a later
// change of either is made here too, and puts it back), or is put into the list. An edge that is legal
// against a face owned elsewhere goes into the list as well: two work-items that change its two
// faces at the same time may each see the other's old face, both find it legal, and both be wrong.
#include "append.h"
#include "mesh.h"

#ifndef GCDT_FLIP_WORKLIST
#define GCDT_FLIP_WORKLIST 8  // edges remembered by a propagating work-item (paper, 7.2: 8 is enough)
#endif
#ifndef GCDT_FLIP_CHAIN
#define GCDT_FLIP_CHAIN 32  // flips of one work-item in one round at most: bounds the launch
#endif

typedef struct Claim {
  u32 stamp, bits;
} Claim;

static inline Claim make_claim(uint stamp, uint bits) {
  Claim c;
  c.stamp = stamp;
  c.bits = bits;
  return c;
}

static inline bool claimed_now(uint word, Claim c) { return (word >> c.bits) == c.stamp; }

// Is the edge with face references `near` and `far` illegal? Reads of a far face that another
// work-item is changing give a worthless answer: the caller must own the face before acting on it.
static bool is_illegal(Mesh mesh, uint near, uint far) {
  const uint4 c = rotate_to(mesh.corners[GCDT_REF_FACE(near)], GCDT_REF_CORNER(near));
  const uint d = element(mesh.corners[GCDT_REF_FACE(far)], GCDT_REF_CORNER(far));
  return gcdt_must_flip(load_vertex(mesh.points, mesh.n, c.z), load_vertex(mesh.points, mesh.n, c.x),
                        load_vertex(mesh.points, mesh.n, c.y), load_vertex(mesh.points, mesh.n, d));
}

//   before: t = (b, x, y), u = (d, y, x)        after: t = (b, x, d), u = (d, y, b)
//        b                                            b
//      / t \        edges of t: e, ex (y-b), ey (b-x)   /|\      t: (f_y, e, e_y)
//     x-----y       edges of u: e, fy (x-d), fx (d-y)  x t|u y    u: (e_x, e, f_x)
//      \ u /                                            \|/
//        d                                              d
// Writes only words of the two faces, which the caller owns (L1). The claim words keep `ticket`.
// `around` gets the owned sides' codes of the four edges around.
static void flip_edge(Mesh mesh, uint e, uint ticket, private uint* around) {
  const uint ref0 = mesh.edge_faces[2u * e], ref1 = mesh.edge_faces[2u * e + 1u];
  const uint t = GCDT_REF_FACE(ref0), u = GCDT_REF_FACE(ref1);
  const uint4 ct = rotate_to(mesh.corners[t], GCDT_REF_CORNER(ref0)),
              st = rotate_to(mesh.sides[t], GCDT_REF_CORNER(ref0));
  const uint4 cu = rotate_to(mesh.corners[u], GCDT_REF_CORNER(ref1)),
              su = rotate_to(mesh.sides[u], GCDT_REF_CORNER(ref1));
  mesh.corners[t] = (uint4)(ct.x, ct.y, cu.x, ticket);
  mesh.corners[u] = (uint4)(cu.x, ct.z, ct.x, ticket);
  mesh.sides[t] = (uint4)(su.y, GCDT_SIDE(e, 0u), st.z, 0u);
  mesh.sides[u] = (uint4)(st.y, GCDT_SIDE(e, 1u), su.z, 0u);
  mesh.edge_faces[2u * e] = GCDT_FACE_REF(t, 1u);
  mesh.edge_faces[2u * e + 1u] = GCDT_FACE_REF(u, 1u);
  mesh.edge_faces[su.y] = GCDT_FACE_REF(t, 0u);
  mesh.edge_faces[st.z] = GCDT_FACE_REF(t, 2u);
  mesh.edge_faces[st.y] = GCDT_FACE_REF(u, 0u);
  mesh.edge_faces[su.z] = GCDT_FACE_REF(u, 2u);
  around[0] = su.y;
  around[1] = st.z;
  around[2] = st.y;
  around[3] = su.z;
}

// Puts e into the list once: the mark bit decides by atomic_or.
static void queue_edge(uint e, volatile global uint* edge_marks, Appender queue) {
  if (!(atomic_or(edge_marks + e, GCDT_MARK_QUEUED) & GCDT_MARK_QUEUED)) append(queue, e);
}

// Takes the face for this round. Fails if anyone has claimed or locked it in this round; a claim is
// never given back within a round, so a face taken here was not changed since the round began.
static bool try_lock(Mesh mesh, uint face, uint ticket, Claim c) {
  volatile global uint* word = claim_word(mesh.corners, face);
  const uint old = *word;
  return !claimed_now(old, c) && atomic_cmpxchg(word, old, ticket) == old;
}

static void test_and_claim(Mesh mesh, global uint* edge_marks, Claim c, uint e, Appender illegal) {
  const uint marks = edge_marks[e];
  edge_marks[e] = marks & ~GCDT_MARK_QUEUED;
  if (marks & GCDT_MARK_CONSTRAINED) return;
  const uint near = mesh.edge_faces[2u * e], far = mesh.edge_faces[2u * e + 1u];
  if (near == GCDT_NONE || far == GCDT_NONE || !is_illegal(mesh, near, far)) return;
  const uint ticket = make_ticket(c.stamp, c.bits, e);
  atomic_max(claim_word(mesh.corners, GCDT_REF_FACE(near)), ticket);
  atomic_max(claim_word(mesh.corners, GCDT_REF_FACE(far)), ticket);
  append(illegal, e);
}

// Flips e, which owns both its faces under `ticket`, and what follows from it. Ends: every pass takes
// an edge from the worklist, and edges are added only by flips, at most GCDT_FLIP_CHAIN.
static uint flip_and_propagate(Mesh mesh, volatile global uint* edge_marks, Claim c, uint e, uint ticket,
                               Appender queue) {
  uint work[GCDT_FLIP_WORKLIST];
  uint around[4];
  uint size = 0, flips = 1;
  flip_edge(mesh, e, ticket, around);
  for (uint i = 0; i < 4u; ++i) work[size++] = around[i];
  while (size > 0u) {
    const uint code = work[--size];
    const uint edge = GCDT_SIDE_EDGE(code);
    if (edge_marks[edge] & GCDT_MARK_CONSTRAINED) continue;
    if (flips == GCDT_FLIP_CHAIN) {
      queue_edge(edge, edge_marks, queue);
      continue;
    }
    const uint near = mesh.edge_faces[code], far = mesh.edge_faces[code ^ 1u];
    if (far == GCDT_NONE) continue;
    const uint face = GCDT_REF_FACE(far);
    const bool owned = *claim_word(mesh.corners, face) == ticket;
    const bool illegal = is_illegal(mesh, near, far);
    if (owned && !illegal) continue;
    if (!illegal || (!owned && !try_lock(mesh, face, ticket, c))) {
      queue_edge(edge, edge_marks, queue);
      continue;
    }
    flip_edge(mesh, edge, ticket, around);
    ++flips;
    for (uint i = 0; i < 4u; ++i) {
      if (size < GCDT_FLIP_WORKLIST)
        work[size++] = around[i];
      else
        queue_edge(GCDT_SIDE_EDGE(around[i]), edge_marks, queue);
    }
  }
  return flips;
}

static uint flip_if_won(Mesh mesh, volatile global uint* edge_marks, Claim c, uint e, Appender queue) {
  const uint ticket = make_ticket(c.stamp, c.bits, e);
  const uint t = GCDT_REF_FACE(mesh.edge_faces[2u * e]), u = GCDT_REF_FACE(mesh.edge_faces[2u * e + 1u]);
  if (*claim_word(mesh.corners, t) == ticket && *claim_word(mesh.corners, u) == ticket)
    return flip_and_propagate(mesh, edge_marks, c, e, ticket, queue);
  queue_edge(e, edge_marks, queue);
  return 0;
}

static void test_tiles(Mesh mesh, global uint* edge_marks, Claim c, global const uint* list, uint count,
                       Appender illegal) {
  FOR_EACH_TILE(tile, count) {
    const uint i = tile + get_local_id(0);
    if (i < count) test_and_claim(mesh, edge_marks, c, list[i], illegal);
    append_flush(illegal, APPEND_CAPACITY / 2u);
  }
  append_flush(illegal, 0u);
}

static uint flip_tiles(Mesh mesh, volatile global uint* edge_marks, Claim c, global const uint* illegal, uint count,
                       Appender queue) {
  uint flips = 0;
  FOR_EACH_TILE(tile, count) {
    const uint i = tile + get_local_id(0);
    if (i < count) flips += flip_if_won(mesh, edge_marks, c, illegal[i], queue);
    append_flush(queue, APPEND_CAPACITY / 2u);
  }
  append_flush(queue, 0u);
  return flips;
}

// One work-item per edge of the mesh so far. Writes the list of all edges; work-item 0 its length.
// No race: each its own word. After: list_test[0] edges are to be tested in round 0.
kernel void flip_seed(uint edges, global uint* list, volatile global Counters* counters) {
  for (uint e = get_global_id(0); e < edges; e += get_global_size(0)) list[e] = e;
  if (get_global_id(0) == 0) {
    counters->list_test[0] = edges;
    counters->list_test[1] = 0u;
    counters->list_test[2] = 0u;
    counters->list_flip[0] = 0u;
    counters->list_flip[1] = 0u;
  }
}

// One work-item per edge in list_test[round % 3]. Reads the mesh, which nobody changes in this launch.
// Writes the edge's own mark word (an edge stands in the list once), the claim words of its faces
// (atomic_max: the greatest ticket wins whatever the order) and the list of illegal edges (append.h).
// Work-item 0 empties the list that this round's flips will fill. After: an illegal edge owns its two
// faces, or one of them has a better claim.
kernel void flip_test(uint round, uint stamp, uint bits, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                      global const uint* list, global uint* illegal, volatile global Counters* counters) {
  DECLARE_APPENDER(found);
  const Mesh mesh = make_mesh(n, points, corners, sides, edge_faces);
  const Claim c = make_claim(stamp, bits);
  const Appender a = make_appender(found_items, found_gathered, illegal, &counters->list_flip[round & 1u]);
  const uint count = counters->list_test[round % 3u];
  if (get_global_id(0) == 0) counters->list_test[(round + 1u) % 3u] = 0u;
  test_tiles(mesh, edge_marks, c, list, count, a);
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
  const Mesh mesh = make_mesh(n, points, corners, sides, edge_faces);
  const Claim c = make_claim(stamp, bits);
  const Appender a = make_appender(queued_items, queued_gathered, list, &counters->list_test[(round + 1u) % 3u]);
  const uint count = counters->list_flip[round & 1u];
  if (get_global_id(0) == 0) counters->list_flip[(round + 1u) & 1u] = 0u;
  const uint flips = flip_tiles(mesh, edge_marks, c, illegal, count, a);
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
}

// One work-group. Does up to `most` rounds from `round` on; barriers order what two kernels do
// otherwise, and the same arguments hold for each part. Ends when the list is empty or after `most`
// rounds. After: list_test of the next round holds what is left; counters->rounds the rounds done.
kernel void flip_rounds(uint round, uint stamp, uint bits, uint most, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                        global uint* list, global uint* illegal, volatile global Counters* counters) {
  DECLARE_APPENDER(gathered);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, corners, sides, edge_faces);
  uint flips = 0, done = 0;
  for (;;) {
    const uint now = round + done;
    const uint tests = counters->list_test[now % 3u];
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (tests == 0u || done == most) break;
    const Claim c = make_claim(stamp + done, bits);
    if (get_local_id(0) == 0) counters->list_test[(now + 1u) % 3u] = 0u;
    const Appender found = make_appender(gathered_items, gathered_gathered, illegal, &counters->list_flip[now & 1u]);
    test_tiles(mesh, edge_marks, c, list, tests, found);
    barrier(CLK_GLOBAL_MEM_FENCE);
    const uint count = counters->list_flip[now & 1u];
    if (get_local_id(0) == 0) counters->list_flip[(now + 1u) & 1u] = 0u;
    const Appender queue =
        make_appender(gathered_items, gathered_gathered, list, &counters->list_test[(now + 1u) % 3u]);
    flips += flip_tiles(mesh, edge_marks, c, illegal, count, queue);
    barrier(CLK_GLOBAL_MEM_FENCE);
    ++done;
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) == 0) counters->rounds += done;
}
