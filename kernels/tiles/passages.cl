// SPDX-License-Identifier: Apache-2.0
// Which triangles of a tile's mesh open constraints may pass through: all that have a point in a cell of a coarse
// raster that one comes near. The host walks through those alone (docs/scale.md).
#include "common/loops.h"
#include "tiles/passages.h"

// The part of a passage from a to b that is in some rows of grid points, as least and greatest x, rounded outwards; b
// is not below a. Products are less than 2^62.
static inline long2 reach_between(int2 a, int2 b, long least_y, long most_y) {
  if (a.y == b.y) return (long2)(min(a.x, b.x), max(a.x, b.x));
  const long from = max((long)a.y, least_y), to = min((long)b.y, most_y), dx = (long)b.x - a.x, dy = (long)b.y - a.y;
  const long first = a.x + (from - a.y) * dx / dy, last = a.x + (to - a.y) * dx / dy;
  return (long2)(min(first, last) - 1, max(first, last) + 1);
}

static inline uint cell_of(long coordinate) {
  return (uint)(clamp(coordinate, (long)0, (long)GCDT_PASSAGE_LAST) >> GCDT_PASSAGE_SHIFT);
}

// One work-item per passage. Reads its ends, vertices of the mesh. Sets the bits of all cells that have a grid point
// less than GCDT_PASSAGE_MARGIN away from it on both axes: by atomic_or, whose order cannot matter. Ends: a row of the
// raster has finitely many words, and rows ascend.
kernel void passage_cells(const uint count, global const uint2* ends, global const int2* points,
                          volatile global uint* cells) {
  FOR_EACH(i, count) {
    const int2 p = points[ends[i].x], q = points[ends[i].y], a = p.y <= q.y ? p : q, b = p.y <= q.y ? q : p;
    const uint last_row = cell_of((long)b.y + GCDT_PASSAGE_MARGIN);
    for (uint row = cell_of((long)a.y - GCDT_PASSAGE_MARGIN); row <= last_row; ++row) {
      const long least = (long)row << GCDT_PASSAGE_SHIFT, most = least + (1l << GCDT_PASSAGE_SHIFT) - 1;
      const long2 reach = reach_between(a, b, least - GCDT_PASSAGE_MARGIN, most + GCDT_PASSAGE_MARGIN);
      const uint first = cell_of(reach.x - GCDT_PASSAGE_MARGIN), last = cell_of(reach.y + GCDT_PASSAGE_MARGIN);
      for (uint word = first / 32u; word <= last / 32u; ++word) {
        const uint from = first > 32u * word ? first - 32u * word : 0u,
                   to = last < 32u * word + 31u ? last - 32u * word : 31u;
        atomic_or(&cells[row * GCDT_PASSAGE_WORDS + word], (0xFFFFFFFFu << from) & (0xFFFFFFFFu >> (31u - to)));
      }
    }
  }
}

// Whether one of the cells from `least` to `most` is set. Ends: rows and words ascend.
static inline bool is_any_set(global const uint* cells, uint2 least, uint2 most) {
  for (uint row = least.y; row <= most.y; ++row)
    for (uint word = least.x / 32u; word <= most.x / 32u; ++word) {
      const uint from = least.x > 32u * word ? least.x - 32u * word : 0u,
                 to = most.x < 32u * word + 31u ? most.x - 32u * word : 31u;
      if ((cells[row * GCDT_PASSAGE_WORDS + word] & (0xFFFFFFFFu << from) & (0xFFFFFFFFu >> (31u - to))) != 0u)
        return true;
    }
  return false;
}

// One work-item per triangle. Reads the mesh, points and cells. Writes near[t]: whether a cell that the box around it
// meets is set, or these are many; and 1 to used[v] for the corners of such a triangle. Word t has one writer; all that
// write a word of `used` write 1.
kernel void passage_near(const uint triangles, global const uint* corners, global const int2* points,
                         global const uint* cells, global uint* near, global uint* used) {
  FOR_EACH(t, triangles) {
    const int2 a = points[corners[3u * t]], b = points[corners[3u * t + 1u]], c = points[corners[3u * t + 2u]];
    const int2 low = min(a, min(b, c)), high = max(a, max(b, c));
    const uint2 least = (uint2)(cell_of(low.x), cell_of(low.y)), most = (uint2)(cell_of(high.x), cell_of(high.y));
    const bool is_near = most.y - least.y >= GCDT_PASSAGE_ROWS_SEARCHED || is_any_set(cells, least, most);
    near[t] = is_near ? 1u : 0u;
    for (uint k = 0; k < 3u && is_near; ++k) used[corners[3u * t + k]] = 1u;
  }
}

// One work-item per triangle. Reads the mesh, and the scans of near and used. Writes the number of each triangle that
// is near, its corners and its neighbours, as numbers among those that are near; -1 where there is none such. Places
// differ, by the scan.
kernel void passage_take(const uint triangles, global const uint* near_before, global const uint* used_before,
                         global const uint* corners, global const int* neighbours, global uint* numbers,
                         global uint* out_corners, global int* out_neighbours) {
  FOR_EACH(t, triangles) {
    const uint place = near_before[t];
    if (near_before[t + 1u] == place) continue;
    numbers[place] = t;
    for (uint k = 0; k < 3u; ++k) {
      const int other = neighbours[3u * t + k];
      const bool is_there = other >= 0 && near_before[other + 1] != near_before[other];
      out_corners[3u * place + k] = used_before[corners[3u * t + k]];
      out_neighbours[3u * place + k] = is_there ? (int)near_before[other] : -1;
    }
  }
}
