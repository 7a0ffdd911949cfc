// SPDX-License-Identifier: Apache-2.0
// Phase 3: parallel edge flipping with propagation (paper, section 7, algorithm 2).
//
// A round: every edge in the list is tested, and an illegal one claims its two faces (flip_test); an edge that owns
// both is flipped, and its work-item goes on flipping around it, taking faces that nobody claimed in this round by
// try-lock (flip_propagate). One round is these two kernels, or one pass of flip_rounds (flip_few.cl) or flip_problems,
// which do whole rounds inside one work-group with the same functions. On GPUs nobody goes on, but along fans in
// flip_rounds, where few edges are left and do not become fewer (slide.h).
//
// The queue: the edges to be tested next have the mark GCDT_MARK_QUEUED. While they are many, that is all, and a
// round finds them by a sweep over the marks: in order of their numbers, which is nearly the order in the plane, so
// that neighbours are tested together (sweeps.cl). When they are few they stand in a list too (flip_gather, then
// flip_test and flip_propagate).
//
// An edge that is not queued for the next round is legal or constrained. Proof: a flip puts the four edges around it
// into the local worklist or the queue; an edge leaves the worklist only if it is constrained, has no other side, is
// flipped, is legal with both its faces owned here (a later change of either is made here too, and puts it back), or
// is queued; a slide queues all edges around what it changed. An edge that is legal against a face owned elsewhere is
// queued as well: two work-items that change its two faces at the same time may each see the other's old face, both
// find it legal, and both be wrong.
#include "flip/rounds.h"

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

#ifdef GCDT_FOREST

static inline uint problem_of_face(Mesh mesh, uint face) {
  const uint v = mesh.face_data[GCDT_CORNERS(face)].x;
  return v < mesh.n ? problem_of(mesh.points, mesh.n, v) : (v - mesh.n) / 3u;
}

// The part of each list that is problem p's: as long as it has edges.
static inline uint place_of_problem(Mesh mesh, uint p) { return 3u * (first_rank(mesh.points, mesh.n, p) + p); }

// One work-item per edge. Deals those that may be flipped to the lists of their problems. (Which edges are whose is not
// said by their numbers: where constraints were enforced, problems may have exchanged slots.)
// Reads: the mesh. Writes: list, and lengths[p], which was 0, by atomic_inc, which gives each place once.
// After: list has lengths[p] edges of problem p from its place on, in any order.
kernel void flip_deal(uint edges, GCDT_MESH_PARAMETERS, global const uint* edge_marks, global uint* list,
                      volatile global uint* lengths) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(e, edges) {
    const uint2 refs = faces_of_edge(mesh, e);
    if (refs.x == GCDT_NONE || refs.y == GCDT_NONE || (edge_marks[e] & GCDT_MARK_CONSTRAINED)) continue;
    const uint p = problem_of_face(mesh, GCDT_REF_FACE(refs.x));
    list[place_of_problem(mesh, p) + atomic_inc(lengths + p)] = e;
  }
}

// One work-group per problem from `begin` up to `end`. Does up to `most` rounds, of which the first tests the edges of
// the problem's list. Reads, writes: the problem's faces and edges, its part of both lists, and lengths[p]. A problem
// has one work-group, and a flip leads to no other problem (forest.h). After: list_test[0] is greater by the problems
// that have edges left; counters->rounds is the most rounds done.
kernel void flip_problems(uint begin, uint end, uint stamp, uint bits, uint most, GCDT_MESH_PARAMETERS,
                          global uint* edge_marks, global uint* list, global uint* illegal,
                          volatile global uint* lengths, volatile global Counters* counters) {
  DECLARE_ROUNDS(memory);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  uint flips = 0, rounds = 0;
  FOR_EACH_OF_GROUPS(p, begin, end) {
    const uint place = place_of_problem(mesh, p);
    OwnLists own;
    own.list = list + place;
    own.illegal = illegal + place;
    own.tests = lengths + p;
    const uint done = flip_in_group(mesh, edge_marks, stamp, bits, most, own, memory, &flips);
    rounds = max(rounds, done);
    if (get_local_id(0) == 0 && *own.tests > 0u) atomic_inc(&counters->list_test[0]);
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) == 0) atomic_max(&counters->rounds, rounds);
}

#endif
