// SPDX-License-Identifier: Apache-2.0
// The order phase: survey the coordinates, put them on the grid, number the distinct vertices along
// the Z-order curve. Integer arithmetic only; 64-bit maxima are folded in two steps, since not every
// device has 64-bit atomics, and a maximum does not depend on the order of folding.
#include "common/levels.h"
#include "order/quantise.h"

// What `survey` finds, as maxima: columns of its table.
#define GCDT_SURVEY_COLUMNS 6u

// What `survey` finds in the share `row` of `rows`.
static void survey_share(uint n, uint type, global const ulong* coordinates, uint row, uint rows, global ulong* out) {
  ulong least[2] = {0, 0}, most[2] = {0, 0}, trailing = 0, bad = 0;
  FOR_SHARE(v, n, row, rows) {
    for (uint axis = 0; axis < 2; ++axis) {
      const ulong bits = gcdt_coordinate(coordinates, type, 2 * v + axis);
      if (!gcdt_is_finite(bits)) {
        bad = max(bad, ~(ulong)(2 * v + axis));
        continue;
      }
      const ulong key = gcdt_ordered(bits);
      least[axis] = max(least[axis], ~key);
      most[axis] = max(most[axis], key);
      if (bits != 0) trailing = max(trailing, ~(ulong)(gcdt_trailing_exponent(bits) - GCDT_LEAST_EXPONENT));
    }
  }
  out[0] = least[0];
  out[1] = most[0];
  out[2] = least[1];
  out[3] = most[1];
  out[4] = trailing;
  out[5] = bad;
}

// One work-item per row of the table, over its share of the vertices.
// Reads: coordinates. Writes: maxima[row][0..5]: ~min x, max x, ~min y, max y (ordered keys), the
//   complement of the least trailing exponent - GCDT_LEAST_EXPONENT (0: all coordinates are zero),
//   the complement of the least coordinate that is not finite (0: none).
// A row has one work-item. A coordinate that is not finite counts in its own column only.
// After this kernel the folded table describes the whole input.
kernel void survey(uint n, uint type, global const ulong* coordinates, uint rows, global ulong* maxima) {
  FOR_EACH(row, rows)
  survey_share(n, type, coordinates, row, rows, maxima + (size_t)row * GCDT_SURVEY_COLUMNS);
}

// The most decimals that a coordinate of the share `row` of `rows` needs, `limit` + 1 if more than `limit`.
static int decimals_of_share(uint n, uint type, global const ulong* coordinates, int limit, uint row, uint rows) {
  // If d decimals suffice, d + 1 do: it is enough to raise the number where it does not.
  int digits = 0;
  FOR_SHARE(v, n, row, rows) {
    if (digits > limit) break;
    for (uint axis = 0; axis < 2; ++axis)
      digits = gcdt_decimals_needed(gcdt_coordinate(coordinates, type, 2 * v + axis), digits, limit);
  }
  return digits;
}

// One work-item per row of the table, over its share of the vertices.
// Reads: coordinates, all finite. Writes: maxima[row]: the most decimals that a coordinate needs to be
//   written, `limit` + 1 if one of them cannot be written with `limit`.
// A row has one work-item.
// After this kernel the folded table holds the number of decimals of the whole input.
kernel void count_decimals(uint n, uint type, global const ulong* coordinates, int limit, uint rows,
                           global ulong* maxima) {
  FOR_EACH(row, rows)
  maxima[row] = (ulong)decimals_of_share(n, type, coordinates, limit, row, rows);
}

// One work-item per element of the smaller table `folded`.
// Reads: maxima. Writes: folded[row][column], the maximum of that column over the rows of maxima
//   congruent to `row` modulo folded_rows.
// An element has one work-item.
// After this kernel the maxima of the columns of both tables are the same.
kernel void fold_maxima(uint rows, uint columns, global const ulong* maxima, uint folded_rows, global ulong* folded) {
  FOR_EACH(i, folded_rows * columns) {
    const uint column = i % columns;
    ulong most = 0;
    for (uint row = i / columns; row < rows; row += folded_rows)
      most = max(most, maxima[(size_t)row * columns + column]);
    folded[i] = most;
  }
}

// What `quantise` does with the share `row` of `rows`.
static void quantise_share(uint n, uint type, global const ulong* coordinates, global const Scale* scale, uint row,
                           uint rows, global ulong* keys, global uint* values, global ulong* out) {
  ulong move = 0, outside = 0;
  FOR_SHARE(v, n, row, rows) {
    const Quantised x = gcdt_quantise(gcdt_coordinate(coordinates, type, 2 * v), scale, 0);
    const Quantised y = gcdt_quantise(gcdt_coordinate(coordinates, type, 2 * v + 1), scale, 1);
    move = max(move, max(x.move, y.move));
    if (x.outside || y.outside) outside = max(outside, ~(ulong)(2 * v + (x.outside ? 0 : 1)));
    keys[v] = gcdt_morton(x.value, y.value);
    values[v] = v;
  }
  out[0] = move;
  out[1] = outside;
}

// One work-item per row of the table, over its share of the vertices.
// Reads: coordinates, all finite; scale. Writes: keys[v], the Morton code of v's grid point; values[v] = v;
//   maxima[row][0..1]: the largest move (gcdt_move_key), the complement of the least coordinate
//   outside the grid (0: none; else the keys are void).
// A row has one work-item, and a vertex belongs to one row.
// After this kernel a stable sort of the keys gives the order along the curve.
kernel void quantise(uint n, uint type, global const ulong* coordinates, global const Scale* scale, uint rows,
                     global ulong* keys, global uint* values, global ulong* maxima) {
  FOR_EACH(row, rows)
  quantise_share(n, type, coordinates, scale, row, rows, keys, values, maxima + (size_t)row * 2);
}

static void quantise_decimal(uint v, uint type, global const ulong* coordinates, global const Decimals* decimals,
                             global ulong* keys, global uint* values) {
  uint grid[2];
  for (uint axis = 0; axis < 2; ++axis) {
    const long numerator = gcdt_decimal_numerator(gcdt_coordinate(coordinates, type, 2 * v + axis), decimals->digits);
    grid[axis] = (uint)(((ulong)numerator - (ulong)decimals->least[axis]) * decimals->step);
  }
  keys[v] = gcdt_morton(grid[0], grid[1]);
  values[v] = v;
}

// One work-item per vertex.
// Reads: coordinates, all of which can be written with decimals->digits decimals. Writes: keys[v],
//   values[v] as `quantise` does.
// A vertex has one work-item.
// After this kernel a stable sort of the keys gives the order along the curve.
kernel void quantise_decimals(uint n, uint type, global const ulong* coordinates, global const Decimals* decimals,
                              global ulong* keys, global uint* values) {
  FOR_EACH(v, n) quantise_decimal(v, type, coordinates, decimals, keys, values);
}

// Whether the first of equal keys stands at place i.
static inline bool is_first(global const ulong* keys, uint i) { return i == 0 || keys[i] != keys[i - 1]; }

// One work-item per place in the sorted order.
// Reads: keys, ascending. Writes: first[i] = 1 if the key at i differs from the one before, else 0.
// A place has one work-item.
// After this kernel the scan of `first` counts the distinct keys before each place.
kernel void mark_first(uint n, global const ulong* keys, global uint* first) {
  FOR_EACH(i, n) first[i] = is_first(keys, i) ? 1u : 0u;
}

// Place i in the sorted order holds a vertex of the rank; `first`: the first of those with its key.
static inline void number_place(uint i, uint rank, bool first, global const Levels* levels, global const ulong* keys,
                                global const uint* values, global int2* points, global uint* vertex_input,
                                global uint* input_vertex) {
  const uint v = gcdt_vertex_of_rank(levels, levels->count - 1, rank);
  input_vertex[values[i]] = v;
  if (!first) return;
  points[v] = (int2)((int)gcdt_gather_bits(keys[i]), (int)gcdt_gather_bits(keys[i] >> 1));
  vertex_input[v] = values[i];
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
