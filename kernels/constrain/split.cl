// SPDX-License-Identifier: Apache-2.0
// Splitting constraints that cross (docs/splitting.md): the pixels of the crossings become vertices, and each
// constraint that crosses another is routed through the centres of all pixels of vertices that it meets.
#include "common/mesh.h"
#include "common/search.h"
#include "constrain/snap.h"

// One work-item per crossing pair of pieces. Writes the pixel of the crossing as key (x, y), the least pair of
// constraints that run along the two, and its own number, from place `before` on; adds the pairs of constraints to the
// 64-bit total. No race: each its own words; the sum does not depend on order.
kernel void split_points(uint count, uint before, global const int2* points, global const uint2* ends,
                         global const uint* offsets, global const uint* sources, global const uint2* pairs,
                         global ulong* keys, global uint2* named, global uint* numbers, volatile global uint* total) {
  u64 mine = 0;
  FOR_EACH(i, count) {
    const uint c = pairs[i].x, d = pairs[i].y;
    const Vertex a1 = vertex_at(points, ends[c].x), b1 = vertex_at(points, ends[c].y);
    i64 s = 1, r = 1;
    gcdt_segments_cross(a1, b1, vertex_at(points, ends[d].x), vertex_at(points, ends[d].y), &s, &r);
    const i64 x = gcdt_round_division(a1.x, b1.x, s, r), y = gcdt_round_division(a1.y, b1.y, s, r);
    // Sources of a piece are ascending, and no constraint crosses itself.
    const uint least_c = sources[offsets[c]], least_d = sources[offsets[d]];
    keys[before + i] = ((u64)x << 31) | (u64)y;
    named[before + i] = (uint2)(min(least_c, least_d), max(least_c, least_d));
    mine += (u64)(offsets[c + 1u] - offsets[c]) * (offsets[d + 1u] - offsets[d]);
  }
  FOR_EACH(i, before + count) numbers[i] = i;
  add_wide(total, total + 1, mine);
}

// One work-item per sorted key; `firsts` counts the distinct keys before each. Writes each distinct key, and the least
// first constraint of all that have it. No race but atomic_min: the least wins.
kernel void split_least_first(uint count, global const ulong* keys, global const uint* numbers,
                              global const uint* firsts, global const uint2* named, global ulong* distinct,
                              volatile global uint2* least) {
  FOR_EACH(i, count) {
    const uint slot = firsts[i + 1u] - 1u;
    if (firsts[i] == slot) distinct[slot] = keys[i];
    atomic_min((volatile global uint*)(least + slot), named[numbers[i]].x);
  }
}

// The same for the second constraint of the pairs that have that first one. After: least[s] is the least pair.
kernel void split_least_second(uint count, global const uint* numbers, global const uint* firsts,
                               global const uint2* named, volatile global uint2* least) {
  FOR_EACH(i, count) {
    const uint slot = firsts[i + 1u] - 1u;
    const uint2 pair = named[numbers[i]];
    volatile global uint* words = (volatile global uint*)(least + slot);
    if (pair.x == words[0]) atomic_min(words + 1, pair.y);
  }
}

// One work-item per crossing pair of pieces. Marks the constraints along both, and counts those that were not marked.
// `linked`: the sources of pieces are links, which have owners. No race but atomics that any order leaves the same.
kernel void split_touch(uint count, uint linked, global const uint* offsets, global const uint* sources,
                        global const uint* owners, global const uint2* pairs, volatile global uint* touched,
                        volatile global uint* newly) {
  FOR_EACH(i, count)
  for (uint side = 0; side < 2u; ++side) {
    const uint piece = side ? pairs[i].y : pairs[i].x;
    for (uint j = offsets[piece]; j < offsets[piece + 1u]; ++j) {
      const uint c = linked ? owners[sources[j]] : sources[j];
      if (touched[c] == 0u && atomic_or(touched + c, 1u) == 0u) atomic_inc(newly);
    }
  }
}

// One work-item per distinct pixel. Flags those whose centre is no vertex yet: vertices by rank are in the order of
// their Morton codes. No race: each its own word.
kernel void split_is_new(uint count, GCDT_LEVELS_POINTER levels, global const int2* points, global const ulong* keys,
                         global uint* flags) {
  FOR_EACH(i, count) {
    const uint x = (uint)(keys[i] >> 31), y = (uint)(keys[i] & 0x7FFFFFFFu);
    const uint last = levels->count - 1u,
               before = last_on_curve(levels, last, points, 0u, levels->n, (int2)((int)x, (int)y));
    const int2 p = points[gcdt_vertex_of_rank(levels, last, before)];
    flags[i] = p.x == (int)x && p.y == (int)y ? 0u : 1u;
  }
}

// One work-item per vertex, of the input and added. Writes its grid point, and what is kept of an added one. No race.
kernel void split_join(uint inputs, uint added, global const int2* points, global const uint* input_vertex,
                       global const uint* list, global const ulong* keys, global const uint2* least,
                       global int2* joined, global int2* added_points, global uint2* added_pairs) {
  FOR_EACH(i, inputs + added) {
    if (i < inputs) {
      joined[i] = points[input_vertex[i]];
      continue;
    }
    const uint slot = list[i - inputs];
    const int2 at = (int2)((int)(keys[slot] >> 31), (int)(keys[slot] & 0x7FFFFFFFu));
    joined[i] = at;
    added_points[i - inputs] = at;
    added_pairs[i - inputs] = least[slot];
  }
}

// One work-item per rank. Writes the Morton code of the vertex with that rank. No race. After: ascending.
kernel void split_codes(uint n, GCDT_LEVELS_POINTER levels, global const int2* points, global ulong* codes) {
  FOR_EACH(rank, n) {
    const int2 p = points[gcdt_vertex_of_rank(levels, levels->count - 1u, rank)];
    codes[rank] = gcdt_morton((uint)p.x, (uint)p.y);
  }
}

// One work-item per marked constraint. Writes its ends as vertices. No race.
kernel void split_ends(uint count, global const uint* list, global const uint2* constraints,
                       global const uint* input_vertex, global uint2* ends) {
  FOR_EACH(i, count) {
    const uint2 c = constraints[list[i]];
    ends[i] = (uint2)(input_vertex[c.x], input_vertex[c.y]);
  }
}
