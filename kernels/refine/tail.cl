// SPDX-License-Identifier: Apache-2.0
// Rounds of refinement where a work-item is a thread: judging by the stars of new vertices (propose.h); and whole
// rounds by one work-item, the many small ones at the end, of which each would take ten launches and two reads. (On a
// GPU a round by one work-group is no faster than by launches: bench/NOTES.md.) The steps of such a round are those of
// judge.cl, refine.cl and flip.cl, one after the other, so the same is true of each, and a round does what it would do
// by launches. Barriers stand in what it has in common with kernels of groups: here they have nobody to wait for.
#include "flip/rounds.h"
#include "refine/insertion.h"
#include "refine/propose.h"
#include "refine/winners.h"

// One work-item per vertex from `first` on, `count` of them. Reads the mesh. Writes counters->lost by atomics. After:
// it is not 0 if a vertex is not found by what it was made with.
kernel void refine_find_stars(uint first, uint count, GCDT_MESH_PARAMETERS, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(i, count) {
    if (find_star(mesh, first + i) == GCDT_NONE) atomic_or(&counters->lost, 1u);
  }
}

// One work-item per face of the list `before` of the last round, and per vertex that was inserted since: `count` from
// `first` on. As refine_judge: the faces of a star that have no newer corner are those of its work-item alone.
kernel void refine_judge_stars(JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* before, global uint* bad,
                               global uint* urgency, uint were_bad, uint first, uint count) {
  Search s;
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  s.judge = judge;
  s.lists = lists;
  s.bad = bad;
  s.urgency = urgency;
  BadList list;
  begin_bad(&list);
  FOR_EACH(i, were_bad) {
    if (i + GCDT_FAR_AHEAD < were_bad) GCDT_PREFETCH(face_data + GCDT_CORNERS(bad_face(before[i + GCDT_FAR_AHEAD])));
    if (newest_corner(judge.mesh, face_data[GCDT_CORNERS(bad_face(before[i]))]) < first) keep_bad(s, before[i], &list);
  }
  FOR_EACH(i, count) judge_star(s, first + i, &list);
  end_bad(s, &list);
}

// ---- Rounds by one work-item --------------------------------------------------------------------------------

// What the steps of a round have in common.
typedef struct Round {
  Search search;
  Candidates candidates;
  Insertion insertion;
  OwnLists flips;
  volatile global RefineReport* report;
  global uint* marks;
  uint bits, last_stamp, number;  // the number: of searches before
} Round;

// A round's first half. Returns where it stops when its candidates have been found, or that it does not.
static uint search(Round r, RefineTail tail, uint most_aims, uint most_candidates, TeamMemory memory) {
  volatile global RefineReport* const report = r.report;
  wait_for_worse(r.search, report->bad, r.number, tail.idle > 0u ? 1u : 0u, memory);
  const bool aims = report->aiming <= most_aims;
  uint stage = GCDT_TAIL_JUDGE;
  if (aims) {
    aim_at_targets(r.search, report->aiming, GCDT_FACES_OF_ANY << min(tail.idle, GCDT_MOST_DOUBLINGS), r.number,
                   memory);
    find_places(r.search, report->asked, memory);
    const bool ended = report->candidates == 0u && report->aiming == report->bad && report->sitting_out == 0u;
    stage = report->failed || report->candidates > most_candidates ? GCDT_TAIL_CANDIDATES
            : ended                                                ? GCDT_TAIL_ENDED
                                                                   : GCDT_TAIL_GOES_ON;
  }
  // Of candidates that the host is left with it forgets them itself.
  if (stage != GCDT_TAIL_CANDIDATES) forget_asked(r.marks, r.search.lists.asked, report->asked);
  return stage;
}

// `won` becomes the scan of the winners by number. Returns how many there are.
static uint number_winners(volatile global uint* won, uint count) {
  uint sum = 0u;
  for (uint i = 0; i < count; ++i) {
    const uint wins = won[i];
    won[i] = sum;
    sum += wins;
  }
  won[count] = sum;
  return sum;
}

// Faces are judged for the round after one that has inserted `winners`. The lists of what is bad change places.
static void judge_for_next(Round* r, RefineTail* tail, uint winners) {
  volatile global RefineReport* const report = r->report;
  const uint were_bad = report->bad, first = tail->vertices - winners;
  begin_search(report);
  global uint* const before = r->search.bad;
  r->search.bad = r->search.chosen;
  r->search.chosen = before;
  BadList list;
  begin_bad(&list);
  for (uint i = 0; i < were_bad; ++i) {
    if (newest_corner(r->search.judge.mesh, r->search.judge.mesh.face_data[GCDT_CORNERS(bad_face(before[i]))]) < first)
      keep_bad(r->search, before[i], &list);
  }
  for (uint v = first; v < tail->vertices; ++v) judge_star(r->search, v, &list);
  end_bad(r->search, &list);
  ++tail->judgings;
  tail->judged = tail->vertices;
  tail->stamp_judged = tail->stamp;
}

// A round's second half, of so many candidates: claims, insertion, flips. Returns the number of winners.
GCDT_GIVEN_LOCAL uint insert_winners(Round* r, RefineTail* tail, uint count, local uint* before,
                                     RoundsMemory rounds_memory, TeamMemory memory) {
  volatile global uint* const won = r->candidates.won;
  const Ticket ticket = {
      .stamp = tail->stamp + 1u, .bits = r->bits, .place = 0u, .numbers = r->candidates.numbers, .won = won};
  uint flips = 0u;
  count_ranks(r->candidates, count, before);
  claim_faces(r->candidates, count, ticket, r->marks, min(r->report->blocks, r->search.blocks), r->search.cavities,
              r->search.chosen, r->report, 0u, memory);
  const uint winners = number_winners(won, count);
  begin_insertion(&r->insertion, tail->vertices, make_claim(ticket.stamp, r->bits));
  for (uint i = 0; i < count; ++i) {
    prefetch_winners(r->insertion, i, count);
    if (won[i + 1u] > won[i]) flips += insert_winner(r->insertion, i, tail->vertices + won[i]);
  }
  const uint rounds = flip_in_group(r->insertion.mesh, r->marks, ticket.stamp + 1u, r->bits,
                                    r->last_stamp - ticket.stamp, r->flips, rounds_memory, &flips);
  add_wide(&r->report->tail.flips_low, &r->report->tail.flips_high, flips);
  for (uint i = 0; i < winners; ++i) {
    if (find_star(r->insertion.mesh, tail->vertices + i) == GCDT_NONE) r->insertion.counters->lost = 1u;
  }
  tail->vertices += winners;
  tail->stamp = ticket.stamp + rounds;
  tail->candidates += count;
  tail->flip_rounds += rounds;
  ++tail->rounds;
  return winners;
}

// One work-item. The faces have been judged: `bad` lists those that are to be mended. Does up to `most_rounds` rounds,
// or fewer if one of them has more than `most_aims` aims, or more candidates than there is room for, or stamps run out.
// There is room for vertices up to `end`; `stamp` is the last stamp that was given out, `last_stamp` the last there is.
// After: report->tail says where it stopped; lists and marks are as they are there between two launches, with the list
// of what is bad in `bad` if the faces were judged an even number of times, else in `before`. No race: nobody else is
// there. Ends: rounds are counted; in a round as the kernels of each step.
kernel void refine_tail(JUDGE_PARAMETERS, LIST_PARAMETERS, global uint* edge_pieces, global const uint* sharp,
                        global uint* bad, global uint* before, global uint* urgency, global uchar* ways,
                        global uint* aiming, uint blocks, global uint* cavities, global uint* ranks,
                        volatile global uint* won, global int2* new_points, global uint4* new_origins,
                        global uint* new_sizes, global uint* queue, global uint* illegal,
                        volatile global Counters* counters, uint first, uint stamp, uint bits, uint last_stamp,
                        uint number, uint idle, uint most_rounds, uint most_aims, uint end) {
  DECLARE_TOURS(memory);
  DECLARE_ROUNDS(flips_memory);
  local uint counted[GCDT_COUNTING_TEAMS];
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  judge.edge_pieces = edge_pieces;
  judge.sharp = sharp;
  // Nobody else changes marks meanwhile, so they need not be volatile.
  global uint* const marks = (global uint*)edge_marks;
  Round r = {.report = report, .marks = marks, .bits = bits, .last_stamp = last_stamp, .number = number};
  const Search search_of = {judge, lists, bad, urgency, ways, aiming, blocks, cavities, before, 0u};
  const Candidates candidates_of = {judge.mesh, keys, candidates, numbers, ranks, won};
  r.search = search_of;
  r.candidates = candidates_of;
  r.insertion = make_insertion(judge.mesh, edge_marks, edge_pieces, queue, counters, report);
  set_candidates(&r.insertion, numbers, (global const uint*)won, ranks, candidates);
  set_vertices(&r.insertion, new_points, inputs, new_origins, judge.rules.sized, new_sizes);
  r.flips.list = queue;
  r.flips.illegal = illegal;
  r.flips.tests = &counters->list_test[0];
  RefineTail tail = {.stage = GCDT_TAIL_GOES_ON, .idle = idle, .vertices = first, .stamp = stamp};
  while (tail.stage == GCDT_TAIL_GOES_ON) {
    tail.stage = search(r, tail, most_aims, min(min(capacity, GCDT_TAIL_CANDIDATES_MOST), end - tail.vertices), memory);
    if (tail.stage == GCDT_TAIL_JUDGE || tail.stage == GCDT_TAIL_CANDIDATES) break;
    const uint count = report->candidates;
    const uint winners = count == 0u ? 0u : insert_winners(&r, &tail, count, counted, flips_memory, memory);
    ++r.number;
    ++tail.searches;
    tail.aims += report->aiming;
    tail.idle = count > 0u ? 0u : tail.idle + 1u;
    if (*r.flips.tests > 0u)
      tail.stage = GCDT_TAIL_FLIPS;
    else if (tail.stage == GCDT_TAIL_GOES_ON &&
             (tail.searches >= most_rounds || last_stamp - tail.stamp < GCDT_TAIL_STAMPS || counters->lost ||
              counters->failed || tail.idle > GCDT_MOST_DOUBLINGS))
      tail.stage = GCDT_TAIL_JUDGE;
    if (tail.stage == GCDT_TAIL_GOES_ON) judge_for_next(&r, &tail, winners);
  }
  tail.flips_low = report->tail.flips_low;
  tail.flips_high = report->tail.flips_high;
  tail.lost = counters->lost;
  report->tail = tail;
  if (counters->failed) report->failed = 1u;
}
