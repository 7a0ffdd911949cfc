// SPDX-License-Identifier: Apache-2.0
// Phase 1: bulk-synchronous vertex insertion with a history tree (paper, section 5, algorithm 1).
//
// A round: every vertex not yet inserted (Active in a face, or OnEdge) locates itself among the
// children of what was split and votes for its face, or for both faces of its edge; winners split.
// One round is two kernels, or one pass of insert_rounds or insert_problems, which do whole rounds inside one
// work-group; all run the same functions.
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

// One work-item per face of the coarser mesh. Reads the mesh; writes the frozen top layer, and for each vertex the face
// of the greatest number: of the faces around it those that are greater than both beside them, one of which is the
// greatest, ask by atomic_max, so the order of work-items cannot matter (vertex_face starts at 0). After: the top layer
// stands apart from the mesh, each face a leaf; the counters, which nobody else uses in this launch, are zero.
// (They come as words: of a pointer to words that is made of one to a struct, Mesa 22.3 stores the first alone.)
kernel void insert_freeze(uint faces, GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS, global uint* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(i, (uint)(sizeof(Counters) / sizeof(uint))) { counters[i] = 0u; }
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  FOR_EACH(t, faces) {
    const uint4 c = mesh.face_data[GCDT_CORNERS(t)], s = mesh.face_data[GCDT_SIDES(t)];
    const uint a0 = mesh.edge_faces[s.x ^ 1u], a1 = mesh.edge_faces[s.y ^ 1u], a2 = mesh.edge_faces[s.z ^ 1u];
    h.top[GCDT_CORNERS(t)] = (uint4)(c.x, c.y, c.z, HISTORY_REF(t, HISTORY_LEAF));
    const uint3 across = (uint3)(a0 == GCDT_NONE ? a0 : GCDT_REF_FACE(a0), a1 == GCDT_NONE ? a1 : GCDT_REF_FACE(a1),
                                 a2 == GCDT_NONE ? a2 : GCDT_REF_FACE(a2));
    h.top[GCDT_SIDES(t)] = (uint4)(across.x, across.y, across.z, 0u);
    mesh.face_data[GCDT_CORNERS(t)].w = 0u;
    const bool above_x = a0 == GCDT_NONE || t > across.x, above_y = a1 == GCDT_NONE || t > across.y,
               above_z = a2 == GCDT_NONE || t > across.z;
    if (c.x < n && above_y && above_z) atomic_max(h.vertex_face + c.x, t);
    if (c.y < n && above_x && above_z) atomic_max(h.vertex_face + c.y, t);
    if (c.z < n && above_x && above_y) atomic_max(h.vertex_face + c.z, t);
  }
}

// Vertex v's first location, found by a walk in the top layer from the coarser vertex before it on the curve; and its
// vote there. The claim words of the faces that it will bring become 0, which is nobody's ticket (split_if_won).
static void locate_and_vote(GCDT_LEVELS_POINTER levels, uint level, Mesh mesh, History h, Round r, uint v,
                            private uint* steps, volatile global Counters* counters) {
  Germ g;
  g.p = vertex_at(mesh.points, v);
  g.q = g.p;
  g.k = 0;
  g.parts = 1;
  uint zero;
  const uint t = find_in_top_layer(levels, level, mesh, h, g, v, true, GCDT_NONE, steps, &zero);
  uint location = t;
  if (t == GCDT_NONE)
    atomic_or(&counters->failed, GCDT_FAILED_WALK), location = root_of(mesh.points, mesh.n, v);
  else if (zero != 3u)
    location = ON_EDGE | GCDT_SIDE_EDGE(element(mesh.face_data[GCDT_SIDES(t)], zero));
  h.nodes[v - h.begin] = (uint4)(location, 0u, 0u, 0u);
  h.shape[v - h.begin] = 0u;
  *claim_word(mesh.face_data, new_face(mesh, v, 0u)) = *claim_word(mesh.face_data, new_face(mesh, v, 1u)) = 0u;
  vote(mesh, r, v, location);
}

// One work-item per vertex of the level. Reads the top layer. Writes its own record and shape, its place in the list,
// the claim words of its own faces, and its first vote (atomic_max: the greatest ticket wins whatever the order);
// work-item 0 the list's length. After: every vertex of the level has a location, and round 1's votes are cast.
kernel void insert_locate(uint level, uint bits, GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS,
                          GCDT_HISTORY_PARAMETERS, global uint* list, volatile global Counters* counters) {
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const Round r = make_round(1u, 1u, bits, begin);
  uint steps = 0;
  if (get_global_id(0) == 0) counters->list_insert[1] = end - begin;
  FOR_EACH(i, end - begin) {
    list[i] = begin + i;
    locate_and_vote(levels, level, mesh, h, r, begin + i, &steps, counters);
  }
  add_for_group(&sum, &counters->steps_low, &counters->steps_high, steps);
}

// A tile of the vertices in a list, by the whole group: those not inserted yet locate themselves and vote.
GCDT_GIVEN_LOCAL void vote_tile(Mesh mesh, History h, Round r, global const uint* list, uint count, uint tile,
                                Appender left) {
  const uint i = tile + get_local_id(0);
  if (i < count && relocate_and_vote(mesh, h, r, list[i])) append(left, list[i]);
  append_flush(left, APPEND_CAPACITY / 2u);
}

// One work-item per vertex in the list of the round before. Reads the mesh; writes its own record and
// appends itself to this round's list if still not inserted (append.h: the list's order is free, no
// later result depends on it); votes by atomic_max. After: list_insert[number & 1] counts the vertices
// left and every one of them has voted.
kernel void insert_vote(uint number, uint stamp, uint bits, GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS,
                        global const uint* list_before, global uint* list, volatile global Counters* counters) {
  DECLARE_APPENDER(left);
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const Appender a = make_appender(left_items, left_gathered, list, &counters->list_insert[number & 1u]);
  const Round r = make_round(number, stamp, bits, begin);
  const uint count = counters->list_insert[(number & 1u) ^ 1u];
  FOR_EACH_TILE(tile, count) vote_tile(mesh, h, r, list_before, count, tile, a);
  append_flush(a, 0u);
}

// One work-item per vertex in the list. Reads the votes; a winner writes its faces, its three new
// edges, its faces' sides of the edges around (L1: no word has two owners), its shape, and, if `tree` says that points
// are to be located in the tree, its record and the one reference to its leaf (hang_node). Work-item 0 also empties the
// list of the next round, which no other work-item of this launch touches. After: winners are vertices of the mesh.
kernel void insert_split(uint tree, uint number, uint stamp, uint bits, GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS,
                         global const uint* list, volatile global Counters* counters) {
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const Round r = make_round(number, stamp, bits, begin);
  const uint count = counters->list_insert[number & 1u];
  if (get_global_id(0) == 0) counters->list_insert[(number & 1u) ^ 1u] = 0u;
  uint on_edges = 0;
  FOR_EACH(i, count)
  on_edges += split_if_won(mesh, h, r, tree, list[i], counters);
  on_edges = sum_of_group(&sum, on_edges);
  if (get_local_id(0) == 0 && on_edges > 0u) atomic_add(&counters->edge_splits, on_edges);
}

// One work-item per vertex in the list. Re-casts this round's vote with a new stamp after the claim
// words were cleared (the stamps were used up). atomic_max as above.
kernel void insert_revote(uint number, uint stamp, uint bits, GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS,
                          global const uint* list, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const uint count = counters->list_insert[number & 1u];
  FOR_EACH(i, count)
  vote(mesh, make_round(number, stamp, bits, begin), list[i], h.nodes[list[i] - begin].x);
}

// ---- Rounds of one work-group ----------------------------------------------------------------------

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

// One work-group. Does up to `most` rounds, but none if more than `few` vertices are listed: the host launches it
// before it knows. After: list_insert of the next round's parity counts the vertices left, counters->rounds the rounds
// done.
GCDT_BY_ONE_GROUP kernel void insert_rounds(uint tree, uint number, uint stamp, uint bits, uint few, uint most,
                                            GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS, global uint* list_even,
                                            global uint* list_odd, volatile global Counters* counters) {
  DECLARE_APPENDER(left);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  uint on_edges = 0;
  const uint rounds = counters->list_insert[number & 1u] > few ? 0u : most;
  const uint done = insert_in_group(mesh, h, make_round(number, stamp, bits, begin), tree, rounds, list_even, list_odd,
                                    counters->list_insert, counters, left_items, left_gathered, &on_edges);
  on_edges = sum_of_group(&sum, on_edges);
  if (get_local_id(0) == 0) {
    counters->rounds += done;
    counters->edge_splits += on_edges;
  }
}

#ifdef GCDT_FOREST

// One work-group per problem from `begin_problem` up to `end_problem`. Inserts its vertices of the level in up to
// `most` rounds from round `number` on; in round 1 it locates them first. Tickets count from the problem's first such
// vertex, so `bits` are as many as the largest problem needs, and stamps are the rounds' numbers. Reads: the top layer.
// Writes: the problem's faces, edges, and records of vertices, its part of both lists, and
//   lengths[2p], lengths[2p + 1], theirs.
// A problem has one work-group, and its vertices lie in faces of its own (forest.h).
// After: list_insert[0] is greater by the vertices left; counters->rounds is the number of the last round done.
kernel void insert_problems(uint begin_problem, uint end_problem, uint level, uint tree, uint number, uint bits,
                            uint most, GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS,
                            global uint* list_even, global uint* list_odd, global uint* lengths,
                            volatile global Counters* counters) {
  DECLARE_APPENDER(left);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  uint steps = 0, on_edges = 0, last = 0;
  FOR_EACH_OF_GROUPS(p, begin_problem, end_problem) {
    const uint2 units = units_of_problem(levels, level, points, n, p);
    const uint first = gcdt_vertices_before(levels, level, units.x),
               count = gcdt_vertices_before(levels, level, units.y) - first;
    const Round r = make_round(number, number, bits, begin + first);
    volatile global uint* own = lengths + 2u * p;
    if (number == 1u) {
      for (uint i = first + get_local_id(0); i < first + count; i += get_local_size(0)) {
        list_odd[i] = begin + i;
        locate_and_vote(levels, level, mesh, h, r, begin + i, &steps, counters);
      }
      if (get_local_id(0) == 0) own[1] = count;
      barrier(CLK_GLOBAL_MEM_FENCE);
    }
    const uint next = number + insert_in_group(mesh, h, r, tree, most, list_even + first, list_odd + first, own,
                                               counters, left_items, left_gathered, &on_edges);
    last = max(last, next - 1u);
    if (get_local_id(0) == 0) {
      const uint vertices_left = own[next & 1u];
      if (vertices_left > 0u)
        atomic_add(&counters->list_insert[0], vertices_left);
      else
        own[0] = own[1] = 0u;  // whatever the number of the round that a further launch begins with
    }
  }
  add_for_group(&sum, &counters->steps_low, &counters->steps_high, steps);
  on_edges = sum_of_group(&sum, on_edges);
  if (get_local_id(0) == 0) {
    if (on_edges > 0u) atomic_add(&counters->edge_splits, on_edges);
    atomic_max(&counters->rounds, last);
  }
}

#endif
