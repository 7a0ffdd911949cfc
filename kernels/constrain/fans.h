// SPDX-License-Identifier: Apache-2.0
// The fans of all vertices with many faces (kernels/constrain/fan.h), of whatever mesh the program that includes this
// reads. What follows a face around a vertex is known face by face; its place in the fan is found by list ranking: each
// corner of such a vertex is an element, which points to the next one counter-clockwise, and in each round to the one
// four times as far (Wyllie 1979, two of whose steps are one here). OpenCL C only.
//
// The program defines
//   FACES_PARAMETERS, FACES          the arrays of its mesh as parameters and as arguments
//   corners_of_face(FACES, t)        the corners of face t, numbers of vertices, or above them
//   next_around(FACES, t, k, ...)    the next face counter-clockwise around corner k of face t, and its corner there,
//   as
//                                    4 * face + corner; GCDT_NONE if there is none, of which it may say in the counters
//                                    that it is a failure
//   begin_of_fan(FACES, t, k, c, n, at) the least of these is where the fan begins: element `at` itself, also with
//                                    GCDT_RING_CLOSED, or GCDT_NONE if it may not begin with it
#ifndef GCDT_FANS_H
#define GCDT_FANS_H

#include "constrain/fan.h"

// Vertices that a group counts for itself: a power of two.
#define GCDT_DEGREES_OF_GROUP 1024u

// Elements are numbered by face and corner: those of face t are offsets[t] ...
typedef struct Elements {
  global const uint* begins;   // of fans
  global const uint* offsets;  // of faces
} Elements;

static inline bool is_centre(global const uint* begins, uint n, uint v) { return v < n && begins[v + 1u] > begins[v]; }

// Of corner k of face t, whose corners are c; or where it would be.
static inline uint element_of(Elements e, uint n, uint t, uint4 c, uint k) {
  return e.offsets[t] + (k > 0u && is_centre(e.begins, n, c.x) ? 1u : 0u) +
         (k > 1u && is_centre(e.begins, n, c.y) ? 1u : 0u);
}

// Counts a face of vertex v: in the group's table, if v has its place there, or takes it, else in `degrees`.
static inline void count_face(uint v, uint n, volatile local uint* vertices, volatile local uint* counts,
                              volatile global uint* degrees) {
  if (v >= n) return;
  const uint place = v % GCDT_DEGREES_OF_GROUP, there = atomic_cmpxchg(vertices + place, GCDT_NONE, v);
  if (there == GCDT_NONE || there == v)
    atomic_inc(counts + place);
  else
    atomic_inc(degrees + v);
}

// One work-item per face. Counts the faces of each vertex. A vertex that many faces have would be waited for, so a
// group counts for itself, in a table that has room for one vertex in each place: the first that comes there. No race:
// atomic additions, whose order cannot matter.
kernel void fans_degrees(uint faces, uint n, FACES_PARAMETERS, volatile global uint* degrees) {
#ifdef GCDT_CONTIGUOUS
  FOR_EACH(t, faces) {
    const uint4 c = corners_of_face(FACES, t);
    for (uint k = 0; k < 3u; ++k)
      if (element(c, k) < n) atomic_inc(degrees + element(c, k));
  }
#else
  local uint vertices[GCDT_DEGREES_OF_GROUP], counts[GCDT_DEGREES_OF_GROUP];
  for (uint i = get_local_id(0); i < GCDT_DEGREES_OF_GROUP; i += get_local_size(0))
    vertices[i] = GCDT_NONE, counts[i] = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  FOR_EACH(t, faces) {
    const uint4 c = corners_of_face(FACES, t);
    count_face(c.x, n, vertices, counts, degrees);
    count_face(c.y, n, vertices, counts, degrees);
    count_face(c.z, n, vertices, counts, degrees);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = get_local_id(0); i < GCDT_DEGREES_OF_GROUP; i += get_local_size(0))
    if (counts[i] > 0u) atomic_add(degrees + vertices[i], counts[i]);
#endif
}

// One work-item per vertex. Keeps the number of faces where it is at least GCDT_FAN_LEAST. No race: its own word.
kernel void fans_choose(uint n, global uint* degrees) {
  FOR_EACH(v, n) {
    if (degrees[v] < GCDT_FAN_LEAST) degrees[v] = 0u;
  }
}

// One work-item per face. Writes how many elements it has. No race: its own word.
kernel void fans_count(uint faces, uint n, FACES_PARAMETERS, global const uint* begins, global uint* counts) {
  FOR_EACH(t, faces) {
    const uint4 c = corners_of_face(FACES, t);
    counts[t] = (is_centre(begins, n, c.x) ? 1u : 0u) + (is_centre(begins, n, c.y) ? 1u : 0u) +
                (is_centre(begins, n, c.z) ? 1u : 0u);
  }
}

// One work-item per face. Writes its elements: their face and corner, and the element of the next face
// counter-clockwise around the same vertex; and at the begin of each fan, by atomic_min, with which element it begins:
// those ask which the next one is not before, as the first of all is. No other race: elements have one face each.
kernel void fans_link(uint faces, uint n, FACES_PARAMETERS, global const uint* begins, global const uint* offsets,
                      global uint* corners, global uint2* links, volatile global uint* fan_faces,
                      volatile global Counters* counters) {
  const Elements e = {.begins = begins, .offsets = offsets};
  FOR_EACH(t, faces) {
    if (offsets[t + 1u] == offsets[t]) continue;
    const uint4 c = corners_of_face(FACES, t);
    uint at = offsets[t];
    for (uint k = 0; k < 3u; ++k) {
      const uint v = element(c, k);
      if (!is_centre(begins, n, v)) continue;
      corners[at] = 4u * t + k;
      const uint begin = begin_of_fan(FACES, t, k, c, n, at);
      uint begin_of_next = GCDT_NONE;
      uint2 link = (uint2)(at, 0u);
      const uint next = next_around(FACES, t, k, counters);
      if (next != GCDT_NONE) {
        const uint other = next >> 2, corner = next & 3u;
        const uint4 corners_there = corners_of_face(FACES, other);
        link = (uint2)(element_of(e, n, other, corners_there, corner), 1u);
        begin_of_next = begin_of_fan(FACES, other, corner, corners_there, n, link.x);
      }
      links[at] = link;
      if (begin < begin_of_next) atomic_min(fan_faces + 2u * begins[v], begin);
      ++at;
    }
  }
}

static inline uint centre_of(FACES_PARAMETERS, uint corner) {
  return element(corners_of_face(FACES, corner >> 2), corner & 3u);
}

// One work-item per element. Makes the one before the first of its fan the last: it points to itself. No race: its own
// word.
kernel void fans_cut(uint count, FACES_PARAMETERS, global const uint* begins, global const uint* corners,
                     global const uint2* fan_faces, global uint2* links) {
  FOR_EACH(i, count) {
    if (links[i].x == (fan_faces[begins[centre_of(FACES, corners[i])]].x & ~GCDT_RING_CLOSED))
      links[i] = (uint2)(i, 0u);
  }
}

// One work-item per element. Points GCDT_FAN_REACH times as far as before: links say to which, and how far that is. No
// race: reads one buffer and writes its own word of the other.
kernel void fans_reach(uint count, global const uint2* links, global uint2* farther) {
  FOR_EACH(i, count) {
    uint2 link = links[i];
    for (uint k = 1; k < GCDT_FAN_REACH; ++k) {
      const uint2 next = links[link.x];
      link = (uint2)(next.x, link.y + next.y);
    }
    farther[i] = link;
  }
}

// One work-item per element, which knows how many come after it in its fan. Writes it to its place. No race: in a valid
// mesh places are distinct; in another one the failure bit says so, or the walks do.
kernel void fans_place(uint count, FACES_PARAMETERS, global const uint* begins, global const uint* corners,
                       global const uint2* links, global uint2* fan_faces, volatile global Counters* counters) {
  FOR_EACH(i, count) {
    const uint t = corners[i] >> 2, k = corners[i] & 3u;
    const uint4 c = corners_of_face(FACES, t);
    const uint v = element(c, k), degree = begins[v + 1u] - begins[v], after = links[i].y;
    if (after < degree)
      fan_faces[begins[v] + (degree - 1u - after)] = (uint2)(t, element(c, next_corner(k)));
    else
      atomic_or(&counters->failed, GCDT_FAILED_WALK);
  }
}

#endif
