// SPDX-License-Identifier: Apache-2.0
// The order phase: survey the coordinates, put them on the grid, number the distinct vertices along
// the Z-order curve. Integer arithmetic only.
#include "order/isolation.h"
#include "order/maxima.h"
#include "order/vertices.h"
#include "sort/mark_first.h"

// One work-group per row of the table, over its share of the vertices.
// Reads: coordinates. Writes: maxima[row], the columns of order.h. `memory`: see put_greatest.
// A row has one work-group. A coordinate that is not finite counts in its own column only.
// After this kernel the maxima of the table's columns describe the whole input.
kernel void survey(uint n, uint type, global const ulong* coordinates, uint rows, global ulong* maxima,
                   local ulong* memory) {
  FOR_EACH_OF_GROUPS(row, 0u, rows) {
    ulong columns[GCDT_SURVEY_COLUMNS];
    survey_items(items_of_row(n, row, rows), 0u, type, coordinates, columns);
    put_greatest(columns, GCDT_SURVEY_COLUMNS, memory, maxima + (size_t)row * GCDT_SURVEY_COLUMNS);
  }
}

// One work-group per row of the table, over its share of the vertices.
// Reads: coordinates, all finite; scale. Writes: keys[v], the Morton code of v's grid point; values[v] = v;
//   maxima[row], the columns of order.h (if one is outside, the keys are void). `memory`: see put_greatest.
// A row has one work-group, and a vertex one work-item.
// After this kernel a stable sort of the keys gives the order along the curve.
kernel void quantise(uint n, uint type, global const ulong* coordinates, global const Scale* scale, uint rows,
                     global ulong* keys, global uint* values, global ulong* maxima, local ulong* memory) {
  FOR_EACH_OF_GROUPS(row, 0u, rows) {
    ulong columns[GCDT_QUANTISE_COLUMNS];
    quantise_items(items_of_row(n, row, rows), 0u, type, coordinates, scale, keys, values, columns);
    put_greatest(columns, GCDT_QUANTISE_COLUMNS, memory, maxima + (size_t)row * GCDT_QUANTISE_COLUMNS);
  }
}

// One work-item per place in the sorted order.
// Reads: levels; keys and values, sorted; before, the scan of mark_first (n + 1 elements).
// Writes: points[v], vertex_input[v] at the first place of v's key, input_vertex[values[i]] at every place.
// Distinct keys have distinct ranks, so distinct vertices; values is a permutation.
// After this kernel the vertices are numbered; as the sort was stable, vertex_input is the least input
// number at the grid point.
kernel void number_vertices(uint n, global const Levels* levels, global const ulong* keys, global const uint* values,
                            global const uint* before, global int2* points, global uint* vertex_input,
                            global uint* input_vertex) {
  FOR_EACH(i, n) {
    const uint rank = before[i + 1] - 1;
    number_place(i, rank, before[i] == rank, levels, keys, values, points, vertex_input, input_vertex);
  }
}

// ---- Isolated vertices ------------------------------------------------------------------------------

// How many pairs of bits two Morton codes begin with in common.
static inline uint common_depth(ulong a, ulong b) { return ((uint)clz(a ^ b) - (64u - GCDT_MORTON_BITS)) / 2u; }

// The first place of the next vertex on the curve behind place i, whose vertex has the rank; n if there is none. Ends:
// the range halves.
static inline uint next_place(uint n, global const ulong* keys, global const uint* before, uint i, uint rank) {
  if (i + 1u == n || keys[i + 1u] != keys[i]) return i + 1u;
  uint low = i + 1u, high = n;  // before[low] == rank + 1 at places of this vertex, greater behind them
  while (high - low > 0u) {
    const uint middle = low + (high - low) / 2u;
    if (before[middle + 1u] > rank + 1u)
      high = middle;
    else
      low = middle + 1u;
  }
  return low;
}

// Of the vertex whose first place is i.
static inline uint depth_at(uint n, global const ulong* keys, global const uint* before, uint i, uint rank) {
  const uint next = next_place(n, keys, before, i, rank);
  const uint behind = i > 0u ? common_depth(keys[i - 1u], keys[i]) : 0u;
  return max(behind, next < n ? common_depth(keys[i], keys[next]) : 0u);
}

// One work-item per place in the sorted order.
// Reads: keys, sorted; before, the scan of mark_first. Writes: counts, which were 0
// (isolation.h). Atomic additions, in local memory, then of each group's sums: their order cannot matter. After this
// kernel the sum of the counts is the number of distinct vertices.
kernel void count_depths(uint n, global const ulong* keys, global const uint* before, volatile global uint* counts) {
  local uint own[GCDT_DEPTH_COUNTS];
  for (uint k = get_local_id(0); k < GCDT_DEPTH_COUNTS; k += get_local_size(0)) own[k] = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  FOR_EACH(i, n) {
    const uint rank = before[i];
    if (before[i + 1u] == rank) continue;
    const uint depth = depth_at(n, keys, before, i, rank);
    atomic_inc((volatile local uint*)own + GCDT_DEPTH_COUNT(depth, gcdt_strides_of_rank(rank)));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint k = get_local_id(0); k < GCDT_DEPTH_COUNTS; k += get_local_size(0))
    if (own[k] > 0u) atomic_add(counts + k, own[k]);
}

// One work-item per place in the sorted order.
// Reads: keys, before. Writes: level_of_rank, and rank_of_rank[rank] = rank, of each vertex.
// A vertex has one first place.
// After this kernel a stable sort of the ranks by level numbers the vertices.
kernel void level_vertices(uint n, uint levels, global const DepthLevels* by_depth, global const ulong* keys,
                           global const uint* before, global ulong* level_of_rank, global uint* rank_of_rank) {
  FOR_EACH(i, n) {
    const uint rank = before[i];
    if (before[i + 1u] == rank) continue;
    level_of_rank[rank] = gcdt_level(levels, by_depth, gcdt_strides_of_rank(rank), depth_at(n, keys, before, i, rank));
    rank_of_rank[rank] = rank;
  }
}

// One work-item per vertex.
// Reads: rank_of_vertex, a permutation. Writes: the table behind levels.
// A vertex has one rank, and a rank one vertex.
// After this kernel the levels are those of the table.
kernel void table_levels(uint n, global const uint* rank_of_vertex, global Levels* levels) {
  global uint* table = (global uint*)GCDT_LEVELS_TABLE(levels);
  FOR_EACH(v, n) {
    table[v] = rank_of_vertex[v];
    table[n + rank_of_vertex[v]] = v;
  }
}
