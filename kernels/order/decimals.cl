// SPDX-License-Identifier: Apache-2.0
// The order phase where coordinates may be decimals: a program of its own, which inputs of other numbers do not wait
// for.
#include "order/maxima.h"
#include "order/vertices.h"

// One work-group per row of the table, over its share of the vertices.
// Reads: coordinates, all finite. Writes: maxima[row]: the most decimals that a coordinate needs to be
//   written, `limit` + 1 if one of them cannot be written with `limit`. `memory`: see put_greatest.
// A row has one work-group.
// After this kernel the maximum of the table is the number of decimals of the whole input.
kernel void count_decimals(uint n, uint type, global const ulong* coordinates, int limit, uint rows,
                           global ulong* maxima, local ulong* memory) {
  FOR_EACH_OF_GROUPS(row, 0u, rows) {
    const ulong digits = (ulong)decimals_of_items(items_of_row(n, row, rows), type, coordinates, limit);
    put_greatest(&digits, 1u, memory, maxima + row);
  }
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
