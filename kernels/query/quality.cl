// SPDX-License-Identifier: Apache-2.0
// Areas and angles of a finished mesh.
#include "common/predicates.h"
#include "query/quality.h"

GCDT_INLINE Vertex corner_point(global const uint* corners, uint i, global const uint* input_vertex,
                                global const int2* points) {
  return vertex_at(points, input_vertex[corners[i]]);
}

GCDT_INLINE i64 dot_at(Vertex corner, Vertex b, Vertex c) {
  return (b.x - corner.x) * (c.x - corner.x) + (b.y - corner.y) * (c.y - corner.y);
}

// One work-item per row of the table, over its share of the triangles.
// Reads corners (input numbers) and points. Writes table[row].
// A row has one work-item.
// After this kernel the rows joined are the quality of the mesh.
kernel void measure_triangles(const uint count, global const uint* corners, global const uint* input_vertex,
                              global const int2* points, const uint rows, global Quality* table) {
  FOR_EACH(row, rows) {
    Quality sum = gcdt_no_quality();
    FOR_SHARE(t, count, row, rows) {
      const Vertex a = corner_point(corners, 3u * t, input_vertex, points),
                   b = corner_point(corners, 3u * t + 1u, input_vertex, points),
                   c = corner_point(corners, 3u * t + 2u, input_vertex, points);
      const u64 area = (u64)gcdt_orient2d_finite(a, b, c);
      const i64 da = dot_at(a, b, c), db = dot_at(b, c, a), dc = dot_at(c, a, b);
      // All three angles have the same area: the largest dot product is the least angle.
      Quality one;
      one.count = 1;
      one.least_area = one.most_area = one.area_sum = area;
      one.least_dot = max(max(da, db), dc);
      one.most_dot = min(min(da, db), dc);
      one.least_angle_area = one.most_angle_area = area;
      one.least_triangle = one.most_triangle = t;
      sum = gcdt_join_quality(sum, one);
    }
    table[row] = sum;
  }
}

// One work-item per row of the smaller table.
// Reads table. Writes folded[row], the rows of table congruent to `row` joined.
// A row has one work-item.
kernel void fold_quality(const uint rows, global const Quality* table, const uint folded_rows, global Quality* folded) {
  FOR_EACH(row, folded_rows) {
    Quality sum = table[row];
    for (uint other = row + folded_rows; other < rows; other += folded_rows) sum = gcdt_join_quality(sum, table[other]);
    folded[row] = sum;
  }
}
