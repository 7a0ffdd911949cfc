// SPDX-License-Identifier: Apache-2.0
// The part of a mesh that is one work-group's for a launch. OpenCL C, and for the host the sizes.
//
// A span is the vertices whose ranks on the curve lie in an interval, with the faces and edges that they brought: by
// their numbers, wherever flips have moved them. In each level these are consecutive numbers. So whose a face is says
// its number alone, and no flip changes it: among the span's faces its work-group is alone. The span's vertices, faces
// and edges have places: numbers from 0 on in the order of their levels.
#ifndef GCDT_SPAN_H
#define GCDT_SPAN_H

#include "common/levels.h"

// Local memory of a span, in words.
#define GCDT_SPAN_LEVEL_WORDS 5u
#define GCDT_SPAN_WORDS (GCDT_SPAN_LEVEL_WORDS * GCDT_MAX_LEVELS)
// Words of bits.
#define GCDT_BIT_WORDS(bits) (((bits) + 31u) / 32u)

#ifdef __OPENCL_VERSION__

#include "flip/flip.h"

// A span's vertices in one level.
typedef struct SpanLevel {
  uint begin;          // the level's first vertex
  uint first, wanted;  // the level's vertices in the interval
  uint count;          // so many of these, for which there is room, are the span's
  uint place;          // how many of the span come before them
} SpanLevel;

typedef struct Span {
  local const SpanLevel* levels;
  uint last;                 // level
  SpanLevel finest, second;  // the last one and that before it, which have nearly all vertices
} Span;

// The first of level j's vertices with rank `rank` or more, or the end of the level. Where isolated vertices come
// early, by bisection; ends: the range halves.
static inline uint first_of_rank(GCDT_LEVELS_POINTER levels, uint j, uint rank) {
  uint low = levels->begin[j], high = levels->begin[j + 1u];
  if (!levels->tabled) {
    const uint stride = levels->stride[j];
    return min(low + gcdt_vertices_before(levels, j, rank / stride + (rank % stride != 0u ? 1u : 0u)), high);
  }
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (gcdt_rank_of_vertex(levels, middle) < rank)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
}

// Called by the whole group. The span of the ranks from begin up to end, in the levels up to `last`. Vertices for which
// there is no room, as isolated ones come besides, are nobody's.
GCDT_GIVEN_LOCAL Span make_span(local uint* memory, GCDT_LEVELS_POINTER levels, uint last, uint begin, uint end,
                                uint room) {
  local SpanLevel* of = (local SpanLevel*)memory;
  barrier(CLK_LOCAL_MEM_FENCE);
  FOR_ALL_TILES(tile, last + 1u) {
    const uint j = tile + get_local_id(0);
    if (j > last) continue;
    of[j].begin = levels->begin[j];
    of[j].first = first_of_rank(levels, j, begin);
    of[j].wanted = first_of_rank(levels, j, end) - of[j].first;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  FOR_ALL_TILES(tile, last + 1u) {
    const uint j = tile + get_local_id(0);
    if (j > last) continue;
    uint before = 0;
    for (uint i = 0; i < j; ++i) before += of[i].wanted;
    of[j].place = min(before, room);
    of[j].count = min(of[j].wanted, room - of[j].place);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const Span span = {.levels = of, .last = last, .finest = of[last], .second = of[last > 0u ? last - 1u : 0u]};
  return span;
}

GCDT_GIVEN_LOCAL uint vertices_of_span(Span s) { return s.finest.place + s.finest.count; }

static inline uint place_in_level(SpanLevel level, uint v) {
  return v - level.first < level.count ? level.place + (v - level.first) : GCDT_NONE;
}

// Which of the span's vertices v is, or GCDT_NONE. Ends: j decreases, and level 0 begins with 0.
GCDT_GIVEN_LOCAL uint place_of_vertex(Span s, uint v) {
  if (v >= s.finest.begin) return place_in_level(s.finest, v);
  if (v >= s.second.begin) return place_in_level(s.second, v);
  uint j = s.last;
  while (v < s.levels[j].begin) --j;
  return place_in_level(s.levels[j], v);
}

// The inverse. Ends: j decreases, and nothing comes before level 0.
GCDT_GIVEN_LOCAL uint vertex_at_place(Span s, uint place) {
  if (place >= s.finest.place) return s.finest.first + (place - s.finest.place);
  if (place >= s.second.place) return s.second.first + (place - s.second.place);
  uint j = s.last;
  while (place < s.levels[j].place) --j;
  return s.levels[j].first + (place - s.levels[j].place);
}

// The same of faces and edges, two and three for each vertex. A root's are nobody's.
GCDT_GIVEN_LOCAL uint place_of_face(Span s, Mesh mesh, uint face) {
  if (face < mesh.roots) return GCDT_NONE;
  const uint place = place_of_vertex(s, (face - mesh.roots) / 2u);
  return place == GCDT_NONE ? GCDT_NONE : 2u * place + (face - mesh.roots) % 2u;
}
GCDT_GIVEN_LOCAL uint place_of_edge(Span s, Mesh mesh, uint e) {
  if (e < 3u * mesh.roots) return GCDT_NONE;
  const uint place = place_of_vertex(s, e / 3u - mesh.roots);
  return place == GCDT_NONE ? GCDT_NONE : 3u * place + e % 3u;
}
GCDT_GIVEN_LOCAL uint face_at_place(Span s, Mesh mesh, uint place) {
  return new_face(mesh, vertex_at_place(s, place / 2u), place % 2u);
}
GCDT_GIVEN_LOCAL uint edge_at_place(Span s, Mesh mesh, uint place) {
  return new_edge(mesh, vertex_at_place(s, place / 3u), place % 3u);
}

// Called by the whole group: the edges of the interval's vertices that are nobody's are to be tested after this launch.
GCDT_GIVEN_LOCAL void leave_beyond(Span s, Mesh mesh, global uint* edge_marks) {
  for (uint j = 0; j <= s.last; ++j) {
    const uint v = s.levels[j].first + s.levels[j].count, edges = 3u * (s.levels[j].wanted - s.levels[j].count);
    FOR_ALL_TILES(tile, edges) {
      const uint i = tile + get_local_id(0);
      if (i < edges) atomic_or(edge_marks + new_edge(mesh, v, 0u) + i, GCDT_MARK_QUEUED);
    }
  }
}

// Called by the whole group: all edges of the span's numbers are to be tested after this launch.
GCDT_GIVEN_LOCAL void leave_all(Span s, Mesh mesh, global uint* edge_marks) {
  const uint edges = 3u * vertices_of_span(s);
  FOR_ALL_TILES(tile, edges) {
    const uint i = tile + get_local_id(0);
    if (i < edges) atomic_or(edge_marks + edge_at_place(s, mesh, i), GCDT_MARK_QUEUED);
  }
}

// ---- Bits ------------------------------------------------------------------------------------------

GCDT_GIVEN_LOCAL bool is_set(volatile local const uint* bits, uint i) {
  return (bits[i / 32u] >> (i % 32u) & 1u) != 0u;
}
GCDT_GIVEN_LOCAL void set_bit(volatile local uint* bits, uint i) { atomic_or(bits + i / 32u, 1u << (i % 32u)); }

// Takes the face with this place if nobody has it in this round.
GCDT_GIVEN_LOCAL bool take_lock(volatile local uint* taken, uint place) {
  const uint bit = 1u << (place % 32u);
  return (atomic_or(taken + place / 32u, bit) & bit) == 0u;
}

// Whether the illegal edge between the faces with these places has both. The lesser one is asked for first, and given
// back if the other one is somebody's. So an edge wins in each round that has an illegal one: whoever took the greatest
// face that is taken at any time either took it second, or then asked for a greater one, which nobody took.
GCDT_GIVEN_LOCAL bool take_both(volatile local uint* taken, uint t, uint u) {
  const uint first = min(t, u);
  if (!take_lock(taken, first)) return false;
  if (take_lock(taken, max(t, u))) return true;
  atomic_and(taken + first / 32u, ~(1u << (first % 32u)));
  return false;
}

#endif  // __OPENCL_VERSION__

#endif
