// SPDX-License-Identifier: Apache-2.0
// Quality refinement, the first half of a round, a kernel a step (propose.h), and at the end why triangles are left.
#include "refine/propose.h"

static RefineSettled what_was_settled(global const Counters* counters) {
  const RefineSettled s = {.failed = counters->failed,
                           .inserted = counters->list_insert[0],
                           .rounds = counters->rounds,
                           .flips_low = counters->flips_low,
                           .flips_high = counters->flips_high,
                           .left = counters->list_test[0]};
  return s;
}

// One work-item per face, and per face of the list `before` of the last round. Puts kept faces that are to be mended,
// or have a subsegment to be split for a side, into the list `bad`, and those subsegments into the list `asked`. What a
// face is depends on itself alone; one whose claim word is below `threshold` has not changed since the last round, so
// that it is in the list if it was. A face is a new triangle if one of its corners is: all that a round makes are
// joined to a vertex of that round, which have numbers from `judged` on; others keep what their aims have found. If the
// insertion before and its flips are `unread` by the host, the counters have what these did: the report gets it; there
// are faces of the vertices that it has inserted, too; and if edges are left to be tested, that is all. Reads the mesh.
// Writes: marks by atomic_or, its face's word of `urgency`, each list's words once, at places that atomics give. Lists
// come in any order, which nothing depends on.
kernel void refine_judge(JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* before, global uint* bad,
                         global uint* urgency, uint faces, uint threshold, uint were_bad, uint judged, uint unread,
                         global const Counters* counters) {
  Search s;
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  s.judge = judge;
  s.lists = lists;
  s.bad = bad;
  s.urgency = urgency;
  if (unread) {
    if (get_global_id(0) == 0) report->settled = what_was_settled(counters);
    if (counters->list_test[0] > 0u || counters->failed) return;
    faces += 2u * counters->list_insert[0];
  }
  BadList list;
  begin_bad(&list);
  FOR_EACH(i, were_bad + faces) {
    const bool was_bad = i < were_bad;
    const uint t = was_bad ? bad_face(before[i]) : i - were_bad;
    const uint4 c = face_data[GCDT_CORNERS(t)];
    const bool changed = c.w >= threshold;
    if (changed == was_bad) continue;
    if (was_bad)
      keep_bad(s, before[i], &list);
    else
      judge_anew(s, t, max(max(c.x, c.y), c.z) >= judged, &list);
  }
  end_bad(s, &list);
}

// One work-item per face of the list `bad`; on a GPU a team of them, of up to `teamed` faces. Those that need not wait,
// and do not lose by their handicap unless `all` may aim, make the list `aiming`. Reads the mesh and words of
// `urgency`. Writes the list's words once, at places that an atomic gives: in any order, which nothing depends on; and
// its face's own way, which no other reads.
kernel void refine_wait(GCDT_MESH_PARAMETERS, global uint* edge_marks, volatile global RefineReport* report,
                        global uint* bad, global uint* urgency, global uchar* ways, global uint* aiming, uint round,
                        uint all, uint teamed) {
  DECLARE_WAITING(memory);
  Search s;
  s.judge.mesh = make_mesh(n, points, face_data, edge_faces);
  s.judge.marks = edge_marks;
  s.lists.report = report;
  s.bad = bad;
  s.urgency = urgency;
  s.ways = ways;
  s.aiming = aiming;
  s.teamed = teamed;
  wait_for_worse(s, report->bad, round, all, memory);
}

// One work-item per face of the list `aiming`; on a GPU a team of them, of up to `teamed` (team.h). Finds its target,
// which becomes a candidate, or subsegments are asked for, or neither. Reads the mesh; writes as refine_judge, blocks
// of `cavities` that an atomic gives once, its place of `chosen`, which is its candidate if that is listed, else
// GCDT_NONE, and its face's word of `urgency`, which no other reads. Launched again with more room, it draws the same
// number, writes the same, and asks for nothing new.
kernel void refine_aim(JUDGE_PARAMETERS, LIST_PARAMETERS, global uint* aiming, global uint* urgency, uint most,
                       uint round, uint blocks, global uint* cavities, global uint* chosen, uint teamed) {
  DECLARE_TOURS(memory);
  Search s;
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  s.judge = judge;
  s.lists = lists;
  s.aiming = aiming;
  s.urgency = urgency;
  s.blocks = blocks;
  s.cavities = cavities;
  s.chosen = chosen;
  s.teamed = teamed;
  aim_at_targets(s, report->aiming, most, round, memory);
}

// One work-item per subsegment of the list `asked`; on a GPU a team of them, of up to `teamed`. Finds a place for its
// vertex, which becomes a candidate. `sharp`: bit 0 and 1 tell of the first and second end of each piece that another
// subsegment meets it there at less than 60 degrees over kept faces. Reads the mesh; writes as refine_aim.
kernel void refine_place(JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* edge_pieces, global const uint* sharp,
                         uint blocks, global uint* cavities, uint teamed) {
  DECLARE_TOURS(memory);
  Search s;
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  judge.edge_pieces = edge_pieces;
  judge.sharp = sharp;
  s.judge = judge;
  s.lists = lists;
  s.blocks = blocks;
  s.cavities = cavities;
  s.teamed = teamed;
  find_places(s, report->asked, memory);
}

// Why a kept face is worse than wanted, of GCDT_LEFT_...; VERDICT_FINE if it is not.
GCDT_APART uint reason_of(Judge judge, uint face, Lists lists) {
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
