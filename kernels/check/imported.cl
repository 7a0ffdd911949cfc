// SPDX-License-Identifier: Apache-2.0
// A mesh that was not made here, as the check wants it: vertices for input numbers, pieces in order.
#include "common/levels.h"

// One work-item per corner.
// Reads input_vertex (`inputs` elements) and vertex_input. Replaces corners[i], of which it is the one reader.
// After this kernel corners[i] is the vertex whose representative it was, GCDT_NONE if it was no such number.
kernel void corners_to_vertices(const uint count, const uint inputs, global const uint* input_vertex,
                                global const uint* vertex_input, global uint* corners) {
  FOR_EACH(i, count) {
    const uint c = corners[i], v = c < inputs ? input_vertex[c] : 0u;
    corners[i] = c < inputs && vertex_input[v] == c ? v : GCDT_NONE;
  }
}

// One work-item per piece.
// Reads pieces (pairs of input numbers) and vertices. Writes keys[i] and numbers[i]; *bad by atomic_min.
// Words i have one writer; the least bad piece is the same in any order.
// After this kernel keys[i] holds the ranks of the ends, the lesser first; *bad is the least piece with an end that is
// no vertex or with two ends at one vertex, GCDT_NONE (as before) if there is none.
kernel void piece_keys(const uint count, const uint inputs, const uint bits, global const Levels* levels,
                       global const uint2* pieces, global const uint* input_vertex, global ulong* keys,
                       global uint* numbers, volatile global uint* bad) {
  FOR_EACH(i, count) {
    const uint2 p = pieces[i];
    uint a = 0u, b = 0u;
    if (p.x < inputs && p.y < inputs) {
      a = gcdt_rank_of_vertex(levels, input_vertex[p.x]);
      b = gcdt_rank_of_vertex(levels, input_vertex[p.y]);
    }
    if (a == b) atomic_min(bad, i);
    keys[i] = ((ulong)min(a, b) << bits) | max(a, b);
    numbers[i] = i;
  }
}

// One work-item per place in the sorted order.
// Reads keys and numbers, sorted. Writes ends[i]; *twice by atomic_min.
// Words i have one writer; the least is the same in any order.
// After this kernel ends are the pieces' vertices in order; *twice is the least piece that has the ends of another
// before it in that order, GCDT_NONE (as before) if there is none.
kernel void piece_ends(const uint count, const uint bits, global const Levels* levels, global const ulong* keys,
                       global const uint* numbers, global uint2* ends, volatile global uint* twice) {
  FOR_EACH(i, count) {
    const ulong key = keys[i];
    if (i > 0u && keys[i - 1u] == key) atomic_min(twice, numbers[i]);
    ends[i] = (uint2)(gcdt_vertex_of_rank(levels, levels->count - 1u, (uint)(key >> bits)),
                      gcdt_vertex_of_rank(levels, levels->count - 1u, (uint)(key & (((ulong)1 << bits) - 1u))));
  }
}
