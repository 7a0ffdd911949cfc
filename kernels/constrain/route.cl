// SPDX-License-Identifier: Apache-2.0
// Routing constraints through the pixels of vertices that they meet (docs/splitting.md).
#include "constrain/snap.h"
#include "constrain/walk.h"

// The first place in [low, high) of `codes`, ascending, with a code not below `code`. Ends: the range halves.
static uint first_not_below(global const ulong* codes, uint low, uint high, ulong code) {
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (codes[middle] < code)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
}

// A range of whole coordinates along the longer axis of a segment.
typedef struct Stretch {
  i64 first, last;
  bool along_x;
} Stretch;

// Part k of `parts` of the segment: the coordinates that are k (d + 1) / parts .. from its beginning. Every vertex
// belongs to one part. Below 2^31 * 2^31.
static Stretch stretch_of(Vertex a, Vertex b, uint k, uint parts) {
  const i64 dx = b.x - a.x, dy = b.y - a.y, x_length = dx < 0 ? -dx : dx, y_length = dy < 0 ? -dy : dy;
  Stretch s;
  s.along_x = x_length >= y_length;
  const u64 count = (u64)(s.along_x ? x_length : y_length) + 1u;
  const i64 begin = (i64)(count * k / parts), end = (i64)(count * (k + 1u) / parts) - 1;
  const i64 origin = s.along_x ? a.x : a.y;
  const bool down = s.along_x ? dx < 0 : dy < 0;
  s.first = down ? origin - end : origin + begin;
  s.last = down ? origin - begin : origin + end;
  return s;
}

static bool on_stretch(Stretch s, i64 x, i64 y, i64 size) {
  const i64 low = s.along_x ? x : y;
  return low <= s.last && low + size > s.first;
}

// One work-item per part. Visits, in the order along the segment, the vertices whose pixels the segment meets, its
// ends left out: counts them (emit = 0), or writes their ranks to hits[offsets[part] ...] (emit = 1). Also keeps the
// largest doubled area of ends and vertex, for the distance; emit = 0 adds to the 64-bit total. No race: each its own
// words; the sum does not depend on order.
//
// The sorted codes are a quadtree: a block of 2^k x 2^k grid points is a range. Blocks that are empty, or whose pixels
// the segment does not meet, are left. The four parts of a block come in the order of the segment's direction; of the
// two that are neither first nor last it meets pixels of one only, since both coordinates are monotone along it. So
// vertices are found in order. Ends: blocks shrink, and each is entered once.
kernel void route_walk(uint emit, uint count, uint capacity, uint n, GCDT_LEVELS_POINTER levels,
                       global const int2* points, global const ulong* codes, global const uint2* ends,
                       global const uint* begins, global uint* offsets, global uint* hits, global ulong* areas,
                       volatile global uint* total) {
  const uint parts = begins[count];
  u64 all = 0;
  FOR_EACH(part, capacity) {
    uint found = 0;
    u64 largest = 0;
    if (part < parts) {
      const uint c = last_begin(begins, count, part);
      const uint2 e = ends[c];
      const Vertex a = load_vertex(points, n, e.x), b = load_vertex(points, n, e.y);
      const Stretch stretch = stretch_of(a, b, part - begins[c], begins[c + 1u] - begins[c]);
      const uint turn = (b.x < a.x ? 1u : 0u) | (b.y < a.y ? 2u : 0u);
      uint low[32], high[32], next[32];
      uint level = 31u;
      u64 prefix = 0;
      low[level] = 0;
      high[level] = n;
      next[level] = 0;
      while (level < 32u) {
        if (next[level] == 4u) {
          ++level;
          prefix &= ~(((u64)1 << 2u * level) - 1u);
          continue;
        }
        const uint within = level - 1u;
        const u64 code = prefix | (u64)(next[level] ^ turn) << 2u * within;
        ++next[level];
        const uint first = first_not_below(codes, low[level], high[level], code);
        const uint last = first_not_below(codes, first, high[level], code + ((u64)1 << 2u * within));
        if (first == last) continue;
        const bool alone = last == first + 1u;
        const u64 corner = alone ? codes[first] : code;
        const i64 x = gcdt_gather_bits(corner), y = gcdt_gather_bits(corner >> 1), size = alone ? 1 : (i64)1 << within;
        if (!on_stretch(stretch, x, y, size) || !gcdt_meets_block(a, b, x, y, size)) continue;
        if (!alone) {
          level = within;
          prefix = code;
          low[level] = first;
          high[level] = last;
          next[level] = 0;
          continue;
        }
        if ((x == a.x && y == a.y) || (x == b.x && y == b.y)) continue;
        const i64 area = gcdt_orient2d_finite(a, b, gcdt_finite_vertex(x, y));
        largest = max(largest, (u64)(area < 0 ? -area : area));
        if (emit) hits[offsets[part] + found] = first;
        ++found;
      }
      areas[part] = largest;
    }
    if (!emit) offsets[part] = found;
    all += found;
  }
  if (!emit) add_wide(total, total + 1, all);
}

// One work-item per marked constraint. Writes the largest doubled area of its parts, and its squared length: the
// distance of the farthest vertex squared is area^2 / length^2. And its number of links, into the table of all
// constraints. No race: each its own words.
kernel void route_totals(uint count, global const int2* points, global const uint2* ends, global const uint* list,
                         global const uint* begins, global const uint* offsets, global const ulong* areas,
                         global ulong2* farthest, global uint* links) {
  FOR_EACH(i, count) {
    u64 largest = 0;
    for (uint part = begins[i]; part < begins[i + 1u]; ++part) largest = max(largest, areas[part]);
    const int2 a = points[ends[i].x], b = points[ends[i].y];
    const u64 dx = abs_diff(a.x, b.x), dy = abs_diff(a.y, b.y);
    farthest[i] = (ulong2)(largest, dx * dx + dy * dy);
    links[list[i]] = offsets[begins[i + 1u]] - offsets[begins[i]] + 1u;
  }
}

// One work-item per constraint. One that is not marked is its own only link. No race: each its own words.
kernel void route_unmarked(uint count, global const uint* touched, global const uint2* constraints,
                           global const uint* starts, global uint2* links, global uint* owners) {
  FOR_EACH(c, count) {
    if (touched[c]) continue;
    links[starts[c]] = constraints[c];
    owners[starts[c]] = c;
  }
}

// One work-item per part of a marked constraint. A constraint a-b that meets h1 .. hk becomes the links a-h1, h1-h2, ..
// hk-b, of input numbers. Each part writes the links that end in its vertices, the last part also the final one. No
// race: the places of a constraint's links are its own, and follow from the vertices before them.
kernel void route_links(uint count, GCDT_LEVELS_POINTER levels, global const uint* vertex_input,
                        global const uint2* ends, global const uint* list, global const uint* begins,
                        global const uint* offsets, global const uint* hits, global const uint* starts,
                        global uint2* links, global uint* owners) {
  const uint parts = begins[count];
  FOR_EACH(part, parts) {
    const uint i = last_begin(begins, count, part);
    const uint first = offsets[begins[i]], last = offsets[part + 1u], c = list[i];
    uint before = ends[i].x;
    if (offsets[part] != first) before = gcdt_vertex_of_rank(levels, levels->count - 1u, hits[offsets[part] - 1u]);
    for (uint h = offsets[part]; h < last; ++h) {
      const uint v = gcdt_vertex_of_rank(levels, levels->count - 1u, hits[h]);
      links[starts[c] + h - first] = (uint2)(vertex_input[before], vertex_input[v]);
      owners[starts[c] + h - first] = c;
      before = v;
    }
    if (part + 1u == begins[i + 1u]) {
      links[starts[c] + last - first] = (uint2)(vertex_input[before], vertex_input[ends[i].y]);
      owners[starts[c] + last - first] = c;
    }
  }
}

// One work-item per source of a piece. Replaces the link by the constraint that owns it; links of one constraint do
// not overlap, and owners ascend, so the sources of a piece stay distinct and ascending. No race.
kernel void route_sources(uint count, global const uint* owners, global uint* sources) {
  FOR_EACH(i, count) sources[i] = owners[sources[i]];
}
