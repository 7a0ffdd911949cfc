// SPDX-License-Identifier: Apache-2.0
// Quality refinement, the second half of a round, a kernel a step: candidates claim their cavities, and those that hold
// all of theirs are inserted (docs/refinement.md, A).
#include "refine/insertion.h"
#include "refine/winners.h"

// One work-item per candidate, in the order of keys. The first of several with one key sorts these, and tells each its
// place in order, by number. (Candidates are claimed and inserted in the order in which they were found, which is that
// of faces: neighbours share cache lines.) All have won until claims are made. And one per subsegment that was asked
// for: its mark goes. And the counters of what follows are zeroed. No race: a run of equal keys has one first, other
// work-items write nothing of it, and each word of `won` and each mark is of one. After: candidates stand in the order
// of (key, point, ends), which does not depend on how they were found. Ends: each is moved forward at most by the
// length of its run, which is more than a few where many triangles have one target, and then nothing moves.
kernel void refine_rank(uint count, GCDT_MESH_PARAMETERS, global const ulong* keys, global const uint4* candidates,
                        global uint* numbers, global uint* ranks, global uint* won, global const uint* asked,
                        global uint* edge_marks, global const RefineReport* report, global uint* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  forget_asked(edge_marks, asked, report->asked);
  zero_counters(counters);
  FOR_EACH(i, count) {
    const u64 key = keys[i];
    won[i] = 1u;
    if (i > 0u && keys[i - 1u] == key) continue;
    uint end = i + 1u;
    for (; end < count && keys[end] == key; ++end) {
      const uint number = numbers[end];
      uint place = end;
      for (; place > i && comes_before(mesh, candidates[number], candidates[numbers[place - 1u]]); --place)
        numbers[place] = numbers[place - 1u];
      numbers[place] = number;
    }
    for (uint j = i; j < end; ++j) ranks[numbers[j]] = j;
  }
}

// One team of work-items per candidate. The same as sort and refine_rank, in one launch, for a few thousand candidates:
// its place is how many come before it. Of equal ones by keys, points and ends the one that was found first. No race:
// each candidate has a word of local memory, its place no other has, and its words of `ranks` and `won` are its own.
kernel void refine_count_ranks(uint count, GCDT_MESH_PARAMETERS, global const ulong* keys,
                               global const uint4* candidates, global uint* numbers, global uint* ranks,
                               global uint* won, global const uint* asked, global uint* edge_marks,
                               global const RefineReport* report, global uint* counters) {
  local uint before[GCDT_COUNTING_TEAMS];
  const Candidates c = {.mesh = make_mesh(n, points, face_data, edge_faces),
                        .keys = keys,
                        .candidates = candidates,
                        .numbers = numbers,
                        .ranks = ranks,
                        .won = won};
  forget_asked(edge_marks, asked, report->asked);
  zero_counters(counters);
  count_ranks(c, count, before);
}

// One work-item per candidate that is not listed (on a GPU a team of them, of up to `teamed`), and per block of the
// lists. Claims faces, the later candidate in order with precedence: tickets are places there. Reads the mesh, of
// corners not the claim word beside them. Writes claim words by atomic_max, and won[i] = 0 of those that lose, which
// were 1, by atomics; what they end with does not depend on the order. After: the faces of those with won[i] = 1 are
// disjoint; the last in order is one of them.
kernel void refine_claim(uint count, uint stamp, uint bits, GCDT_MESH_PARAMETERS, global const uint* edge_marks,
                         global const uint* numbers, global uint* ranks, global const uint4* candidates, uint blocks,
                         global const uint* cavities, global const uint* chosen, volatile global uint* won,
                         volatile global RefineReport* report, uint teamed) {
  DECLARE_TOURS(memory);
  const Candidates c = {.mesh = make_mesh(n, points, face_data, edge_faces), .candidates = candidates, .ranks = ranks};
  const Ticket t = {.stamp = stamp, .bits = bits, .place = 0u, .numbers = numbers, .won = won};
  claim_faces(c, count, t, edge_marks, blocks, cavities, chosen, report, teamed, memory);
}

// One work-item per candidate in order. Of the scan of winners by number: whether it is one. No race: its own word.
kernel void refine_in_order(uint count, global const uint* numbers, global const uint* before, global uint* won) {
  FOR_EACH(i, count) won[i] = before[numbers[i] + 1u] - before[numbers[i]];
}

// One work-item per candidate in order. Of the scan of winners in order: whether it is one of the last `most` of
// these, by number. No race: numbers are a permutation.
kernel void refine_last_in_order(uint count, uint winners, uint most, global const uint* numbers,
                                 global const uint* before, global uint* won) {
  FOR_EACH(i, count) won[numbers[i]] = before[i + 1u] > before[i] && winners - 1u - before[i] < most ? 1u : 0u;
}

// One work-item per candidate; `before` is the scan of the winners by number. Inserts them, numbers their vertices from
// `first` on in the order in which candidates were found, which is that of faces, so that what is near in the mesh is
// near in memory; and makes the stars of these Delaunay. Writes the words of its faces and edges and those that its
// vertex brings, which others do not have (L1: winners' faces are disjoint), and marks of the edges around by atomics.
// Of a face beyond these it reads whose it is, which stays, and all of it if nobody changes it. After: a valid mesh;
// edges that may be illegal are queued, and listed; list_insert[0] is the number of winners; the report is as a search
// wants it.
kernel void refine_insert(uint count, uint first, uint stamp, uint bits, uint sized, GCDT_MESH_PARAMETERS,
                          global uint* edge_marks, global uint* edge_pieces, global const uint* numbers,
                          global const uint* ranks, global const uint4* candidates, global const uint* before,
                          global int2* new_points, uint inputs, global uint4* origins, global uint* sizes,
                          global uint* queue, volatile global Counters* counters,
                          volatile global RefineReport* report) {
  local uint sum;
  Insertion in =
      make_insertion(make_mesh(n, points, face_data, edge_faces), edge_marks, edge_pieces, queue, counters, report);
  set_candidates(&in, numbers, before, ranks, candidates);
  set_vertices(&in, new_points, inputs, origins, sized, sizes);
  begin_insertion(&in, first, make_claim(stamp, bits));
  uint flips = 0;
  if (get_global_id(0) == 0) {
    counters->list_insert[0] = before[count];
    begin_search(report);
  }
  const Items items = items_of_this(count);
  FOR_ITEMS(number, items) {
    prefetch_winners(in, number, items.y);
    if (before[number + 1u] > before[number]) flips += insert_winner(in, number, first + before[number]);
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
}
