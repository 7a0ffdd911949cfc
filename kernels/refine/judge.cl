// SPDX-License-Identifier: Apache-2.0
// Quality refinement, the first half of a round: which triangles and subsegments are to be mended, and by which
// vertices. Nothing of the mesh changes but marks (docs/refinement.md, A).
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

// One work-item per face, and per face of the list `before` of the last round. Puts kept faces that are to be mended,
// or have a subsegment to be split for a side, into the list `bad`, and those subsegments into the list `asked`. What a
// face is depends on itself alone; one whose claim word is below `threshold` has not changed since the last round, so
// that it is in the list if it was. A face is a new triangle if one of its corners is: all that a round makes are
// joined to a vertex of that round, which have numbers from `judged` on; others keep what their aims have found. Reads
// the mesh. Writes: marks by atomic_or, its face's word of `urgency`, each list's words once, at places that atomics
// give. Lists come in any order, which nothing depends on.
kernel void refine_judge(uint faces, uint threshold, uint were_bad, uint judged, JUDGE_PARAMETERS, LIST_PARAMETERS,
                         global const uint* before, global uint* bad, global uint* urgency) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  FOR_EACH(i, were_bad + faces) {
    const bool was_bad = i < were_bad;
    const uint t = was_bad ? before[i] : i - were_bad;
    const uint4 c = face_data[GCDT_CORNERS(t)];
    const bool changed = c.w >= threshold;
    if (changed == was_bad) continue;
    if (label_of(judge.mesh, t) == 0u) {
      urgency[t] = 0u;
      continue;
    }
    const bool encroached = ask_for_encroached(judge, t, lists);
    if (was_bad) {
      bad[atomic_inc(&report->bad)] = t;
      continue;
    }
    const Judged j = judge_face(judge, t);
    const uint verdict = j.verdict, own = verdict == VERDICT_SHARP ? urgency_of(j.shape) : 0u;
    const bool is_new = max(max(c.x, c.y), c.z) >= judged;
    urgency[t] = (own << URGENCY_BITS) | (is_new ? URGENCY_IN_THE_WAY : urgency[t] & ((1u << URGENCY_BITS) - 1u));
    if (encroached || verdict == VERDICT_SHARP || verdict == VERDICT_LARGE) bad[atomic_inc(&report->bad)] = t;
  }
}

// Tells the host that a triangle has not aimed whose turn it was. Most find it told; the word only becomes 1, so who
// reads it too early sets it again.
static inline void sit_out(volatile global RefineReport* report) {
  if (report->sitting_out == 0u) atomic_or(&report->sitting_out, 1u);
}

// Whose turn it is: it aims, or sits out by its handicap.
static inline void take_turn(Mesh mesh, uint face, uint urgency, uint round, uint all, global uint* aiming,
                             volatile global RefineReport* report) {
  const uint handicap = all ? 0u : handicap_of(urgency);
  if (handicap > 0u && draw(mesh, mesh.face_data[GCDT_CORNERS(face)], round) < handicap)
    sit_out(report);
  else
    aiming[atomic_inc(&report->aiming)] = face;
}

#ifdef GCDT_GPU
#define WAITING_TEAM 8u    // six ways begin at a face; each is gone by a work-item
#define WAITING_TEAMS 64u  // of a work-group at most
#endif

// One work-item per face of the list `bad`; on a GPU a team of them, of up to `teamed` faces. Those that need not wait,
// and do not lose by their handicap unless `all` may aim, make the list `aiming`. Reads the mesh and words of
// `urgency`. Writes the list's words once, at places that an atomic gives: in any order, which nothing depends on; and
// its face's own way, which no other reads.
kernel void refine_wait(GCDT_MESH_PARAMETERS, global const uint* edge_marks, volatile global RefineReport* report,
                        global const uint* bad, global const uint* urgency, global uchar* ways, global uint* aiming,
                        uint round, uint all, uint teamed) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint count = report->bad;
  const uint alone = without_teams(count, teamed);
  FOR_EACH(i, alone) {
    const uint face = bad[i], found = way_to_worse(mesh, edge_marks, face, ways[face], urgency);
    ways[face] = (uchar)found;
    if (found == GCDT_NO_WAY) take_turn(mesh, face, urgency[face], round, all, aiming, report);
  }
#ifdef GCDT_GPU
  volatile local uint found[WAITING_TEAMS];
  const uint items = (uint)get_local_size(0), lanes = min(WAITING_TEAM, items),
             teams = min(WAITING_TEAMS, items / lanes);
  const uint team = (uint)get_local_id(0) / lanes, lane = (uint)get_local_id(0) % lanes;
  FOR_EACH_TILE_OF(tile, teams, count - alone) {
    const uint i = tile + team;
    const bool asks = team < teams && i < count;
    const uint face = asks ? bad[i] : 0u, own = asks ? urgency[face] >> URGENCY_BITS : 0u;
    if (asks && lane == 0u)
      found[team] =
          own > 0u && leads_to_worse(mesh, edge_marks, face, ways[face], own, urgency) ? ways[face] : GCDT_NO_WAY;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (own > 0u && found[team] == GCDT_NO_WAY)
      for (uint k = lane; k < 6u; k += lanes) {
        const uint way = way_by(mesh, edge_marks, face, k / 2u, k % 2u, own, urgency);
        if (way != GCDT_NO_WAY) atomic_xchg(found + team, way);
      }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (asks && lane == 0u) {
      ways[face] = (uchar)found[team];
      if (found[team] == GCDT_NO_WAY) take_turn(mesh, face, urgency[face], round, all, aiming, report);
    }
  }
#endif
}

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

// One work-item per face of the list `aiming`; on a GPU a team of them, of up to `teamed` (team.h). Finds its target,
// which becomes a candidate, or subsegments are asked for, or neither. Reads the mesh; writes as refine_judge, blocks
// of `cavities` that an atomic gives once, its place of `chosen`, which is its candidate if that is listed, else
// GCDT_NONE, and its face's word of `urgency`, which no other reads. Launched again with more room, it draws the same
// number, writes the same, and asks for nothing new.
kernel void refine_aim(JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* aiming, global uint* urgency, uint most,
                       uint round, uint blocks, global uint* cavities, global uint* chosen, uint teamed) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  const uint count = report->aiming;
  const uint alone = without_teams(count, teamed);
  FOR_EACH(i, alone) {
    const uint t = aiming[i];
    chosen[i] = GCDT_NONE;
    const Judged j = judge_face(judge, t);
    if (!is_to_be_mended(j)) continue;
    CavityList cavity = begin_list(cavities, blocks, i);
    const uint number = draw(judge.mesh, j.corners, round);
    Aim aim = begin_aim(judge, t, j, false);
    if (has_cavity(aim)) tour_cavity(judge, j, &aim, false, (ulong)most << number, &cavity, lists);
    const uint listed = aim.wanted ? end_list(&cavity) : 0u;
    const uint candidate = conclude(judge, lists, urgency, t, number, j, aim, true, listed);
    if (listed) chosen[i] = candidate;
  }
#ifdef GCDT_GPU
  local Team memory[GCDT_TEAMS];
  local uint busy;
  const TeamOf of = team_of(memory);
  const TeamList list = {.words = cavities, .blocks = blocks, .report = report};
  const Ticket nothing = {.stamp = 0u, .bits = 0u, .place = 0u, .numbers = 0, .won = 0};
  FOR_EACH_TILE_OF(tile, of.teams, count - alone) {
    const uint i = tile + of.number;
    const bool leads = of.lane == 0u && of.number < of.teams && i < count;
    Judged j;
    Aim aim;
    uint t = 0u, number = 0u, listed = 0u;
    bool aims = false;
    if (of.lane == 0u && of.number < of.teams) of.team->pending = 0u;
    if (leads) {
      t = aiming[i];
      chosen[i] = GCDT_NONE;
      j = judge_face(judge, t);
      aims = is_to_be_mended(j);
      if (aims) {
        number = draw(judge.mesh, j.corners, round);
        aim = begin_aim(judge, t, j, false);
        if (has_cavity(aim)) {
          begin_team(of.team, aim.target, (ulong)most << number, i);
          of.team->verdict = j.verdict;
          of.team->shortest = j.shape.shortest;
          add_root(judge.mesh, of.team, aim.at.face, true, list, nothing);
        }
      }
    }
    tour_by_teams(of, judge, list, nothing, &busy);
    if (aims) {
      bool asks = true;
      if (has_cavity(aim)) {
        if (of.team->flags & TEAM_FULL)
          tour_cavity(judge, j, &aim, false, (ulong)most << number, 0, lists);
        else
          asks = end_team(of.team, &aim, lists, cavities, &listed);
      }
      const uint candidate = conclude(judge, lists, urgency, t, number, j, aim, asks, listed);
      if (listed) chosen[i] = candidate;
    }
  }
#endif
}

// Puts the place into the list of candidates, if there is one. Returns its number, or GCDT_NONE.
static uint add_place(Lists lists, Place place, uint edge) {
  if (!place.found) {
    atomic_inc(&lists.report->refused);
    return GCDT_NONE;
  }
  return add_candidate(lists, gcdt_candidate_key(1u, place.squared, 0u, place.at), place.at, edge,
                       place.far ? GCDT_ON_SUBSEGMENT | GCDT_FAR : GCDT_ON_SUBSEGMENT);
}

// One work-item per subsegment of the list `asked`; on a GPU a team of them, of up to `teamed`. Finds a place for its
// vertex, which becomes a candidate. `sharp`: bit 0 and 1 tell of the first and second end of each piece that another
// subsegment meets it there at less than 60 degrees over kept faces. Reads the mesh; writes as refine_aim.
kernel void refine_place(JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* edge_pieces, global const uint* sharp,
                         uint blocks, global uint* cavities, uint teamed) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  judge.edge_pieces = edge_pieces;
  judge.sharp = sharp;
  const uint count = report->asked;
  const uint alone = without_teams(count, teamed);
  FOR_EACH(i, alone) add_place(lists, find_place(judge, asked[i]), asked[i]);
#ifdef GCDT_GPU
  local Team memory[GCDT_TEAMS];
  local uint busy;
  const TeamOf of = team_of(memory);
  const TeamList list = {.words = cavities, .blocks = blocks, .report = report};
  const Ticket nothing = {.stamp = 0u, .bits = 0u, .place = 0u, .numbers = 0, .won = 0};
  FOR_EACH_TILE_OF(tile, of.teams, count - alone) {
    const uint i = tile + of.number;
    uint candidate = GCDT_NONE;
    if (of.lane == 0u && of.number < of.teams) {
      of.team->pending = 0u;
      if (i < count) {
        const Place place = find_place(judge, asked[i]);
        candidate = add_place(lists, place, asked[i]);
        if (candidate < capacity) {
          begin_team(of.team, place.at, ~0ul, GCDT_OF_SUBSEGMENT | candidate);
          add_roots_of_subsegment(judge.mesh, of.team, asked[i], place.at, list, nothing);
        }
      }
    }
    tour_by_teams(of, judge, list, nothing, &busy);
    if (candidate < capacity) candidates[candidate].w |= end_team_list(of.team, cavities);
  }
#endif
}

// Why a kept face is worse than wanted, of GCDT_LEFT_...; VERDICT_FINE if it is not.
static uint reason_of(Judge judge, uint face, Lists lists) {
  const Judged j = judge_face(judge, face);
  if (j.verdict <= VERDICT_FINE) return j.verdict;
  Aim aim = begin_aim(judge, face, j, true);
  if (has_cavity(aim)) tour_cavity(judge, j, &aim, true, ~0ul, 0, lists);
  if (aim.failed) atomic_or(&lists.report->failed, 1u);
  if (aim.fixed > 0u) return GCDT_LEFT_FIXED;
  if (aim.wanted || aim.open > 0u) return GCDT_LEFT_LIMIT;
  return aim.in_way > 0u ? GCDT_LEFT_REFUSED : GCDT_LEFT_TARGET;
}

// One work-item per face. Counts why kept faces are worse than wanted, and subsegments with the corner of a kept face
// in their lens, once a side. Reads the mesh. Writes the report by atomics, and of each face 1 + the reason, or 0.
kernel void refine_explain(uint faces, JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* edge_pieces,
                           global const uint* sharp, global uint* reasons) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  judge.edge_pieces = edge_pieces;
  judge.sharp = sharp;
  FOR_EACH(t, faces) {
    const uint4 s = face_data[GCDT_SIDES(t)];
    reasons[t] = 0u;
    if (s.w == 0u) continue;
    const uint4 c = face_data[GCDT_CORNERS(t)];
    for (uint k = 0; k < 3u; ++k)
      if (is_constrained(edge_marks, element(s, k)) &&
          gcdt_in_lens(judge.rules, corner_vertex(judge.mesh, c, next_corner(k)),
                       corner_vertex(judge.mesh, c, previous_corner(k)), corner_vertex(judge.mesh, c, k)))
        atomic_inc(&report->encroached);
    const uint reason = reason_of(judge, t, lists);
    if (reason == VERDICT_FINE) continue;
    atomic_inc(&report->left[reason]);
    reasons[t] = reason + 1u;
  }
}
