// SPDX-License-Identifier: Apache-2.0
// Tours of cavities by teams of work-items, for GPUs. OpenCL C only.
//
// On a GPU a tour by one work-item is a chain of loads, as long as the largest cavity, for which all others wait. The
// faces of a cavity form a tree (R1), so several sides of it can be looked over at once: each face is reached once,
// whatever the order. A team's sides that are still to be looked over are a stack in local memory; each work-item takes
// one from the top, and puts there the other two sides of the face beyond, if the cavity goes on there. What comes of a
// tour does not depend on its order. Where there are more tours than the GPU has room for at once, teams only cost:
// then each is made by one work-item.
#ifndef GCDT_TEAM_H
#define GCDT_TEAM_H

#include "refine/aim.h"
#include "refine/claim.h"

#ifdef GCDT_GPU

#define GCDT_TEAM 8u     // work-items of a team
#define GCDT_TEAMS 16u   // of a work-group at most
#ifndef GCDT_TEAM_STACK  // sides; where there are more, the first of the team makes the tour alone
#define GCDT_TEAM_STACK 192u
#endif
#define GCDT_TEAM_ASKS 8u  // subsegments; where there are more, the first makes a tour for them

#define TEAM_NEAR 1u       // the target is too near a vertex
#define TEAM_TIED 2u       // it is on the circle of a face beside the cavity
#define TEAM_OUT 4u        // the cavity has more than `most` faces
#define TEAM_FULL 8u       // there was no room in the stack
#define TEAM_UNLISTED 16u  // there was no block for the list
#define TEAM_FAILED 32u    // the cavity has more faces than the mesh: it is wrong

typedef struct Team {
  uint pending;  // the length of the stack; 0: there is no tour
  uint faces;    // of the cavity so far
  uint in_way, fixed, flags;
  uint owner;      // of the list; the place in order of who claims
  uint blocks[4];  // of the list, the last ones: block b at b modulo 4
  uint verdict;    // with the next one of Judged; 0: only the list is wanted
  ulong shortest;
  long x, y;  // the target
  ulong most;
  uint asks[GCDT_TEAM_ASKS];
  uint stack[GCDT_TEAM_STACK];
} Team;

typedef struct TeamOf {
  bool alone;  // there are no teams: each work-item makes its tours by itself
  bool member;
  bool leads;  // the first of its team, or alone
  uint number, lane, lanes;
  uint at_once;  // tours of a work-group
  volatile local Team* team;
} TeamOf;

// The team of a work-item, if there are `count` tours in all; no teams make more than `teamed`. Work-items that are in
// none have the memory of one, which they do not touch.
static inline TeamOf team_of(volatile local Team* memory, uint count, uint teamed) {
  TeamOf of;
  const uint items = (uint)get_local_size(0), item = (uint)get_local_id(0);
  of.alone = count > teamed;
  of.lanes = of.alone ? 1u : min(GCDT_TEAM, items);
  of.at_once = of.alone ? items : min(GCDT_TEAMS, items / of.lanes);
  of.number = item / of.lanes;
  of.lane = item % of.lanes;
  of.leads = of.lane == 0u && of.number < of.at_once;
  of.member = !of.alone && of.number < of.at_once;
  of.team = memory + min(of.number, GCDT_TEAMS - 1u);
  return of;
}

// Where a tour lists the faces (candidates.h); words 0: it claims them instead.
typedef struct TeamList {
  global uint* words;
  uint blocks;  // that there is room for
  volatile global RefineReport* report;
} TeamList;

// Takes a block for the list, as that with number `number` of its blocks.
static inline void take_block(volatile local Team* team, uint number, TeamList list) {
  const uint block = atomic_inc(&list.report->blocks);
  team->blocks[number % 4u] = block;
  if (block < list.blocks)
    list.words[GCDT_BLOCK * block + GCDT_BLOCK - 1u] = team->owner;
  else
    atomic_or(&team->flags, TEAM_UNLISTED);
}

// Where face number i of the cavity stands in the list, if there is a block for it.
static inline uint place_in_list(volatile local const Team* team, uint i) {
  return GCDT_BLOCK * team->blocks[i / (GCDT_BLOCK - 1u) % 4u] + i % (GCDT_BLOCK - 1u);
}

static inline void put_in_list(volatile local const Team* team, uint i, uint face, TeamList list) {
  if (team->blocks[i / (GCDT_BLOCK - 1u) % 4u] < list.blocks) list.words[place_in_list(team, i)] = face;
}

// The first of a team, before it tours.
static inline void begin_team(volatile local Team* team, Vertex target, ulong most, uint owner) {
  team->faces = team->in_way = team->fixed = team->flags = team->pending = team->verdict = 0u;
  team->owner = owner;
  team->x = target.x;
  team->y = target.y;
  team->most = most;
}

// The first of a team, then. Lists or claims a face, and if it is of a cavity, its sides are to be looked over.
static inline void add_root(Mesh mesh, volatile local Team* team, uint face, bool of_cavity, TeamList list, Ticket t) {
  const uint number = team->faces++;
  if (list.words) {
    if (number == 0u) take_block(team, 0u, list);
    put_in_list(team, number, face, list);
  } else {
    claim_face(mesh, face, t);
  }
  for (uint k = 0; of_cavity && k < 3u; ++k) team->stack[team->pending++] = GCDT_FACE_REF(face, k);
}

// All that a candidate needs.
static void add_roots(Mesh mesh, volatile local Team* team, uint4 candidate, TeamList list, Ticket t) {
  for (uint i = 0; i < GCDT_ROOTS; ++i) {
    const Root root = candidate_root(mesh, candidate, i);
    if (root.face != GCDT_NONE) add_root(mesh, team, root.face, root.of_cavity, list, t);
  }
}

// Looks over a side. Returns the face beyond with the corner across from the side, if the cavity goes on there, else
// GCDT_NONE. Writes the team's words by atomics.
static uint look_over(Judge judge, volatile local Team* team, uint ref) {
  const Mesh mesh = judge.mesh;
  const uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
  const uint code = face_side(mesh, face, k), far = mesh.edge_faces[code ^ 1u];
  const Vertex p = corner_vertex(mesh, c, next_corner(k)), x = gcdt_finite_vertex(team->x, team->y);
  Judged j;
  j.verdict = team->verdict;
  j.shape.shortest = team->shortest;
  const bool aims = j.verdict != 0u;
  if (aims && is_too_near(j, p, x)) atomic_or(&team->flags, TEAM_NEAR);
  if (is_constrained(judge.marks, code)) {
    if (!aims || !gcdt_in_lens(judge.rules, p, corner_vertex(mesh, c, previous_corner(k)), x)) return GCDT_NONE;
    if (!may_split(mesh, judge.rules, code)) {
      atomic_inc(&team->fixed);
    } else {
      const uint place = atomic_inc(&team->in_way);
      if (place < GCDT_TEAM_ASKS) team->asks[place] = code;
    }
    return GCDT_NONE;
  }
  const int side = far == GCDT_NONE ? -1 : side_of_circle(mesh, GCDT_REF_FACE(far), x);
  if (side == 0) atomic_or(&team->flags, TEAM_TIED);
  return side > 0 ? far : GCDT_NONE;
}

// The tours of all teams of a work-group, which have begun or have no side to look over, if there are teams. Faces are
// listed, or claimed with the ticket t, which has each team's place. Called by all of it. No race: barriers stand
// between what one work-item writes and others read, and what several write in a step they write by atomics. Ends: each
// face is entered once from each of at most four roots; a team with more faces gives up.
GCDT_GIVEN_LOCAL void tour_by_teams(TeamOf of, Judge judge, TeamList list, Ticket t, volatile local uint* busy) {
  volatile local Team* const team = of.team;
  const uint all_faces = 4u * gcdt_forest_faces(judge.mesh.n, 1u);
  for (;;) {
    if (get_local_id(0) == 0) *busy = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint pending = of.member ? team->pending : 0u;
    const uint ref = of.lane < pending ? team->stack[pending - 1u - of.lane] : GCDT_NONE;
    if (ref != GCDT_NONE) atomic_or(busy, 1u);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (*busy == 0u) break;
    if (of.member && of.lane == 0u) team->pending = pending - min(pending, of.lanes);
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint beyond = ref == GCDT_NONE ? GCDT_NONE : look_over(judge, team, ref);
    uint number = 0u;
    if (beyond != GCDT_NONE) {
      number = atomic_inc(&team->faces);
      if (list.words && number % (GCDT_BLOCK - 1u) == 0u) take_block(team, number / (GCDT_BLOCK - 1u), list);
      if (!list.words) {
        t.place = team->owner;
        claim_face(judge.mesh, GCDT_REF_FACE(beyond), t);
      }
      const uint place = atomic_add(&team->pending, 2u);
      if (place + 2u > GCDT_TEAM_STACK) {
        atomic_or(&team->flags, TEAM_FULL);
      } else {
        const uint face = GCDT_REF_FACE(beyond), k = GCDT_REF_CORNER(beyond);
        team->stack[place] = GCDT_FACE_REF(face, previous_corner(k));
        team->stack[place + 1u] = GCDT_FACE_REF(face, next_corner(k));
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (list.words && beyond != GCDT_NONE) put_in_list(team, number, GCDT_REF_FACE(beyond), list);
    if (of.member && of.lane == 0u) {
      if (team->faces > team->most) atomic_or(&team->flags, TEAM_OUT);
      if (team->faces > all_faces) atomic_or(&team->flags, TEAM_FAILED);
      if (team->flags & (TEAM_OUT | TEAM_FULL | TEAM_FAILED)) team->pending = 0u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// The first of a team, after its tour. Ends the list. Returns GCDT_LISTED if it is whole, else 0.
static inline uint end_team_list(volatile local const Team* team, global uint* words) {
  if (team->flags & (TEAM_UNLISTED | TEAM_FULL | TEAM_FAILED)) return 0u;
  if (team->faces % (GCDT_BLOCK - 1u) != 0u) words[place_in_list(team, team->faces - 1u) + 1u] = GCDT_NONE;
  return GCDT_LISTED;
}

// The first of a team, after the tour for an aim. Returns whether the subsegments in the way are still to be asked for.
static bool end_team(volatile local const Team* team, Aim* aim, Lists lists, global uint* words, uint* listed) {
  const uint flags = team->flags;
  aim->sits_out = (flags & TEAM_OUT) != 0u;
  aim->failed = (flags & TEAM_FAILED) != 0u;
  if (aim->sits_out || aim->failed) return false;
  aim->tied = (flags & TEAM_TIED) != 0u;
  aim->in_way = team->in_way;
  aim->fixed = team->fixed;
  aim->wanted = !(flags & TEAM_NEAR) && aim->in_way == 0u && aim->fixed == 0u;
  if (aim->wanted) *listed = end_team_list(team, words);
  if (aim->in_way > GCDT_TEAM_ASKS) return true;
  for (uint k = 0; k < aim->in_way; ++k) ask(lists, GCDT_SIDE_EDGE(team->asks[k]));
  return false;
}

#define WAITING_TEAM 8u    // six ways begin at a face; each is gone by a work-item
#define WAITING_TEAMS 64u  // of a work-group at most

#endif

// Local memory of teams, declared in the kernel itself: for tours, or for waiting.
typedef struct TeamMemory {
#ifdef GCDT_GPU
  volatile local Team* teams;
  volatile local uint *busy, *found;
#else
  uint none;
#endif
} TeamMemory;

#ifdef GCDT_GPU
#define DECLARE_TOURS(memory)            \
  local Team memory##_teams[GCDT_TEAMS]; \
  local uint memory##_busy;              \
  const TeamMemory memory = {.teams = memory##_teams, .busy = &memory##_busy, .found = 0}
#define DECLARE_WAITING(memory)             \
  local uint memory##_found[WAITING_TEAMS]; \
  const TeamMemory memory = {.teams = 0, .busy = 0, .found = memory##_found}
#else
#define DECLARE_TOURS(memory) const TeamMemory memory = {.none = 0u}
#define DECLARE_WAITING(memory) DECLARE_TOURS(memory)
#endif

#endif
