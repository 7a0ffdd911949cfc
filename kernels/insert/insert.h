// SPDX-License-Identifier: Apache-2.0
// Phase 1: bulk-synchronous vertex insertion with a history tree (paper, section 5, algorithm 1).
//
// A round: every vertex not yet inserted (Active in a face, or OnEdge) locates itself among the
// children of what was split and votes for its face, or for both faces of its edge; winners split.
// One round is two kernels (insert.cl), or one pass of insert_rounds (insert_few.cl) or insert_problems, which do whole
// rounds inside one work-group; all run the same functions. OpenCL C only.
#ifndef GCDT_INSERT_H
#define GCDT_INSERT_H

#include "common/append.h"
#include "common/history.h"
#include "common/split_face.h"

// Until a vertex is inserted its record in `nodes` holds (location, depth, -, -).
// location: a face, or an edge with this bit.
#define ON_EDGE 0x80000000u

typedef struct Round {
  u32 number;  // from 1; stands in `shape` of the vertices that it inserts
  u32 stamp, bits;
  u32 first;  // of the vertices that have tickets for the same faces
} Round;

static inline Round make_round(uint number, uint stamp, uint bits, uint first) {
  const Round r = {.number = number, .stamp = stamp, .bits = bits, .first = first};
  return r;
}

static inline Round next_round(Round r) { return make_round(r.number + 1u, r.stamp + 1u, r.bits, r.first); }

static inline uint ticket_of(Round r, uint v) { return make_ticket(r.stamp, r.bits, v - r.first); }

static inline bool inserted_in(History h, uint v, uint round) {
  return v >= h.begin && v < h.end && (h.shape[v - h.begin] >> 8) == round;
}

// Slot t holds the first child of what was split by m in the last round: which child holds v, or which spoke?
//   of a face: (m, p1, p2); p0 is found in child 2 = (m, p0, p1)
//   of one side of an edge: (m, a, b); its sibling (m, c, a) is f1 on side 0 and f2 on side 1
static uint child_of(Mesh mesh, History h, Vertex v, uint m, uint t) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(t)];
  const Vertex vm = vertex_at(mesh.points, m), y = load_vertex(mesh.points, mesh.n, c.y);
  if ((h.shape[m - h.begin] & 3u) != SHAPE_FACE) {
    const uint side = mesh.face_data[GCDT_CORNERS(new_face(mesh, m, 0u))].z == c.y ? 0u : 1u;
    const i64 s = gcdt_orient2d_from(vm, y, v);
    if (s > 0) return t;
    if (s < 0) return new_face(mesh, m, side);
    return ON_EDGE | new_edge(mesh, m, 1u + side);
  }
  const Vertex x = load_vertex(mesh.points, mesh.n, mesh.face_data[GCDT_CORNERS(new_face(mesh, m, 1u))].y),
               z = load_vertex(mesh.points, mesh.n, c.z);
  const i64 s0 = gcdt_orient2d_from(vm, x, v), s1 = gcdt_orient2d_from(vm, y, v), s2 = gcdt_orient2d_from(vm, z, v);
  if (s1 > 0 && s2 < 0) return t;
  if (s2 > 0 && s0 < 0) return new_face(mesh, m, 0u);
  if (s0 > 0 && s1 < 0) return new_face(mesh, m, 1u);
  return ON_EDGE | new_edge(mesh, m, s0 == 0 ? 0u : s1 == 0 ? 1u : 2u);
}

// v lies on edge e. If a vertex m was inserted on e in the last round, e is now one half and the new
// edge the other: v's half is the one on its side of m. All are collinear and finite.
static uint half_of_edge(Mesh mesh, History h, Vertex v, uint e, uint round) {
  const uint ref = mesh.edge_faces[2u * e];
  const uint4 r = rotate_to(mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))], GCDT_REF_CORNER(ref));
  const bool first = inserted_in(h, r.y, round);
  if (!first && !inserted_in(h, r.z, round)) return ON_EDGE | e;
  const uint m = first ? r.y : r.z;
  const Vertex vm = vertex_at(mesh.points, m), b = vertex_at(mesh.points, first ? r.z : r.y);
  const i64 along = (b.x - vm.x) * (v.x - vm.x) + (b.y - vm.y) * (v.y - vm.y);
  return ON_EDGE | (along > 0 ? e : new_edge(mesh, m, 0u));
}

// The faces that a vertex must own to be inserted: one, or both sides of its edge.
static inline uint2 faces_of_location(Mesh mesh, uint location) {
  if (!(location & ON_EDGE)) return (uint2)(location, location);
  const uint e = location & ~ON_EDGE;
  return (uint2)(GCDT_REF_FACE(mesh.edge_faces[2u * e]), GCDT_REF_FACE(mesh.edge_faces[2u * e + 1u]));
}

static void vote(Mesh mesh, Round r, uint v, uint location) {
  const uint ticket = ticket_of(r, v);
  const uint2 f = faces_of_location(mesh, location);
  atomic_max(claim_word(mesh.face_data, f.x), ticket);
  if (f.y != f.x) atomic_max(claim_word(mesh.face_data, f.y), ticket);
}

// Moves v to where the last round's splits have put it. False if v is inserted itself.
static bool relocate_and_vote(Mesh mesh, History h, Round r, uint v) {
  const uint i = v - h.begin;
  if ((h.shape[i] & 3u) != 0u) return false;
  uint location = h.nodes[i].x, depth = h.nodes[i].y;
  const Vertex p = vertex_at(mesh.points, v);
  if (location & ON_EDGE) {
    location = half_of_edge(mesh, h, p, location & ~ON_EDGE, r.number - 1u);
    const uint beside = GCDT_REF_FACE(mesh.edge_faces[2u * (location & ~ON_EDGE)]);
    if (inserted_in(h, mesh.face_data[GCDT_CORNERS(beside)].x, r.number - 1u)) ++depth;
  } else {
    const uint m = mesh.face_data[GCDT_CORNERS(location)].x;
    if (inserted_in(h, m, r.number - 1u)) {
      ++depth;
      location = child_of(mesh, h, p, m, location);
    }
  }
  h.nodes[i] = (uint4)(location, depth, 0u, 0u);
  vote(mesh, r, v, location);
  return true;
}

// Hangs a new node below the leaf that stood for face t. Corner 0 of a face made in this level is the
// vertex whose split made it, else the face is a root. Only t's owner writes the word found; reading
// next[2] while the owner of side 1's first child replaces it is harmless, since neither its old nor
// its new value is then LEAF(t).
static void hang_node(Mesh mesh, History h, uint t, uint ref) {
  const uint m = mesh.face_data[GCDT_CORNERS(t)].x;
  if (m < h.begin || m >= h.end) {
    h.top[GCDT_CORNERS(t)].w = ref;
    return;
  }
  volatile global uint* next = (volatile global uint*)(h.nodes + (m - h.begin));
  const uint slot1 = new_face(mesh, m, 0u), slot2 = new_face(mesh, m, 1u);
  uint child;
  if ((h.shape[m - h.begin] & 3u) == SHAPE_FACE)
    child = t == slot1 ? 1u : t == slot2 ? 2u : 0u;
  else
    child = t == slot1 ? 1u : t == slot2 ? 3u : next[2] == HISTORY_REF(t, HISTORY_LEAF) ? 2u : 0u;
  next[child] = ref;
}

// Hangs v's node below the leaf of the face that it splits, or its two below those of the faces beside its edge.
static void hang_nodes(Mesh mesh, History h, uint v, uint2 faces) {
  const uint nodes = faces.x == faces.y ? 1u : 2u;
  for (uint i = 0; i < nodes; ++i)
    hang_node(mesh, h, i == 0u ? faces.x : faces.y, HISTORY_REF(v, nodes == 1u ? HISTORY_FACE : HISTORY_SIDE0 + i));
}

// Splits face t at v.
static void insert_in_face(Mesh mesh, History h, Round r, uint tree, uint v, uint t) {
  split_face(mesh, v, t, 0u, false);
  if (tree)
    h.nodes[v - h.begin] = (uint4)(HISTORY_REF(t, HISTORY_LEAF), HISTORY_REF(new_face(mesh, v, 0u), HISTORY_LEAF),
                                   HISTORY_REF(new_face(mesh, v, 1u), HISTORY_LEAF), 0u);
  h.shape[v - h.begin] = (r.number << 8) | SHAPE_FACE;
}

// Splits edge e at v.
static void insert_on_edge(Mesh mesh, History h, Round r, uint tree, uint v, uint e) {
  const uint ref0 = mesh.edge_faces[2u * e], ref1 = mesh.edge_faces[2u * e + 1u];
  const uint t = GCDT_REF_FACE(ref0), u = GCDT_REF_FACE(ref1);
  split_edge(mesh, v, e, 0u, false);
  if (tree)
    h.nodes[v - h.begin] = (uint4)(HISTORY_REF(t, HISTORY_LEAF), HISTORY_REF(new_face(mesh, v, 0u), HISTORY_LEAF),
                                   HISTORY_REF(u, HISTORY_LEAF), HISTORY_REF(new_face(mesh, v, 1u), HISTORY_LEAF));
  h.shape[v - h.begin] = (r.number << 8) | (GCDT_REF_CORNER(ref1) << 4) | (GCDT_REF_CORNER(ref0) << 2) | SHAPE_EDGE;
}

// Splits if v owns what it voted for, and hangs v's nodes into the tree if that is wanted. The node's depth (of its
// side 0 if it has two) is reported; the plain read before atomic_max only saves atomics. A loser may read a claim word
// that a winner has reset to 0 or an edge's face that a winner has replaced by a new one, whose claim word was 0 before
// (locate_and_vote): whatever it reads is not its ticket. Returns 1 if an edge was split.
static uint split_if_won(Mesh mesh, History h, Round r, uint tree, uint v, volatile global Counters* counters) {
  const uint location = h.nodes[v - h.begin].x;
  const uint ticket = ticket_of(r, v);
  const uint2 f = faces_of_location(mesh, location);
  if (*claim_word(mesh.face_data, f.x) != ticket) return 0u;
  if (f.y != f.x && *claim_word(mesh.face_data, f.y) != ticket) return 0u;
  const uint depth = h.nodes[v - h.begin].y + 1u;
  if (depth > counters->history_depth) atomic_max(&counters->history_depth, depth);
  if (tree) hang_nodes(mesh, h, v, f);
  if (location & ON_EDGE) {
    insert_on_edge(mesh, h, r, tree, v, location & ~ON_EDGE);
    return 1u;
  }
  insert_in_face(mesh, h, r, tree, v, location);
  return 0u;
}

// A tile of the vertices in a list, by the whole group: those not inserted yet locate themselves and vote.
GCDT_GIVEN_LOCAL void vote_tile(Mesh mesh, History h, Round r, global const uint* list, uint count, uint tile,
                                Appender left) {
  const uint i = tile + get_local_id(0);
  if (i < count && relocate_and_vote(mesh, h, r, list[i])) append(left, list[i]);
  append_flush(left, APPEND_CAPACITY / 2u);
}

// One work-group, all of it with the same arguments. Up to `most` rounds from r on, whose votes are cast: split, then
// relocate and vote for the next. Lists are by parity of the round, as are lengths[0 .. 1]. Barriers order what two
// kernels do otherwise; the same argument holds for each part. Nobody else touches the faces that these vertices lie
// in. The loop ends: a round with vertices left has a winner. Returns how many were done; the list of the next round
// holds the vertices left.
GCDT_GIVEN_LOCAL uint insert_in_group(Mesh mesh, History h, Round r, uint tree, uint most, global uint* list_even,
                                      global uint* list_odd, volatile global uint* lengths,
                                      volatile global Counters* counters, local uint* items, local uint* gathered,
                                      private uint* on_edges) {
  uint done = 0;
  for (;; r = next_round(r)) {
    const uint now = r.number & 1u;
    const uint count = lengths[now];
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (count == 0u || done == most) break;
    global uint* list = now ? list_odd : list_even;
    global uint* list_next = now ? list_even : list_odd;
    if (get_local_id(0) == 0) lengths[now ^ 1u] = 0u;
    for (uint i = get_local_id(0); i < count; i += get_local_size(0))
      *on_edges += split_if_won(mesh, h, r, tree, list[i], counters);
    barrier(CLK_GLOBAL_MEM_FENCE);
    const Appender a = make_appender(items, gathered, list_next, &lengths[now ^ 1u]);
    FOR_ALL_TILES(tile, count) vote_tile(mesh, h, next_round(r), list, count, tile, a);
    append_flush(a, 0u);
    barrier(CLK_GLOBAL_MEM_FENCE);
    ++done;
  }
  return done;
}

#endif
