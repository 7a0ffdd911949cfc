// SPDX-License-Identifier: Apache-2.0
// Insertion of a level's vertices in rounds, and of problems' (insert.h).
#include "insert/insert.h"

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
