// SPDX-License-Identifier: Apache-2.0
// Which candidates win: their order, and their claims of faces. refine.cl has a kernel for each step, and says why it
// has no race; tail.cl does them one after the other. OpenCL C only.
#ifndef GCDT_WINNERS_H
#define GCDT_WINNERS_H

#include "refine/breadth.h"
#include "refine/team.h"

typedef struct Candidates {
  Mesh mesh;
  global const ulong* keys;
  global const uint4* candidates;
  global uint *numbers, *ranks;
  volatile global uint* won;
} Candidates;

// Subsegments are not asked for any more.
static void forget_asked(global uint* edge_marks, global const uint* asked, uint count) {
  FOR_EACH(i, count) edge_marks[asked[i]] &= ~GCDT_MARK_ASKED;
}

static void zero_counters(global uint* counters) {
  FOR_EACH(i, (uint)(sizeof(Counters) / sizeof(uint))) counters[i] = 0u;
}

// ---- Precedence -------------------------------------------------------------------------------------------

// The lesser and the greater end of an edge, by (x, y).
static ulong2 ends_of(Mesh mesh, uint e) {
  const uint ref = mesh.edge_faces[2u * e], k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const u64 p = gcdt_tie_key(corner_vertex(mesh, c, next_corner(k))),
            q = gcdt_tie_key(corner_vertex(mesh, c, previous_corner(k)));
  return (ulong2)(min(p, q), max(p, q));
}

// Of candidates with equal keys, is a first? Two points can share a hash, and two subsegments a place. (Two triangles
// with one target are one candidate to all that follows: either may be first.)
static bool comes_before(Mesh mesh, uint4 a, uint4 b) {
  const u64 key_a = gcdt_tie_key(candidate_point(a)), key_b = gcdt_tie_key(candidate_point(b));
  if (key_a != key_b) return key_a < key_b;
  if (!(a.w & GCDT_ON_SUBSEGMENT) || !(b.w & GCDT_ON_SUBSEGMENT)) return false;
  const ulong2 ends_a = ends_of(mesh, a.z), ends_b = ends_of(mesh, b.z);
  return ends_a.x < ends_b.x || (ends_a.x == ends_b.x && ends_a.y < ends_b.y);
}

// Where a team of work-items counts what comes before its candidate: keys are few, and all are read by all.

#define GCDT_COUNTING_TEAMS 16u  // of a work-group at most

// refine_count_ranks. `before`: a word for each team.
GCDT_GIVEN_LOCAL void count_ranks(Candidates c, uint count, local uint* before) {
  const uint items = (uint)get_local_size(0), lanes = min(GCDT_COUNTING_TEAM, items);
  const uint teams = min(GCDT_COUNTING_TEAMS, items / lanes), team = (uint)get_local_id(0) / lanes;
  const uint lane = (uint)get_local_id(0) % lanes;
  FOR_EACH_TILE_OF(tile, teams, count) {
    const uint i = tile + team;
    const bool counts = team < teams && i < count;
    if (team < teams && lane == 0u) before[team] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (counts) {
      const u64 key = c.keys[i];
      // Eight loads at once: one after the other each would wait for its own.
      uint sum = 0u, equal = 0u, j = lane;
      for (; j + 7u * lanes < count; j += 8u * lanes) {
        u64 other[8];
        for (uint k = 0; k < 8u; ++k) other[k] = c.keys[j + k * lanes];
        for (uint k = 0; k < 8u; ++k) {
          sum += other[k] < key ? 1u : 0u;
          equal += other[k] == key ? 1u : 0u;
        }
      }
      for (; j < count; j += lanes) {
        sum += c.keys[j] < key ? 1u : 0u;
        equal += c.keys[j] == key ? 1u : 0u;
      }
      for (j = lane; equal > 0u && j < count; j += lanes) {
        if (c.keys[j] != key) continue;
        --equal;
        if (j != i && (comes_before(c.mesh, c.candidates[j], c.candidates[i]) ||
                       (j < i && !comes_before(c.mesh, c.candidates[i], c.candidates[j]))))
          ++sum;
      }
      atomic_add(before + team, sum);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (counts && lane == 0u) {
      const uint place = before[team];
      c.ranks[i] = place;
      c.numbers[place] = i;
      c.won[i] = 1u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// ---- Claims -----------------------------------------------------------------------------------------------

// A face is met once for each of its sides that are looked over.
static void claim_cavity(Mesh mesh, volatile global const uint* marks, uint root, Vertex x, Ticket t,
                         volatile global RefineReport* report) {
#ifdef GCDT_CONTIGUOUS
  Judge judge;
  judge.mesh = mesh;
  judge.marks = (volatile global uint*)marks;
  BreadthTour whole;
  tour_by_breadth(judge, 0, root, x, ~0ul, &whole);
  if (!whole.full && is_listed(&whole)) {
    for (uint i = 0; i < whole.entered; ++i) claim_face(mesh, whole.faces[i], t);
    return;
  }
#endif
  Tour tour = begin_tour(mesh, marks, root, x);
  do claim_face(mesh, tour.face, t);
  while (go_on(&tour));
  if (tour.steps == 0u) atomic_or(&report->failed, 1u);
}

// All that a candidate needs.
GCDT_APART void claim_all(Mesh mesh, volatile global const uint* marks, uint4 candidate, Ticket t,
                          volatile global RefineReport* report) {
  for (uint i = 0; i < GCDT_ROOTS; ++i) {
    const Root root = candidate_root(mesh, candidate, i);
    if (root.face != GCDT_NONE && root.of_cavity)
      claim_cavity(mesh, marks, root.face, candidate_point(candidate), t, report);
    else if (root.face != GCDT_NONE)
      claim_face(mesh, root.face, t);
  }
}

// Whose the block is, by number; GCDT_NONE of a face that aimed in vain, or of whom the list is not whole.
static inline uint candidate_of(global const uint* block, global const uint* chosen, global const uint4* candidates) {
  const uint owner = block[GCDT_BLOCK - 1u];
  if (!(owner & GCDT_OF_SUBSEGMENT)) return chosen[owner];
  return candidates[owner & ~GCDT_OF_SUBSEGMENT].w & GCDT_LISTED ? owner & ~GCDT_OF_SUBSEGMENT : GCDT_NONE;
}

// The candidates that are not listed, each by a work-item or a team.
GCDT_GIVEN_LOCAL void claim_unlisted(Candidates c, uint count, Ticket t, volatile global const uint* marks,
                                     volatile global RefineReport* report, uint teamed, TeamMemory memory) {
#ifdef GCDT_GPU
  const Mesh mesh = c.mesh;
  Judge judge;
  judge.mesh = mesh;
  judge.marks = (volatile global uint*)marks;
  const TeamOf of = team_of(memory.teams, count, teamed);
  const TeamList none = {.words = 0, .blocks = 0u, .report = report};
  FOR_EACH_TILE_OF(tile, of.at_once, count) {
    const uint i = tile + of.number;
    const bool claims = of.leads && i < count && !(c.candidates[i].w & GCDT_LISTED);
    if (of.leads && of.member) of.team->pending = 0u;
    if (claims) t.place = c.ranks[i];
    if (claims && of.member) {
      begin_team(of.team, candidate_point(c.candidates[i]), ~0ul, t.place);
      add_roots(mesh, of.team, c.candidates[i], none, t);
    }
    tour_by_teams(of, judge, none, t, memory.busy);
    if (claims && (of.alone || (of.team->flags & (TEAM_FULL | TEAM_FAILED))))
      claim_all(mesh, marks, c.candidates[i], t, report);
  }
#else
  (void)teamed;
  (void)memory;
  FOR_EACH(i, count) {
    t.place = c.ranks[i];
    if (!(c.candidates[i].w & GCDT_LISTED)) claim_all(c.mesh, marks, c.candidates[i], t, report);
  }
#endif
}

// refine_claim. `blocks`: of the lists.
GCDT_GIVEN_LOCAL void claim_faces(Candidates c, uint count, Ticket t, volatile global const uint* marks, uint blocks,
                                  global const uint* cavities, global const uint* chosen,
                                  volatile global RefineReport* report, uint teamed, TeamMemory memory) {
  FOR_EACH(b, blocks) {
    global const uint* block = cavities + GCDT_BLOCK * b;
    const uint candidate = candidate_of(block, chosen, c.candidates);
    if (candidate == GCDT_NONE) continue;
    t.place = c.ranks[candidate];
    for (uint k = 0; k + 1u < GCDT_BLOCK && block[k] != GCDT_NONE; ++k) claim_face(c.mesh, block[k], t);
  }
  claim_unlisted(c, count, t, marks, report, teamed, memory);
}

#endif
