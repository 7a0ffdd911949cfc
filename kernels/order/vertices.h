// SPDX-License-Identifier: Apache-2.0
// What the order phase does with the vertices of one problem that a work-item is given, whether there is one problem
// (order.cl, by_one_item.cl) or many (forest.cl). OpenCL C only.
//
// `first` is the first vertex of the problem: coordinates are numbered in the problem, 2 * vertex + axis.
#ifndef GCDT_VERTICES_H
#define GCDT_VERTICES_H

#include "common/levels.h"
#include "order/order.h"

// The columns of a survey of these vertices.
GCDT_APART void survey_items(Items items, uint first, uint type, global const ulong* coordinates, private ulong* out) {
  ulong2 least = (ulong2)(0), most = (ulong2)(0);
  ulong trailing = 0, bad = 0;
  FOR_ITEMS(v, items) {
    const u64 x = gcdt_given_coordinate(coordinates, type, 2 * v),
              y = gcdt_given_coordinate(coordinates, type, 2 * v + 1);
    // The axis at hand is the first of `least` and `most`, which change places each time.
#pragma unroll 1  // drivers take as long as the text is
    for (uint axis = 0; axis < 2; ++axis, least = least.yx, most = most.yx) {
      const ulong bits = gcdt_double_of_given(axis == 0u ? x : y, type);
      if (!gcdt_is_finite(bits)) {
        bad = max(bad, ~(ulong)(2 * (v - first) + axis));
        continue;
      }
      const ulong key = gcdt_ordered(bits);
      least.x = max(least.x, ~key);
      most.x = max(most.x, key);
      if (bits != 0) trailing = max(trailing, ~(ulong)(gcdt_trailing_exponent(bits) - GCDT_LEAST_EXPONENT));
    }
  }
  out[0] = least.x;
  out[1] = most.x;
  out[2] = least.y;
  out[3] = most.y;
  out[GCDT_SURVEY_TRAILING] = trailing;
  out[GCDT_SURVEY_BAD] = bad;
}

// The most decimals that a coordinate of these vertices needs, `limit` + 1 if more than `limit`.
GCDT_APART int decimals_of_items(Items items, uint type, global const ulong* coordinates, int limit) {
  // If d decimals suffice, d + 1 do: it is enough to raise the number where it does not.
  int digits = 0;
  FOR_ITEMS(v, items) {
    if (digits > limit) break;
    for (uint axis = 0; axis < 2; ++axis)
      digits = gcdt_decimals_needed(gcdt_coordinate(coordinates, type, 2 * v + axis), digits, limit);
  }
  return digits;
}

static inline void put_columns(private const ulong* from, uint columns, global ulong* to) {
  for (uint c = 0; c < columns; ++c) to[c] = from[c];
}

// Writes keys[v], the Morton code of v's grid point, and values[v] = v of these vertices. The columns of quantising: if
// one is outside the grid, the keys are void.
GCDT_APART void quantise_items(Items items, uint first, uint type, global const ulong* coordinates,
                               global const Scale* scale, global ulong* keys, global uint* values, private ulong* out) {
  ulong move = 0, outside = 0;
  if (type == GCDT_COORDINATES_INT32 && scale->whole) {
    FOR_ITEMS(v, items) {
      const int2 p = ((global const int2*)coordinates)[v];
      if (p.x < 0 || p.y < 0) outside = max(outside, ~(ulong)(2 * (v - first) + (p.x < 0 ? 0 : 1)));
      keys[v] = gcdt_morton((uint)p.x, (uint)p.y);
      values[v] = v;
    }
    out[GCDT_QUANTISE_MOVE] = 0;
    out[GCDT_QUANTISE_OUTSIDE] = outside;
    return;
  }
  u64 most_rest = 0;
  FOR_ITEMS(v, items) {
    const u64 x = gcdt_given_coordinate(coordinates, type, 2 * v),
              y = gcdt_given_coordinate(coordinates, type, 2 * v + 1);
    ulong code = 0;
#pragma unroll 1  // drivers take as long as the text is
    for (uint axis = 0; axis < 2; ++axis) {
      u64 rest;
      const u64 bits = gcdt_double_of_given(axis == 0u ? x : y, type);
      const Quantised at = gcdt_quantise_rest(bits, scale, (i32)axis, &rest);
      move = max(move, at.move);
      most_rest = max(most_rest, rest);
      if (at.outside) outside = max(outside, ~(ulong)(2 * (v - first) + axis));
      code |= gcdt_spread_bits(at.value) << axis;
    }
    keys[v] = code;
    values[v] = v;
  }
  out[GCDT_QUANTISE_MOVE] = max(move, gcdt_rest_key(most_rest));
  out[GCDT_QUANTISE_OUTSIDE] = outside;
}

// The same of one vertex on a decimal grid, where nothing moves and nothing is outside.
static inline void quantise_decimal(uint v, uint type, global const ulong* coordinates, global const Decimals* decimals,
                                    global ulong* keys, global uint* values) {
  uint grid[2];
  for (uint axis = 0; axis < 2; ++axis)
    grid[axis] = gcdt_place_decimal(gcdt_coordinate(coordinates, type, 2 * v + axis), axis, decimals);
  keys[v] = gcdt_morton(grid[0], grid[1]);
  values[v] = v;
}

// Place i in the sorted order holds a vertex of the rank, which it returns; `first`: the first of those with its key.
static inline uint number_place(uint i, uint rank, bool first, global const Levels* levels, global const ulong* keys,
                                global const uint* values, global int2* points, global uint* vertex_input,
                                global uint* input_vertex) {
  const uint v = gcdt_vertex_of_rank(levels, levels->count - 1, rank);
  input_vertex[values[i]] = v;
  if (!first) return v;
  points[v] = (int2)((int)gcdt_gather_bits(keys[i]), (int)gcdt_gather_bits(keys[i] >> 1));
  vertex_input[v] = values[i];
  return v;
}

#endif
