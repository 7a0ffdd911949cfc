// SPDX-License-Identifier: Apache-2.0
// Rounds of flips by lists where few edges are left. It saves launches, and rounds of chains: flip.cl does the same.
#include "flip/slide.h"

// One work-group. Does up to `most` rounds from `round` on, but none if more than `few` edges are listed: the host
// launches it before it knows. After: list_test of the next round holds what is left; counters->rounds the rounds done.
GCDT_BY_ONE_GROUP kernel void flip_rounds(uint round, uint stamp, uint bits, uint few, uint most, GCDT_MESH_PARAMETERS,
                                          global uint* edge_marks, global uint* list, global uint* illegal,
                                          volatile global Counters* counters) {
  DECLARE_ROUNDS(memory);
  DECLARE_SLIDES(slides);
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const OwnLists own = {.list = list, .illegal = illegal, .tests = &counters->list_test[round % 3u]};
  uint flips = 0;
  const uint rounds = *own.tests > few ? 0u : most;
  const uint done = slide_in_group(mesh, edge_marks, stamp, bits, rounds, own, memory, slides, &flips);
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) == 0) {
    counters->list_test[(round + done) % 3u] = *own.tests;
    counters->list_flip[0] = counters->list_flip[1] = 0u;
    counters->rounds += done;
  }
}
