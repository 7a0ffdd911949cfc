// SPDX-License-Identifier: Apache-2.0
// Phases as one launch each, for CPUs and few vertices, where each of a phase's launches would do next to nothing. A
// kernel here does what the kernels of order.cl, output.cl and check.cl do one after the other. A launch has one
// work-item, so there is no race. It calls the functions that those kernels call, and not the kernels, because drivers
// compile a kernel twice that another one calls.
#include "check/check.cl"
#include "order/grid.h"
#include "order/order.cl"
#include "output/output.cl"
#include "sort/sort_by_one_item.h"

// For CPUs, where that is faster than lanes and barriers, and than launches for each digit. Sorts pairs by the bits
// below `bits` of the key, stably.
// Reads, writes: keys and values, and the other ones by turns.
// After: the pairs are in order; they stand in the other buffers if the number of digits is odd.
kernel void sort_by_one_item(u32 count, u32 bits, global u64* keys, global u32* values, global u64* other_keys,
                             global u32* other_values) {
  sort_by_digits(count, 0u, bits, keys, values, other_keys, other_values);
}

// The choice of a grid of an input that was surveyed, as lib/phases/order.cpp makes it, here so that nothing is read
// back in between: of what it calls only the counting of decimals is not the host's, too. Leaves the grid in *report.
GCDT_APART void choose_grid(uint n, uint type, global const ulong* coordinates, global OrderReport* report) {
  ulong least[2], most[2];
  for (uint axis = 0; axis < 2; ++axis) {
    least[axis] = gcdt_from_ordered(~report->surveyed[2 * axis]);
    most[axis] = gcdt_from_ordered(report->surveyed[2 * axis + 1]);
  }
  const int trailing = (int)~report->surveyed[GCDT_SURVEY_TRAILING] + GCDT_LEAST_EXPONENT;
  const int limit = gcdt_choose_cell(least, most, trailing, &report->scale).decimals_limit;
  if (limit < 0) return;
  const int digits = decimals_of_items((Items)(0u, n, 1u), type, coordinates, limit);
  if (digits <= limit && gcdt_make_decimals(least, most, digits, &report->decimals)) report->decimal_digits = digits;
}

// The whole order phase: lib/phases/order.cpp. `given`: the grid is report->scale.
// Reads: coordinates, report->scale if given. Writes: all else; keys, values and the other ones are void afterwards.
// After: as after number_vertices, of make_levels(report->distinct, coarsest), and *levels is that; or an error of the
// input, if surveyed[GCDT_SURVEY_BAD] or quantised[GCDT_QUANTISE_OUTSIDE] of *report is not 0.
kernel void order_by_one_item(uint n, uint type, global const ulong* coordinates, uint given, uint coarsest,
                              global OrderReport* report, global ulong* keys, global uint* values,
                              global ulong* other_keys, global uint* other_values, global Levels* levels,
                              global int2* points, global uint* vertex_input, global uint* input_vertex) {
  report->decimal_digits = -1;
  ulong surveyed[GCDT_SURVEY_COLUMNS], quantised[GCDT_QUANTISE_COLUMNS] = {0, 0};
  survey_items((Items)(0u, n, 1u), 0u, type, coordinates, surveyed);
  put_columns(surveyed, GCDT_SURVEY_COLUMNS, report->surveyed);
  if (report->surveyed[GCDT_SURVEY_BAD] != 0) return;
  if (!given) choose_grid(n, type, coordinates, report);
  if (report->decimal_digits >= 0)
    for (uint v = 0; v < n; ++v) quantise_decimal(v, type, coordinates, &report->decimals, keys, values);
  else
    quantise_items((Items)(0u, n, 1u), 0u, type, coordinates, &report->scale, keys, values, quantised);
  put_columns(quantised, GCDT_QUANTISE_COLUMNS, report->quantised);
  if (report->quantised[GCDT_QUANTISE_OUTSIDE] != 0) return;
  sort_by_prefix(n, GCDT_MORTON_BITS, keys, values, other_keys, other_values);
  uint distinct = 0;
  for (uint i = 0; i < n; ++i)
    if (is_first(keys, i)) ++distinct;
  report->distinct = distinct;
  *levels = make_levels(distinct, coarsest);
  for (uint i = 0, before = 0; i < n; ++i) {
    const bool first = is_first(keys, i);
    if (first) ++before;
    number_place(i, before - 1u, first, levels, keys, values, points, vertex_input, input_vertex);
  }
}

// All triangles in canonical order: lib/phases/output.cpp. Faces with a symbolic corner are sorted last.
// Reads: levels and the mesh of `faces` faces. Writes: *triangles, how many there are, and of each what
// gather_triangles writes; keys, refs and the other ones are void afterwards, positions as after place_faces.
kernel void output_by_one_item(uint faces, global const Levels* levels, uint bits, global const uint4* face_data,
                               global const uint* edge_faces, global const uint* edge_marks, global ulong* keys,
                               global uint* refs, global ulong* other_keys, global uint* other_refs,
                               global int* positions, global uint* triangles, global uint* corners,
                               global int* neighbours, global uchar* constrained) {
  const uint count = key_faces_among((Items)(0u, faces, 1u), levels, bits, face_data, keys, refs);
  *triangles = count;
  if (sort_by_digits(faces, 0u, 2u * bits, keys, refs, other_keys, other_refs)) refs = other_refs;
  for (uint i = 0; i < faces; ++i) positions[GCDT_REF_FACE(refs[i])] = i < count ? (int)i : -1;
  for (uint i = 0; i < count; ++i)
    gather_triangle(i, face_data, edge_faces, edge_marks, refs, positions, corners, neighbours, constrained);
}

// The check of a mesh with triangles: lib/phases/check.cpp.
// Reads: everything but `next`, `previous`, first_pieces and *report, and writes these: as after check_boundary.
kernel void check_by_one_item(uint count, uint n, global const Levels* levels, global const int2* points,
                              global const uint* corners, global const int* neighbours, global const uchar* constrained,
                              uint pieces, global uint* first_pieces, global const uint2* ends, global uint* next,
                              global uint* previous, global CheckReport* report) {
  for (uint kind = 0; kind < GCDT_CHECK_KINDS; ++kind) report->first[kind] = GCDT_NONE;
  report->hull_vertices = report->least_corners = report->constrained_edges = 0;
  for (uint v = 0; v < n; ++v) next[v] = previous[v] = GCDT_NONE;
  for (uint t = 0; t < count; ++t) check_corners_of(t, n, points, corners, report);
  if (noted(report, GCDT_CHECK_ORIENT)) return;
  if (pieces > 0) find_first_pieces(0u, n + 1u, levels, pieces, ends, first_pieces);
  uint hull_vertices = 0, least_corners = 0;
  report->constrained_edges = check_edges_among((Items)(0u, count, 1u), count, levels, points, corners, neighbours,
                                                constrained, pieces, first_pieces, ends, next, previous, report);
  if (noted(report, GCDT_CHECK_FORK)) return;
  for (uint v = 0; v < n; ++v) check_boundary_at(v, points, next, previous, &hull_vertices, &least_corners, report);
  report->hull_vertices = hull_vertices;
  report->least_corners = least_corners;
}

// Numbers of vertices become those of the input: number_by_input of lib/phases/output.cpp.
// Reads vertex_input and input_vertex. Writes representatives, replaces corners and ends, and writes *source_offsets if
// there are no ends.
kernel void number_by_one_item(uint inputs, uint triangles, uint pieces, global const uint* vertex_input,
                               global const uint* input_vertex, global uint* representatives, global uint* corners,
                               global uint* ends, global uint* source_offsets) {
  const uint corner_count = 3u * triangles, end_count = 2u * pieces;
  for (uint i = 0; i < inputs; ++i) number_representative(i, vertex_input, input_vertex, representatives);
  for (uint i = 0; i < corner_count; ++i) number_corner(i, vertex_input, corners);
  for (uint i = 0; i < end_count; ++i) number_corner(i, vertex_input, ends);
  if (end_count == 0u) *source_offsets = 0u;
}
