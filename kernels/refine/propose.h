// SPDX-License-Identifier: Apache-2.0
// The search for candidates, the first half of a round of refinement: which triangles and subsegments are to be mended,
// and by which vertices (docs/refinement.md, A). Nothing of the mesh changes but marks. judge.cl has a kernel for each
// step, and says why it has no race; tail.cl does them one after the other. OpenCL C only.
#ifndef GCDT_PROPOSE_H
#define GCDT_PROPOSE_H

#include "refine/breadth.h"
#include "refine/team.h"
#include "refine/wait.h"

#define LIST_PARAMETERS                                                                                  \
  uint capacity, global uint *asked, global ulong *keys, global uint *numbers, global uint4 *candidates, \
      volatile global RefineReport *report

#define MAKE_LISTS(lists)        \
  Lists lists;                   \
  lists.marks = edge_marks;      \
  lists.asked = asked;           \
  lists.keys = keys;             \
  lists.numbers = numbers;       \
  lists.candidates = candidates; \
  lists.capacity = capacity;     \
  lists.report = report

typedef struct Search {
  Judge judge;
  Lists lists;
  global uint *bad, *urgency;
  global uchar* ways;
  global uint* aiming;
  uint blocks;
  global uint *cavities, *chosen;
  uint teamed;  // tours of a launch that teams make at most
} Search;

// ---- Judging ------------------------------------------------------------------------------------------------

// Asks for the subsegments among the face's sides that have its other corner in their lens. Returns whether there are
// any that may be split.
static bool ask_for_encroached(Judge judge, uint face, Lists lists) {
  const uint4 c = judge.mesh.face_data[GCDT_CORNERS(face)], s = judge.mesh.face_data[GCDT_SIDES(face)];
  bool any = false;
  for (uint k = 0; k < 3u; ++k) {
    const uint code = element(s, k);
    if (!is_constrained(judge.marks, code) ||
        !gcdt_in_lens(judge.rules, corner_vertex(judge.mesh, c, next_corner(k)),
                      corner_vertex(judge.mesh, c, previous_corner(k)), corner_vertex(judge.mesh, c, k)) ||
        !may_split(judge.mesh, judge.rules, code))
      continue;
    ask(lists, GCDT_SIDE_EDGE(code));
    any = true;
  }
  return any;
}

// In the list of what is bad: the face, and whether it asks for subsegments, in every round anew while they are there.
#define BAD_ASKS 0x80000000u
#define GCDT_BAD_HELD 64u
static inline uint bad_face(uint bad) { return bad & ~BAD_ASKS; }

// Puts into that list. Threads take room for several at once: they would wait for each other at one word.
typedef struct BadList {
#ifdef GCDT_CONTIGUOUS
  uint held, entries[GCDT_BAD_HELD];
#else
  uint none;
#endif
} BadList;

static inline void begin_bad(private BadList* list) {
#ifdef GCDT_CONTIGUOUS
  list->held = 0u;
#else
  list->none = 0u;
#endif
}

// What is held goes into the list, at places that an atomic gives.
static inline void end_bad(Search s, private BadList* list) {
#ifdef GCDT_CONTIGUOUS
  const uint place = list->held > 0u ? atomic_add(&s.lists.report->bad, list->held) : 0u;
  for (uint i = 0; i < list->held; ++i) s.bad[place + i] = list->entries[i];
  list->held = 0u;
#else
  (void)s;
  (void)list;
#endif
}

static inline void add_bad(Search s, uint bad, private BadList* list) {
#ifdef GCDT_CONTIGUOUS
  list->entries[list->held++] = bad;
  if (list->held == GCDT_BAD_HELD) end_bad(s, list);
#else
  (void)list;
  s.bad[atomic_inc(&s.lists.report->bad)] = bad;
#endif
}

// A face that was bad, and has not changed.
static void keep_bad(Search s, uint bad, private BadList* list) {
  if (bad & BAD_ASKS) ask_for_encroached(s.judge, bad_face(bad), s.lists);
  add_bad(s, bad, list);
}

// A face that may have changed. What it is depends on itself alone. A new triangle is in the way of others; others keep
// what their aims have found.
static void judge_anew(Search s, uint t, bool is_new, private BadList* list) {
  if (label_of(s.judge.mesh, t) == 0u) {
    s.urgency[t] = 0u;
    return;
  }
  const bool encroached = ask_for_encroached(s.judge, t, s.lists);
  const Judged j = judge_face(s.judge, t);
  const uint verdict = j.verdict, own = verdict == VERDICT_SHARP ? urgency_of(s.judge.mesh, j) : 0u;
  s.urgency[t] = (own << URGENCY_BITS) | (is_new ? URGENCY_IN_THE_WAY : s.urgency[t] & ((1u << URGENCY_BITS) - 1u));
  if (encroached || verdict == VERDICT_SHARP || verdict == VERDICT_LARGE)
    add_bad(s, encroached ? t | BAD_ASKS : t, list);
}

// ---- Judging by stars ---------------------------------------------------------------------------------------
// Where a work-item is a thread, a sweep over all faces takes longer than all else that most rounds do. The faces that
// may have changed are those that were bad, and the stars of the vertices that the round has inserted: what a round
// makes is joined to one of its vertices. But a face beyond a subsegment that was split beside it has another side now,
// and a vertex may have lost all faces and edges that it was made with. Both are rare; then Counters::lost says so, and
// all faces are gone through.

// A face with the vertex, and its corner there, among those that it was made with; GCDT_NONE: flips have taken all.
static uint find_star(Mesh mesh, uint v) {
  for (uint i = 0; i < 8u; ++i) {
    const uint face =
        i < 2u ? new_face(mesh, v, i) : GCDT_REF_FACE(mesh.edge_faces[2u * new_edge(mesh, v, 0u) + i - 2u]);
    const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
    for (uint k = 0; k < 3u; ++k)
      if (element(c, k) == v) return GCDT_FACE_REF(face, k);
  }
  return GCDT_NONE;
}

// The vertex with the greatest number among the corners that are no symbolic ones; 0 if there is none.
static inline uint newest_corner(Mesh mesh, uint4 c) {
  return max(max(c.x < mesh.n ? c.x : 0u, c.y < mesh.n ? c.y : 0u), c.z < mesh.n ? c.z : 0u);
}

// Judges the faces around v of which no corner is newer: so each changed face is judged once. Ends: a tour around a
// vertex; `steps` stops a mesh that is wrong.
GCDT_APART void judge_star(Search s, uint v, private BadList* list) {
  const Mesh mesh = s.judge.mesh;
  const uint first = find_star(mesh, v);
  uint ref = first;
  for (uint steps = 2u * gcdt_forest_faces(mesh.n, 1u); steps > 0u; --steps) {
    const uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
    const uint next = mesh.edge_faces[face_side(mesh, face, next_corner(k)) ^ 1u];
    GCDT_PREFETCH(mesh.face_data + GCDT_CORNERS(GCDT_REF_FACE(next)));
    if (newest_corner(mesh, mesh.face_data[GCDT_CORNERS(face)]) == v) judge_anew(s, face, true, list);
    ref = GCDT_FACE_REF(GCDT_REF_FACE(next), next_corner(GCDT_REF_CORNER(next)));
    if (ref == first) return;
  }
  atomic_or(&s.lists.report->failed, 1u);
}

// ---- Waiting ------------------------------------------------------------------------------------------------

// Tells the host that a cavity was too large for its triangle this round. Most find it told; the word only becomes 1,
// so who reads it too early sets it again.
static inline void sit_out(volatile global RefineReport* report) {
  if (report->sitting_out == 0u) atomic_or(&report->sitting_out, 1u);
}

// A triangle that need not wait and has not lost the draw aims. The host needs no word about the others: it sees that
// fewer have aimed than are bad.
static inline void take_turn(Search s, uint face) { s.aiming[atomic_inc(&s.lists.report->aiming)] = face; }

// What triangles of the same share will ask for: themselves, and then the side where their way begins.
static inline void prefetch_ways(Search s, uint i, uint end) {
#ifdef GCDT_PREFETCHES
  const Mesh mesh = s.judge.mesh;
  if (i + GCDT_FAR_AHEAD < end) {
    const uint face = bad_face(s.bad[i + GCDT_FAR_AHEAD]);
    GCDT_PREFETCH(mesh.face_data + GCDT_SIDES(face));
    GCDT_PREFETCH(s.urgency + face);
    GCDT_PREFETCH(s.ways + face);
  }
  if (i + GCDT_AHEAD < end) {
    const uint face = bad_face(s.bad[i + GCDT_AHEAD]), code = face_side(mesh, face, first_side(s.ways[face]));
    GCDT_PREFETCH(mesh.edge_faces + (code ^ 1u));
    GCDT_PREFETCH(s.judge.marks + GCDT_SIDE_EDGE(code));
  }
#else
  (void)s;
  (void)i;
  (void)end;
#endif
}

// refine_wait. Who loses the draw need not look whether it has to wait. All triangles are looked at by one work-item
// each, or none are and teams do it, which is why these are two loops. That of teams stands last, and behind no branch:
// where a branch has barriers, PoCL 3.1 gives work-items wrong numbers after it (docs/devices.md).
GCDT_GIVEN_LOCAL void wait_for_worse(Search s, uint count, uint round, uint all, TeamMemory memory) {
#ifdef GCDT_GPU
  const uint alone = count <= s.teamed ? 0u : count;
#else
  const uint alone = count;
#endif
  const Items share = items_of_this(alone);
  FOR_ITEMS(i, share) {
    prefetch_ways(s, i, share.y);
    const uint face = bad_face(s.bad[i]);
    if (all || !loses(s.judge.mesh, s.judge.marks, face, round, s.urgency)) {
      const uint found = way_to_worse(s.judge.mesh, s.judge.marks, face, s.ways[face], s.urgency);
      s.ways[face] = (uchar)found;
      if (found == GCDT_NO_WAY) take_turn(s, face);
    }
  }
#ifdef GCDT_GPU
  volatile local uint* const found = memory.found;
  const uint items = (uint)get_local_size(0), lanes = min(WAITING_TEAM, items),
             teams = min(WAITING_TEAMS, items / lanes);
  const uint team = (uint)get_local_id(0) / lanes, lane = (uint)get_local_id(0) % lanes;
  FOR_EACH_TILE_OF(tile, teams, count - alone) {
    const uint i = tile + team;
    const bool is_one = team < teams && i < count;
    const uint face = is_one ? bad_face(s.bad[i]) : 0u;
    const bool asks = is_one && (all || !loses(s.judge.mesh, s.judge.marks, face, round, s.urgency));
    const uint own = asks ? s.urgency[face] >> URGENCY_BITS : 0u;
    if (asks && lane == 0u)
      found[team] = own > 0u && leads_to_worse(s.judge.mesh, s.judge.marks, face, s.ways[face], own, s.urgency)
                        ? s.ways[face]
                        : GCDT_NO_WAY;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (own > 0u && found[team] == GCDT_NO_WAY)
      for (uint k = lane; k < 6u; k += lanes) {
        const uint way = way_by(s.judge.mesh, s.judge.marks, face, k / 2u, k % 2u, own, s.urgency);
        if (way != GCDT_NO_WAY) atomic_xchg(found + team, way);
      }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (asks && lane == 0u) {
      s.ways[face] = (uchar)found[team];
      if (found[team] == GCDT_NO_WAY) take_turn(s, face);
    }
  }
#endif
}

// ---- Aims ---------------------------------------------------------------------------------------------------

// What comes of an aim: the triangle sits out, or subsegments are asked for, or there is a candidate, whose number is
// returned, or nothing. `asks`: whether the subsegments in the way are still to be asked for.
static uint conclude(Judge judge, Lists lists, global uint* urgency, uint face, uint number, Judged j, Aim aim,
                     bool asks, uint listed) {
  if (aim.failed) atomic_or(&lists.report->failed, 1u);
  if (aim.sits_out) {
    urgency[face] = with_handicap(urgency[face], number);
    sit_out(lists.report);
    return GCDT_NONE;
  }
  if (asks && aim.in_way > 0u) ask_for_way(judge, aim, lists);
  if (!aim.wanted) {
    urgency[face] &= ~URGENCY_IN_THE_WAY;
    return GCDT_NONE;
  }
  const bool on_edge = aim.at.kind == GCDT_AT_EDGE;
  const uint what = on_edge ? element(judge.mesh.face_data[GCDT_SIDES(aim.at.face)], aim.at.corner) : aim.at.face;
  return add_candidate(lists, gcdt_candidate_key(0u, j.shape.shortest, gcdt_badness(j.shape), aim.target), aim.target,
                       what, (on_edge ? GCDT_ON_EDGE : GCDT_IN_FACE) | listed | (aim.tied ? GCDT_TIED : 0u));
}

static inline bool is_to_be_mended(Judged j) { return j.verdict == VERDICT_SHARP || j.verdict == VERDICT_LARGE; }

#ifdef GCDT_CONTIGUOUS
// The tour for an aim by a thread, that with number `owner`. Returns GCDT_LISTED if the cavity's faces are listed.
static uint tour_by_thread(Search s, Judged j, Aim* aim, ulong most, uint owner) {
  BreadthTour tour;
  tour_by_breadth(s.judge, &j, aim->at.face, aim->target, most, &tour);
  if (tour.full) {
    tour_cavity(s.judge, j, aim, false, most, 0, s.lists);
    return 0u;
  }
  aim->sits_out = tour.out;
  if (tour.out) return 0u;
  aim->tied = tour.tied;
  aim->in_way += tour.in_way;
  aim->fixed += tour.fixed;
  aim->wanted = !tour.near && aim->in_way == 0u && aim->fixed == 0u;
  return aim->wanted ? list_faces(&tour, owner, s.cavities, s.blocks, s.lists.report) : 0u;
}
#endif

#ifndef GCDT_GPU
// The aim with number i.
GCDT_APART void aim_at_target(Search s, uint i, uint most, uint round) {
  const uint t = s.aiming[i];
  s.chosen[i] = GCDT_NONE;
  const Judged j = judge_face(s.judge, t);
  if (!is_to_be_mended(j)) return;
  const uint number = draw(s.judge.mesh, j.corners, round);
  Aim aim = begin_aim(s.judge, t, j, false);
  uint listed = 0u;
  if (has_cavity(aim)) {
#ifdef GCDT_CONTIGUOUS
    listed = tour_by_thread(s, j, &aim, (ulong)most << number, i);
#else
    CavityList cavity = begin_list(s.cavities, s.blocks, i);
    tour_cavity(s.judge, j, &aim, false, (ulong)most << number, &cavity, s.lists);
    listed = aim.wanted ? end_list(&cavity) : 0u;
#endif
  }
  const uint candidate = conclude(s.judge, s.lists, s.urgency, t, number, j, aim, true, listed);
  if (listed) s.chosen[i] = candidate;
}
#endif

// refine_aim.
GCDT_GIVEN_LOCAL void aim_at_targets(Search s, uint count, uint most, uint round, TeamMemory memory) {
#ifdef GCDT_GPU
  const TeamOf of = team_of(memory.teams, count, s.teamed);
  const TeamList list = {.words = s.cavities, .blocks = s.blocks, .report = s.lists.report};
  const Ticket nothing = {.stamp = 0u, .bits = 0u, .place = 0u, .numbers = 0, .won = 0};
  FOR_EACH_TILE_OF(tile, of.at_once, count) {
    const uint i = tile + of.number;
    Judged j;
    Aim aim;
    uint t = 0u, number = 0u, listed = 0u;
    bool aims = false, tours = false;
    if (of.leads && of.member) of.team->pending = 0u;
    if (of.leads && i < count) {
      t = s.aiming[i];
      s.chosen[i] = GCDT_NONE;
      j = judge_face(s.judge, t);
      aims = is_to_be_mended(j);
      if (aims) {
        number = draw(s.judge.mesh, j.corners, round);
        aim = begin_aim(s.judge, t, j, false);
        tours = has_cavity(aim);
      }
    }
    if (tours && of.member) {
      begin_team(of.team, aim.target, (ulong)most << number, i);
      of.team->verdict = j.verdict;
      of.team->shortest = j.shape.shortest;
      add_root(s.judge.mesh, of.team, aim.at.face, true, list, nothing);
    }
    tour_by_teams(of, s.judge, list, nothing, memory.busy);
    if (aims) {
      bool asks = true;
      if (tours && (of.alone || (of.team->flags & TEAM_FULL))) {
        CavityList cavity = begin_list(s.cavities, s.blocks, i);
        tour_cavity(s.judge, j, &aim, false, (ulong)most << number, of.alone ? &cavity : 0, s.lists);
        listed = of.alone && aim.wanted ? end_list(&cavity) : 0u;
      } else if (tours) {
        asks = end_team(of.team, &aim, s.lists, s.cavities, &listed);
      }
      const uint candidate = conclude(s.judge, s.lists, s.urgency, t, number, j, aim, asks, listed);
      if (listed) s.chosen[i] = candidate;
    }
  }
#else
  (void)memory;
  FOR_EACH(i, count) {
    if (i + 1u < count) GCDT_PREFETCH(s.judge.mesh.face_data + GCDT_CORNERS(s.aiming[i + 1u]));
    aim_at_target(s, i, most, round);
  }
#endif
}

// ---- Places -------------------------------------------------------------------------------------------------

// Puts the place into the list of candidates, if there is one. Returns its number, or GCDT_NONE.
static uint add_place(Lists lists, Place place, uint edge) {
  if (!place.found) {
    atomic_inc(&lists.report->refused);
    return GCDT_NONE;
  }
  return add_candidate(lists, gcdt_candidate_key(1u, place.squared, 0u, place.at), place.at, edge,
                       place.far ? GCDT_ON_SUBSEGMENT | GCDT_FAR : GCDT_ON_SUBSEGMENT);
}

// refine_place. Where there are teams, each lists what its candidate claims.
GCDT_GIVEN_LOCAL void find_places(Search s, uint count, TeamMemory memory) {
#ifdef GCDT_GPU
  const TeamOf of = team_of(memory.teams, count, s.teamed);
  const TeamList list = {.words = s.cavities, .blocks = s.blocks, .report = s.lists.report};
  const Ticket nothing = {.stamp = 0u, .bits = 0u, .place = 0u, .numbers = 0, .won = 0};
  FOR_EACH_TILE_OF(tile, of.at_once, count) {
    const uint i = tile + of.number;
    uint candidate = GCDT_NONE;
    if (of.leads && of.member) of.team->pending = 0u;
    if (of.leads && i < count) candidate = add_place(s.lists, find_place(s.judge, s.lists.asked[i]), s.lists.asked[i]);
    const bool tours = of.member && candidate < s.lists.capacity;
    if (tours) {
      const uint4 what = s.lists.candidates[candidate];
      begin_team(of.team, candidate_point(what), ~0ul, GCDT_OF_SUBSEGMENT | candidate);
      add_roots(s.judge.mesh, of.team, what, list, nothing);
    }
    tour_by_teams(of, s.judge, list, nothing, memory.busy);
    if (tours) s.lists.candidates[candidate].w |= end_team_list(of.team, s.cavities);
  }
#else
  (void)memory;
  FOR_EACH(i, count) add_place(s.lists, find_place(s.judge, s.lists.asked[i]), s.lists.asked[i]);
#endif
}

#endif
