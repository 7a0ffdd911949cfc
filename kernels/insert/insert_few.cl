// SPDX-License-Identifier: Apache-2.0
// Insertion's rounds where few vertices are left. It saves launches alone: insert.cl does the same rounds.
#include "insert/insert.h"

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
