// SPDX-License-Identifier: Apache-2.0
// The order phase: survey the coordinates, put them on the grid, number the distinct vertices along
// the Z-order curve. Integer arithmetic only; 64-bit maxima are folded in two steps, since not every
// device has 64-bit atomics, and a maximum does not depend on the order of folding.
#include "order/vertices.h"
#include "sort/mark_first.h"

// One work-item per row of the table, over its share of the vertices.
// Reads: coordinates. Writes: maxima[row], the columns of order.h.
// A row has one work-item. A coordinate that is not finite counts in its own column only.
// After this kernel the folded table describes the whole input.
kernel void survey(uint n, uint type, global const ulong* coordinates, uint rows, global ulong* maxima) {
  FOR_EACH(row, rows)
  survey_items(items_of_share(n, row, rows), 0u, type, coordinates, maxima + (size_t)row * GCDT_SURVEY_COLUMNS);
}

// One work-item per row of the table, over its share of the vertices.
// Reads: coordinates, all finite. Writes: maxima[row]: the most decimals that a coordinate needs to be
//   written, `limit` + 1 if one of them cannot be written with `limit`.
// A row has one work-item.
// After this kernel the folded table holds the number of decimals of the whole input.
kernel void count_decimals(uint n, uint type, global const ulong* coordinates, int limit, uint rows,
                           global ulong* maxima) {
  FOR_EACH(row, rows)
  maxima[row] = (ulong)decimals_of_items(items_of_share(n, row, rows), type, coordinates, limit);
}

// One work-item per element of the smaller table `folded`.
// Reads: maxima. Writes: folded[row][column], the maximum of that column over the rows of maxima
//   congruent to `row` modulo folded_rows.
// An element has one work-item.
// After this kernel the maxima of the columns of both tables are the same.
kernel void fold_maxima(uint rows, uint columns, global const ulong* maxima, uint folded_rows, global ulong* folded) {
  FOR_EACH(i, folded_rows * columns)
  folded[i] = greatest_of_items((Items)(i / columns, rows, folded_rows), i % columns, columns, maxima);
}

// One work-item per row of the table, over its share of the vertices.
// Reads: coordinates, all finite; scale. Writes: keys[v], the Morton code of v's grid point; values[v] = v;
//   maxima[row], the columns of order.h (if one is outside, the keys are void).
// A row has one work-item, and a vertex belongs to one row.
// After this kernel a stable sort of the keys gives the order along the curve.
kernel void quantise(uint n, uint type, global const ulong* coordinates, global const Scale* scale, uint rows,
                     global ulong* keys, global uint* values, global ulong* maxima) {
  FOR_EACH(row, rows)
  quantise_items(items_of_share(n, row, rows), 0u, type, coordinates, scale, keys, values,
                 maxima + (size_t)row * GCDT_QUANTISE_COLUMNS);
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
