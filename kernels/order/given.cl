// SPDX-License-Identifier: Apache-2.0
// Vertices as they were given against vertices on the grid: which of those that rounding made one were not.
#include "common/loops.h"
#include "order/quantise.h"

// Three words a problem: how many of its vertices were given elsewhere than the one that stands for them; the least of
// these; the one that stands for it.
#define GCDT_TOGETHER_WORDS 3u

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
    uint low = 0u, high = problems;  // v is in a problem from `low` to below `high`
    while (high - low > 1u) {
      const uint middle = low + (high - low) / 2u;
      if (first_input[middle] <= v)
        low = middle;
      else
        high = middle;
    }
    atomic_inc(found + GCDT_TOGETHER_WORDS * low);
    atomic_min(found + GCDT_TOGETHER_WORDS * low + 1u, v);
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
