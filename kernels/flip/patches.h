// SPDX-License-Identifier: Apache-2.0
// Flips within patches of the mesh: a work-group does whole rounds among the faces that are its own, while they are in
// its caches. OpenCL C, and for the host the sizes.
//
// A patch is the vertices whose ranks on the curve lie in an interval, with the faces and edges that they brought: by
// their numbers, wherever flips have moved them. In each level these are consecutive numbers. So whose a face is says
// its number alone, and no flip changes it: within a patch the work-group is alone, and needs claims only among its own
// work-items, in local memory. What leads to another patch's face, or to an edge of its number, is left in the queue of
// the whole mesh.
#ifndef GCDT_PATCHES_H
#define GCDT_PATCHES_H

#ifdef __OPENCL_VERSION__
#include "flip/flip.h"
#endif

// Local memory of a patch with room for so many vertices, in words: its levels, how long its lists are, claims of its
// faces, a bit for each of its edges, and two lists of places of edges, half a word each.
#define GCDT_PATCH_LEVEL_WORDS 5u
#define GCDT_PATCH_LENGTHS (GCDT_PATCH_LEVEL_WORDS * GCDT_MAX_LEVELS)
#define GCDT_PATCH_CLAIMS (GCDT_PATCH_LENGTHS + 2u)
#define GCDT_PATCH_QUEUED(room) (GCDT_PATCH_CLAIMS + 2u * (room))
#define GCDT_PATCH_LISTS(room) (GCDT_PATCH_QUEUED(room) + (3u * (room) + 31u) / 32u)
#define GCDT_PATCH_WORDS(room) (GCDT_PATCH_LISTS(room) + 3u * (room))
// Vertices that there may be room for in 32 KiB, which a device has. Places of their edges have 16 bits.
#define GCDT_MOST_PATCH_ROOM 1500u

#ifdef __OPENCL_VERSION__

// The vertices of a patch, level by level, in local memory.
typedef struct PatchLevel {
  uint begin;          // the level's first vertex
  uint first, wanted;  // the level's vertices in the interval
  uint count;          // so many of these, for which there is room, are the patch's
  uint place;          // how many of the patch come before them
} PatchLevel;

typedef struct Patch {
  local const PatchLevel* levels;
  uint last;  // level
  uint bits;  // that hold the place of an edge
} Patch;

// The first of level j's vertices with rank `rank` or more, or the end of the level. Where isolated vertices come
// early, by bisection; ends: the range halves.
static inline uint first_of_rank(GCDT_LEVELS_POINTER levels, uint j, uint rank) {
  uint low = levels->begin[j], high = levels->begin[j + 1u];
  if (!levels->tabled) {
    const uint stride = levels->stride[j];
    return min(low + gcdt_vertices_before(levels, j, rank / stride + (rank % stride != 0u ? 1u : 0u)), high);
  }
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (gcdt_rank_of_vertex(levels, middle) < rank)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
}

// Called by the whole group. The patch of the ranks from begin up to end, in the levels up to `last`. Vertices for
// which there is no room, as isolated ones come besides, are nobody's.
GCDT_GIVEN_LOCAL Patch make_patch(local PatchLevel* of, GCDT_LEVELS_POINTER levels, uint last, uint begin, uint end,
                                  uint room) {
  barrier(CLK_LOCAL_MEM_FENCE);
  FOR_ALL_TILES(tile, last + 1u) {
    const uint j = tile + get_local_id(0);
    if (j > last) continue;
    of[j].begin = levels->begin[j];
    of[j].first = first_of_rank(levels, j, begin);
    of[j].wanted = first_of_rank(levels, j, end) - of[j].first;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  FOR_ALL_TILES(tile, last + 1u) {
    const uint j = tile + get_local_id(0);
    if (j > last) continue;
    uint before = 0;
    for (uint i = 0; i < j; ++i) before += of[i].wanted;
    of[j].place = min(before, room);
    of[j].count = min(of[j].wanted, room - of[j].place);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const Patch patch = {.levels = of, .last = last, .bits = 32u - clz(3u * room)};
  return patch;
}

GCDT_GIVEN_LOCAL uint vertices_of_patch(Patch p) { return p.levels[p.last].place + p.levels[p.last].count; }

// Which of the patch's vertices v is, or GCDT_NONE. Ends: j decreases, and level 0 begins with 0.
GCDT_GIVEN_LOCAL uint place_in_patch(Patch p, uint v) {
  uint j = p.last;
  while (v < p.levels[j].begin) --j;
  const uint i = v - p.levels[j].first;
  return i < p.levels[j].count ? p.levels[j].place + i : GCDT_NONE;
}

// The inverse. Ends: j decreases, and nothing comes before level 0.
GCDT_GIVEN_LOCAL uint vertex_in_patch(Patch p, uint place) {
  uint j = p.last;
  while (place < p.levels[j].place) --j;
  return p.levels[j].first + (place - p.levels[j].place);
}

// Called by the whole group: the edges of the interval's vertices that are nobody's are to be tested after this launch.
GCDT_GIVEN_LOCAL void leave_beyond(Patch p, Mesh mesh, global uint* edge_marks) {
  for (uint j = 0; j <= p.last; ++j) {
    const uint v = p.levels[j].first + p.levels[j].count, edges = 3u * (p.levels[j].wanted - p.levels[j].count);
    FOR_ALL_TILES(tile, edges) {
      const uint i = tile + get_local_id(0);
      if (i < edges) atomic_or(edge_marks + new_edge(mesh, v, 0u) + i, GCDT_MARK_QUEUED);
    }
  }
}

// The same of faces and edges, two and three for each vertex. A root's are nobody's.
GCDT_GIVEN_LOCAL uint face_in_patch(Patch p, Mesh mesh, uint face) {
  if (face < mesh.roots) return GCDT_NONE;
  const uint place = place_in_patch(p, (face - mesh.roots) / 2u);
  return place == GCDT_NONE ? GCDT_NONE : 2u * place + (face - mesh.roots) % 2u;
}
GCDT_GIVEN_LOCAL uint edge_in_patch(Patch p, Mesh mesh, uint e) {
  if (e < 3u * mesh.roots) return GCDT_NONE;
  const uint place = place_in_patch(p, e / 3u - mesh.roots);
  return place == GCDT_NONE ? GCDT_NONE : 3u * place + e % 3u;
}
GCDT_GIVEN_LOCAL uint edge_of_patch(Patch p, Mesh mesh, uint place) {
  return new_edge(mesh, vertex_in_patch(p, place / 3u), place % 3u);
}

// ---- What is to be tested --------------------------------------------------------------------------

// The patch's queue, in local memory: its edges by place, each once, since `queued` has a bit for each.
typedef struct PatchQueue {
  local ushort* tests;
  volatile local uint *queued, *length;
} PatchQueue;

GCDT_GIVEN_LOCAL void queue_place(PatchQueue q, uint place) {
  const uint bit = 1u << (place % 32u);
  if ((atomic_or(q.queued + place / 32u, bit) & bit) == 0u) q.tests[atomic_inc(q.length)] = (ushort)place;
}

// The edge in this place is the patch's first test, and in nobody's queue.
GCDT_GIVEN_LOCAL void take_edge(Patch p, Mesh mesh, global uint* edge_marks, local ushort* tests, uint place) {
  const uint e = edge_of_patch(p, mesh, place), marks = edge_marks[e];
  tests[place] = (ushort)place;
  if (marks & GCDT_MARK_QUEUED) edge_marks[e] = marks & ~GCDT_MARK_QUEUED;
}

// Edge e is to be tested: by this patch if its number is the patch's, else by whoever comes after this launch.
GCDT_GIVEN_LOCAL void queue_in_patch(Patch p, Mesh mesh, PatchQueue q, global uint* edge_marks, uint e) {
  const uint place = edge_in_patch(p, mesh, e);
  if (place == GCDT_NONE)
    atomic_or(edge_marks + e, GCDT_MARK_QUEUED);
  else
    queue_place(q, place);
}

// ---- Rounds ----------------------------------------------------------------------------------------

// The candidate of a round with the greatest ticket flips: greater in later rounds, so claims need no clearing.
GCDT_GIVEN_LOCAL uint patch_ticket(Patch p, uint round, uint place) { return make_ticket(round + 1u, p.bits, place); }

// Tests the edge in this place. An illegal one between two of the patch's faces claims them; one that leads elsewhere
// is left to others. True if it is a candidate.
GCDT_GIVEN_LOCAL bool test_in_patch(Patch p, Mesh mesh, global uint* edge_marks, volatile local uint* claims,
                                    uint round, uint place) {
  const uint e = edge_of_patch(p, mesh, place);
  if (edge_marks[e] & GCDT_MARK_CONSTRAINED) return false;
  const uint2 refs = faces_of_edge(mesh, e);
  if (refs.x == GCDT_NONE || refs.y == GCDT_NONE) return false;
  const uint t = face_in_patch(p, mesh, GCDT_REF_FACE(refs.x)), u = face_in_patch(p, mesh, GCDT_REF_FACE(refs.y));
  if (t == GCDT_NONE || u == GCDT_NONE) {
    atomic_or(edge_marks + e, GCDT_MARK_QUEUED);
    return false;
  }
  if (!is_illegal(mesh, refs.x, refs.y)) return false;
  const uint ticket = patch_ticket(p, round, place);
  atomic_max(claims + t, ticket);
  atomic_max(claims + u, ticket);
  return true;
}

// Flips the candidate in this place if it has both its faces; else it stays in the queue. Returns the flips.
GCDT_GIVEN_LOCAL uint flip_in_patch(Patch p, Mesh mesh, global uint* edge_marks, volatile local uint* claims,
                                    uint round, uint place, PatchQueue q) {
  const uint e = edge_of_patch(p, mesh, place), ticket = patch_ticket(p, round, place);
  const uint2 refs = faces_of_edge(mesh, e);
  const uint t = GCDT_REF_FACE(refs.x), u = GCDT_REF_FACE(refs.y);
  if (claims[face_in_patch(p, mesh, t)] != ticket || claims[face_in_patch(p, mesh, u)] != ticket) {
    queue_place(q, place);
    return 0u;
  }
  uint around[4];
  flip_edge(mesh, e, refs, mesh.face_data[GCDT_CORNERS(t)], mesh.face_data[GCDT_CORNERS(u)], around);
  queue_in_patch(p, mesh, q, edge_marks, GCDT_SIDE_EDGE(around[0]));
  queue_in_patch(p, mesh, q, edge_marks, GCDT_SIDE_EDGE(around[1]));
  queue_in_patch(p, mesh, q, edge_marks, GCDT_SIDE_EDGE(around[2]));
  queue_in_patch(p, mesh, q, edge_marks, GCDT_SIDE_EDGE(around[3]));
  return 1u;
}

#endif  // __OPENCL_VERSION__

#endif
