// SPDX-License-Identifier: Apache-2.0
// Which constraints are whose (docs/scale.md, step 3): those that no tile has, found before there are tiles, and those
// of one tile, found among all. A constraint that is left out has ends that are no vertex's number. OpenCL C only.
#ifndef GCDT_SHARES_H
#define GCDT_SHARES_H

#include "common/levels.h"
#include "common/loops.h"

static inline int2 point_of_code(ulong code) {
  return (int2)((int)gcdt_gather_bits(code), (int)gcdt_gather_bits(code >> 1));
}
static inline ulong code_of_point(int2 p) { return gcdt_morton((uint)p.x, (uint)p.y); }

// The place of an id among ids[low .. high - 1], which ascend; `high` if it is not there. Ends: the range halves.
static inline uint place_of_id(global const uint* ids, uint low, uint high, uint wanted) {
  const uint end = high;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (ids[middle] < wanted)
      low = middle + 1u;
    else
      high = middle;
  }
  return low < end && ids[low] == wanted ? low : end;
}

// How many of a list, which ascends, are not above `most`. Ends: the range halves.
static inline uint count_up_to(global const uint* list, uint count, uint most) {
  uint low = 0, high = count;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (list[middle] <= most)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
}

// Are the codes of vertices a and b before the key, in order?
static inline bool is_before_key(global const int2* points, uint a, uint b, ulong2 key) {
  const ulong code = code_of_point(points[a]);
  return code != key.x ? code < key.x : code_of_point(points[b]) < key.y;
}

// ---- Those of no tile -------------------------------------------------------------------------------

// One work-item per end of a constraint. Reads codes of the vertices from number `first` on, n of them. Writes out[i]
// if end i is one of these, else nothing. Word i has one writer.
kernel void share_codes(const uint count, const uint first, const uint n, global const uint* ends,
                        global const ulong* codes, global ulong* out) {
  FOR_EACH(i, count) {
    const uint place = ends[i] - first;
    if (place < n) out[i] = codes[place];
  }
}

// One work-item per constraint. Reads its ends, their codes, and the first codes of the tiles but the first one, which
// ascend; `all` vertices. Writes flags[c]: whether the box around it is no tile's. Word c has one writer. Ends: the
// range halves.
kernel void share_open(const uint count, const uint all, const uint cuts, global const ulong* first_codes,
                       global const uint2* ends, global const ulong2* codes, global uint* flags) {
  FOR_EACH(c, count) {
    const int2 a = point_of_code(codes[c].x), b = point_of_code(codes[c].y);
    const ulong least = code_of_point(min(a, b)), most = code_of_point(max(a, b));
    uint low = 0, high = cuts;
    while (low < high) {
      const uint middle = low + (high - low) / 2u;
      if (first_codes[middle] <= least)
        low = middle + 1u;
      else
        high = middle;
    }
    const bool is_open = low < cuts && first_codes[low] <= most;
    flags[c] = is_open && ends[c].x < all ? 1u : 0u;
  }
}

// One work-item per constraint. Reads the scan of share_open's flags. Writes for each that is open its place among all,
// of which it is number `first` of those here, and the points of its ends: places differ, by the scan.
kernel void share_list_open(const uint count, const uint first, global const uint* before, global const ulong2* codes,
                            global uint* numbers, global int4* points) {
  FOR_EACH(c, count) {
    const uint place = before[c];
    if (before[c + 1u] == place) continue;
    numbers[place] = first + c;
    // Of a vertex outside of the grid, which the call ends with later, a coordinate may be 2^31, and cuts may be there.
    points[place] = (int4)(point_of_code(codes[c].x), point_of_code(codes[c].y)) & 0x7FFFFFFF;
  }
}

// ---- Those of one tile ------------------------------------------------------------------------------

// One work-item per constraint. Reads its ends, and ids, which ascend, and coordinates of the tile's own vertices.
// Writes its ends as own vertices, and flags[c]: whether both are, and the box around them is the tile's. Words c have
// one writer.
kernel void share_own(const uint count, const uint own, const ulong first_code, const ulong last_code,
                      global const uint* ids, global const int2* points, global const uint2* ends,
                      global uint2* vertices, global uint* flags) {
  FOR_EACH(c, count) {
    const uint a = place_of_id(ids, 0u, own, ends[c].x);
    const uint b = a < own ? place_of_id(ids, 0u, own, ends[c].y) : own;
    bool is_own = b < own;
    if (is_own) {
      const int2 p = points[a], q = points[b];
      is_own = code_of_point(min(p, q)) >= first_code && code_of_point(max(p, q)) <= last_code;
    }
    vertices[c] = (uint2)(a, b);
    flags[c] = is_own ? 1u : 0u;
  }
}

// One work-item per constraint. Reads the scan of those flags. Writes the tile's from `at` on: their ends, and their
// places among all, of which constraint 0 here has `first`. Places differ, by the scan.
kernel void share_take(const uint count, const uint first, const uint at, global const uint* before,
                       global const uint2* vertices, global uint2* constraints, global uint* places) {
  FOR_EACH(c, count) {
    const uint place = at + before[c];
    if (before[c + 1u] == before[c]) continue;
    constraints[place] = vertices[c];
    places[place] = first + c;
  }
}

// One work-item per element of a list of the tile's constraints. Makes it their places among all; what is none of the
// tile's, a device that computes wrongly has listed, and it becomes what is none of all. Word i is read and written by
// one work-item.
kernel void share_known(const uint count, const uint constraints, global const uint* places, global uint* list) {
  FOR_EACH(i, count) list[i] = list[i] < constraints ? places[list[i]] : 0xFFFFFFFFu;
}

// One work-item per element of a list of places. Reads numbers of what has the places from `first` on, n of them.
// Writes out[i] if place i is one of these, else nothing. Word i has one writer.
kernel void share_numbers(const uint count, const uint first, const uint n, global const uint* places,
                          global const uint* numbers, global uint* out) {
  FOR_EACH(i, count) {
    const uint place = places[i] - first;
    if (place < n) out[i] = numbers[place];
  }
}

#endif
