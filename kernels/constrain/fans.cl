// SPDX-License-Identifier: Apache-2.0
// Makes the fans of all vertices with many faces (kernels/constrain/fan.h). What follows a face around a vertex is
// known face by face; its place in the fan is found by list ranking: each corner of such a vertex is an element, which
// points to the next one counter-clockwise, and in each round to the one twice as far (Wyllie 1979).
#include "constrain/fan.h"

// Elements are numbered by face and corner: those of face t are offsets[t] ...
typedef struct Elements {
  global const uint* begins;   // of fans
  global const uint* offsets;  // of faces
} Elements;

static inline Elements make_elements(global const uint* begins, global const uint* offsets) {
  const Elements e = {.begins = begins, .offsets = offsets};
  return e;
}

static inline bool is_centre(global const uint* begins, uint n, uint v) { return v < n && begins[v + 1u] > begins[v]; }

// Of corner k of face t, whose corners are c; or where it would be.
static inline uint element_of(Elements e, uint n, uint t, uint4 c, uint k) {
  return e.offsets[t] + (k > 0u && is_centre(e.begins, n, c.x) ? 1u : 0u) +
         (k > 1u && is_centre(e.begins, n, c.y) ? 1u : 0u);
}

// One work-item per face. Counts the faces of each vertex. No race: atomic additions, whose order cannot matter.
kernel void fans_degrees(uint faces, uint n, global const uint4* face_data, volatile global uint* degrees) {
  FOR_EACH(t, faces) {
    const uint4 c = face_data[GCDT_CORNERS(t)];
    for (uint k = 0; k < 3u; ++k)
      if (element(c, k) < n) atomic_inc(degrees + element(c, k));
  }
}

// One work-item per vertex. Keeps the number of faces where it is at least GCDT_FAN_LEAST. No race: its own word.
kernel void fans_choose(uint n, global uint* degrees) {
  FOR_EACH(v, n) {
    if (degrees[v] < GCDT_FAN_LEAST) degrees[v] = 0u;
  }
}

// One work-item per face. Writes how many elements it has. No race: its own word.
kernel void fans_count(uint faces, uint n, global const uint4* face_data, global const uint* begins,
                       global uint* counts) {
  FOR_EACH(t, faces) {
    const uint4 c = face_data[GCDT_CORNERS(t)];
    counts[t] = (is_centre(begins, n, c.x) ? 1u : 0u) + (is_centre(begins, n, c.y) ? 1u : 0u) +
                (is_centre(begins, n, c.z) ? 1u : 0u);
  }
}

// One work-item per face. Writes its elements: their face and corner, and the element of the next face
// counter-clockwise around the same vertex; and at the begin of each fan, by atomic_min, the least of its elements
// whose next corner is finite. No other race: elements have one face each.
kernel void fans_link(uint faces, uint n, global const uint4* face_data, global const uint* edge_faces,
                      global const uint* begins, global const uint* offsets, global uint* corners, global uint2* links,
                      volatile global uint* fan_faces, volatile global Counters* counters) {
  const Elements e = make_elements(begins, offsets);
  FOR_EACH(t, faces) {
    if (offsets[t + 1u] == offsets[t]) continue;
    const uint4 c = face_data[GCDT_CORNERS(t)], sides = face_data[GCDT_SIDES(t)];
    uint at = offsets[t];
    for (uint k = 0; k < 3u; ++k) {
      const uint v = element(c, k);
      if (!is_centre(begins, n, v)) continue;
      corners[at] = 4u * t + k;
      const uint ref = edge_faces[element(sides, next_corner(k)) ^ 1u];
      uint next = at;
      if (ref == GCDT_NONE) {
        atomic_or(&counters->failed, GCDT_FAILED_WALK);
      } else {
        // Seen from there, the edge between them begins at v.
        const uint other = GCDT_REF_FACE(ref);
        next = element_of(e, n, other, face_data[GCDT_CORNERS(other)], next_corner(GCDT_REF_CORNER(ref)));
      }
      links[at] = (uint2)(next, 1u);
      if (element(c, next_corner(k)) < n) atomic_min(fan_faces + 2u * begins[v], at);
      ++at;
    }
  }
}

static inline uint centre_of(global const uint4* face_data, uint corner) {
  return element(face_data[GCDT_CORNERS(corner >> 2)], corner & 3u);
}

// One work-item per element. Makes the one before the first of its fan the last: it points to itself. No race: its own
// word.
kernel void fans_cut(uint count, global const uint4* face_data, global const uint* begins, global const uint* corners,
                     global const uint2* fan_faces, global uint2* links) {
  FOR_EACH(i, count) {
    if (links[i].x == fan_faces[begins[centre_of(face_data, corners[i])]].x) links[i] = (uint2)(i, 0u);
  }
}

// One work-item per element. Points twice as far as before: links say to which, and how far that is. No race: reads one
// buffer and writes its own word of the other.
kernel void fans_double(uint count, global const uint2* links, global uint2* doubled) {
  FOR_EACH(i, count) {
    const uint2 near = links[i], far = links[near.x];
    doubled[i] = (uint2)(far.x, near.y + far.y);
  }
}

// One work-item per element, which knows how many come after it in its fan. Writes it to its place. No race: in a valid
// mesh places are distinct; in another one the failure bit says so, or the walks do.
kernel void fans_place(uint count, global const uint4* face_data, global const uint* begins, global const uint* corners,
                       global const uint2* links, global uint2* fan_faces, volatile global Counters* counters) {
  FOR_EACH(i, count) {
    const uint t = corners[i] >> 2, k = corners[i] & 3u;
    const uint4 c = face_data[GCDT_CORNERS(t)];
    const uint v = element(c, k), degree = begins[v + 1u] - begins[v], after = links[i].y;
    if (after < degree)
      fan_faces[begins[v] + (degree - 1u - after)] = (uint2)(t, element(c, next_corner(k)));
    else
      atomic_or(&counters->failed, GCDT_FAILED_WALK);
  }
}
