// SPDX-License-Identifier: Apache-2.0
// Vertices as they were given against vertices on the grid: which of those that rounding made one were not.
#include "common/search.h"
#include "order/order.h"

// One work-item per input vertex.
// Reads: coordinates; vertex_input and input_vertex, as after number_vertices; first_input: where the inputs of each
//   problem begin, and their number behind. Writes: found, but for each third word; zero and GCDT_NONE before.
// Counts are only added to and minima only lowered, so the order does not matter.
// After this kernel the first two words of each problem are right.
kernel void count_together(uint n, uint problems, global const uint* first_input, uint type,
                           global const ulong* coordinates, global const uint* vertex_input,
                           global const uint* input_vertex, global uint* found) {
  FOR_EACH(v, n) {
    const uint other = vertex_input[input_vertex[v]];
    if (other == v ||
        (gcdt_coordinate(coordinates, type, 2u * v) == gcdt_coordinate(coordinates, type, 2u * other) &&
         gcdt_coordinate(coordinates, type, 2u * v + 1u) == gcdt_coordinate(coordinates, type, 2u * other + 1u)))
      continue;
    global uint* own = found + GCDT_TOGETHER_WORDS * last_begin(first_input, problems, v);
    atomic_inc(own);
    atomic_min(own + 1, v);
  }
}

// One work-item per problem.
// Reads: found, as after count_together; vertex_input and input_vertex. Writes: each third word, where the first is
//   not 0.
// A problem has one work-item.
// After this kernel `found` is complete.
kernel void name_together(uint problems, global const uint* vertex_input, global const uint* input_vertex,
                          global uint* found) {
  FOR_EACH(p, problems) {
    global uint* own = found + GCDT_TOGETHER_WORDS * p;
    if (own[0] != 0u) own[2] = vertex_input[input_vertex[own[1]]];
  }
}
