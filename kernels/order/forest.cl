// SPDX-License-Identifier: Apache-2.0
// The order phase of a forest, in which each problem has a grid of its own, and the numbering of its output, in which
// each problem has numbers of its own again. It does what order.cl and output.cl do for one problem. The loops of a
// work-item are short: a chunk, or a bisection.
#ifndef GCDT_FOREST
#define GCDT_FOREST
#endif
#include "common/forest.h"
#include "common/search.h"
#include "order/vertices.h"

// ---- Grids ------------------------------------------------------------------------------------------

// One work-item per chunk.
// Reads: coordinates. Writes: maxima[chunk], the columns of order.h, with coordinates numbered in the problem.
// A row has one work-item.
// After this kernel and forest_fold the table describes each problem.
kernel void forest_survey(uint chunks, global const Chunk* chunk, global const uint* first_input, uint type,
                          global const ulong* coordinates, global ulong* maxima) {
  FOR_EACH(i, chunks) {
    const Chunk c = chunk[i];
    ulong columns[GCDT_SURVEY_COLUMNS];
    survey_items((Items)(c.first, c.end, 1u), first_input[c.problem], type, coordinates, columns);
    put_columns(columns, GCDT_SURVEY_COLUMNS, maxima + (size_t)i * GCDT_SURVEY_COLUMNS);
  }
}

// One work-item per chunk.
// Reads: coordinates, all finite; limits: the most decimals asked about in each problem, -1: none.
// Writes: maxima[chunk]: the most decimals that a coordinate needs to be written, limit + 1 if one cannot be.
// A row has one work-item.
// After this kernel and forest_fold the table holds each problem's number of decimals.
kernel void forest_decimals(uint chunks, global const Chunk* chunk, uint type, global const ulong* coordinates,
                            global const int* limits, global ulong* maxima) {
  FOR_EACH(i, chunks) {
    const Chunk c = chunk[i];
    maxima[i] = (ulong)decimals_of_items((Items)(c.first, c.end, 1u), type, coordinates, limits[c.problem]);
  }
}

// The greatest of a column over rows begin .. end - 1, 0 without any. Asks for four rows before it waits for the first.
static inline ulong greatest_of_rows(uint begin, uint end, uint column, uint columns, global const ulong* maxima) {
  ulong most = 0;
  uint row = begin;
  for (; end - row > 3u; row += 4u) {
    global const ulong* at = maxima + (size_t)row * columns + column;
    const ulong a = at[0], b = at[columns], c = at[2u * columns], d = at[3u * columns];
    most = max(most, max(max(a, b), max(c, d)));
  }
  for (; row < end; ++row) most = max(most, maxima[(size_t)row * columns + column]);
  return most;
}

// One work-item per problem and column.
// Reads: maxima of the problem's chunks. Writes: folded[problem][column], the greatest; 0 without chunks.
// An element has one work-item.
// After this kernel `folded` has a row for each problem.
kernel void forest_fold(uint problems, uint columns, global const uint* first_chunk, global const ulong* maxima,
                        global ulong* folded) {
  FOR_EACH(i, problems * columns) {
    const uint problem = i / columns;
    folded[i] = greatest_of_rows(first_chunk[problem], first_chunk[problem + 1u], i % columns, columns, maxima);
  }
}

// One work-item per chunk.
// Reads: coordinates, all finite; the grid of each problem. Writes: keys[v], the Morton code of v's grid point;
//   values[v] = v; input_problem[v]; maxima[chunk], the columns of order.h, with coordinates numbered in the problem
//   (if one is outside, the problem's keys are void).
// A vertex and a row belong to one chunk.
// After this kernel stable sorts by key, then by problem, give the order along each problem's curve.
kernel void forest_quantise(uint chunks, global const Chunk* chunk, global const uint* first_input, uint type,
                            global const ulong* coordinates, global const ProblemGrid* grids, global ulong* keys,
                            global uint* values, global uint* input_problem, global ulong* maxima) {
  FOR_EACH(i, chunks) {
    const Chunk c = chunk[i];
    global const ProblemGrid* grid = grids + c.problem;
    ulong columns[GCDT_QUANTISE_COLUMNS];
    if (grid->is_decimal) {
      for (uint v = c.first; v < c.end; ++v) quantise_decimal(v, type, coordinates, &grid->decimals, keys, values);
      columns[GCDT_QUANTISE_MOVE] = columns[GCDT_QUANTISE_OUTSIDE] = 0;
    } else {
      quantise_items((Items)(c.first, c.end, 1u), first_input[c.problem], type, coordinates, &grid->scale, keys, values,
                     columns);
    }
    put_columns(columns, GCDT_QUANTISE_COLUMNS, maxima + (size_t)i * GCDT_QUANTISE_COLUMNS);
    for (uint v = c.first; v < c.end; ++v) input_problem[v] = c.problem;
  }
}

// ---- Numbering --------------------------------------------------------------------------------------

// One work-item per place in an order of the input vertices.
// Reads: values, the vertex at each place; from, by vertex. Writes: to[i] = from[values[i]].
// A place has one work-item.
// After this kernel `to` is `from` in that order.
kernel void forest_problem_at(uint n, global const uint* values, global const uint* from, global uint* to) {
  FOR_EACH(i, n) to[i] = from[values[i]];
}
kernel void forest_key_at(uint n, global const uint* values, global const ulong* from, global ulong* to) {
  FOR_EACH(i, n) to[i] = from[values[i]];
}

// One work-item per place in the sorted order.
// Reads: problem and key at each place. Writes: first[i] = 1 if one of them differs from the place before, else 0.
// A place has one work-item.
// After this kernel the scan of `first` counts the distinct vertices before each place.
kernel void forest_mark_first(uint n, global const uint* problems, global const ulong* keys, global uint* first) {
  FOR_EACH(i, n)
  first[i] = i == 0 || problems[i] != problems[i - 1] || keys[i] != keys[i - 1] ? 1u : 0u;
}

// One work-item per place in the sorted order.
// Reads: levels; problems, keys and values, sorted; before, the scan of forest_mark_first (n + 1 elements).
// Writes: points[v], the problem of v behind the points (shared.h) and vertex_input[v] at the first place of v's key;
//   input_vertex[values[i]] at every place.
// Distinct keys of a problem have distinct ranks, so distinct vertices; values is a permutation.
// After this kernel the vertices are numbered, and vertex_input is the least input number at the grid point.
kernel void forest_number(uint n, global const Levels* levels, global const uint* problems, global const ulong* keys,
                          global const uint* values, global const uint* before, global int2* points,
                          global uint* vertex_input, global uint* input_vertex) {
  global uint* words = (global uint*)(points + levels->n);
  FOR_EACH(i, n) {
    const uint rank = before[i + 1] - 1;
    const bool first = before[i] == rank;
    const uint v = number_place(i, rank, first, levels, keys, values, points, vertex_input, input_vertex);
    if (first) words[gcdt_problem_word(v)] = problems[i];
  }
}

// One work-item per problem, and one for the end.
// Reads: before, the scan of forest_mark_first; first_input, where each problem starts, in input and sorted order.
// Writes: the number of problems and the first rank of each behind the points (shared.h).
// Each its own word; work-item 0 the first.
// After this kernel the forest can be asked for its problems.
kernel void forest_first_ranks(uint problems, uint n, global const uint* first_input, global const uint* before,
                               global int2* points) {
  global uint* words = (global uint*)(points + n);
  if (get_global_id(0) == 0) words[GCDT_FOREST_ROOTS_WORD] = problems;
  FOR_EACH(p, problems + 1u) words[gcdt_first_rank_word(n, p)] = before[first_input[p]];
}

// ---- Crossings --------------------------------------------------------------------------------------

// One work-item per piece, sorted by problem.
// Reads: moves[p]: how many pieces and sources before those of problem p leave, x GCDT_NONE if its own do; the pieces.
// Writes: what stays, so many places lower; `parts` are 0 unless `walked`.
// Places of pieces that stay, and of their sources, are distinct.
// After this kernel the pieces that stay are there, but for the end of the last one's sources.
kernel void forest_keep_pieces(uint count, uint walked, uint n, global const int2* points, global const uint2* moves,
                               global const uint2* ends, global const uint* source_offsets, global const uint* sources,
                               global const uint* weights, global const uint2* parts, global uint2* to_ends,
                               global uint* to_offsets, global uint* to_sources, global uint* to_weights,
                               global uint2* to_parts) {
  FOR_EACH(i, count) {
    const uint2 e = ends[i], move = moves[problem_of(points, n, e.x)];
    if (move.x == GCDT_NONE) continue;
    const uint first = source_offsets[i], end = source_offsets[i + 1u], at = i - move.x;
    to_ends[at] = e;
    to_offsets[at] = first - move.y;
    for (uint s = first; s < end; ++s) to_sources[s - move.y] = sources[s];
    to_weights[at] = weights[i];
    to_parts[at] = walked ? parts[i] : (uint2)(0u);
  }
}

// ---- Output -----------------------------------------------------------------------------------------

// One work-item per problem, and one for the end.
// Reads: first vertices of things sorted by problem, `stride` words each. Writes: begins[p], the first thing of
//   problem p or a later one.
// Each its own word. Ends: the range halves.
// After this kernel things begins[p] up to begins[p + 1] are those of problem p.
kernel void forest_begins(uint problems, uint count, uint stride, uint n, global const int2* points,
                          global const uint* things, global uint* begins) {
  FOR_EACH(p, problems + 1u) {
    uint low = 0, high = count;
    while (low < high) {
      const uint middle = low + (high - low) / 2u;
      if (problem_of(points, n, things[(size_t)middle * stride]) < p)
        low = middle + 1u;
      else
        high = middle;
    }
    begins[p] = low;
  }
}

// One work-item per triangle, in canonical order.
// Reads: the maps. Writes: corners[3t ..] and neighbours[3t ..], which it replaces.
// A triangle has one work-item.
// After this kernel corners are input numbers of the problem, and neighbours triangles of the problem.
kernel void forest_local_triangles(uint count, uint n, global const int2* points, global const uint* vertex_input,
                                   global const uint* first_input, global const uint* first_triangle,
                                   global uint* corners, global int* neighbours) {
  FOR_EACH(t, count) {
    const uint3 c = vload3(t, corners);
    const int3 across = vload3(t, neighbours);
    const uint p = problem_of(points, n, c.x);
    const int first = (int)first_triangle[p];
    vstore3((uint3)(vertex_input[c.x], vertex_input[c.y], vertex_input[c.z]) - (uint3)(first_input[p]), t, corners);
    vstore3((int3)(across.x < 0 ? -1 : across.x - first, across.y < 0 ? -1 : across.y - first,
                   across.z < 0 ? -1 : across.z - first),
            t, neighbours);
  }
}

// One work-item per kept triangle, while its corners are vertices.
// Reads: the region of the first triangle of the problem's hull, the least of the problem's regions, which have
//   consecutive numbers. Writes: region[t], which it replaces.
// A word has one work-item.
// After this kernel regions are numbered problem by problem.
kernel void forest_local_regions(uint count, uint n, global const int2* points, global const uint* corners,
                                 global const uint* first_of_hull, global const uint* region_of_hull,
                                 global uint* region) {
  FOR_EACH(t, count)
  region[t] -= region_of_hull[first_of_hull[problem_of(points, n, corners[3u * t])]];
}

// One work-item per input vertex.
// Reads: the maps. Writes: representatives[i].
// A word has one work-item.
// After this kernel representatives are input numbers of the problem.
kernel void forest_representatives(uint count, uint n, global const int2* points, global const uint* vertex_input,
                                   global const uint* input_vertex, global const uint* first_input,
                                   global uint* representatives) {
  FOR_EACH(i, count) {
    const uint v = input_vertex[i];
    representatives[i] = vertex_input[v] - first_input[problem_of(points, n, v)];
  }
}

// One work-item per source of a piece.
// Reads: where the constraints of each problem begin. Writes: sources[i], which it replaces.
// A word has one work-item.
// After this kernel sources are constraint numbers of the problem.
kernel void forest_local_sources(uint count, uint problems, global const uint* first_constraint, global uint* sources) {
  FOR_EACH(i, count) {
    const uint source = sources[i];
    // The last problem that begins at or before it has it: later ones begin after.
    sources[i] = source - first_constraint[last_begin(first_constraint, problems, source)];
  }
}

// One work-item per piece.
// Reads: the maps. Writes: ends[i], which it replaces.
// A word has one work-item.
// After this kernel the ends of pieces are input numbers of the problem.
kernel void forest_local_pieces(uint count, uint n, global const int2* points, global const uint* vertex_input,
                                global const uint* first_input, global uint2* ends) {
  FOR_EACH(i, count) {
    const uint2 e = ends[i];
    const uint first = first_input[problem_of(points, n, e.x)];
    ends[i] = (uint2)(vertex_input[e.x] - first, vertex_input[e.y] - first);
  }
}
