// SPDX-License-Identifier: Apache-2.0
// The fan of a vertex: the faces around it, counter-clockwise, in one array. Finding the one that a direction points
// into takes bisection then, not a turn around the vertex, which can have as many faces as there are vertices; and a
// launch lasts as long as its longest walk. Vertices of many faces have fans, and only once a walk has taken too long
// (kernels/constrain/fans.h, lib/phases/fans.hpp). OpenCL C and C++17 the least number, OpenCL C all else.
#ifndef GCDT_FAN_H
#define GCDT_FAN_H

// Faces of a vertex that has a fan, at least; and those that a walk passes, at most, before it asks for fans.
#define GCDT_FAN_LEAST 256u
// The least number of faces that a work-item passes before it asks for fans, after many searches that did.
#define GCDT_LEAST_PATIENCE 16u

// Of the element with which a fan begins: another one leads to it. Elements are at most 2.3 n (lib/phases/fans.hpp),
// below this.
#define GCDT_RING_CLOSED 0x80000000u

// How many times as far links reach after a round of list ranking (fans.h): by four, a round has the loads of two
// rounds by two, in one launch.
#define GCDT_FAN_REACH 4u

#ifdef __OPENCL_VERSION__
#include "common/mesh.h"

typedef struct Fans {
  uint made;
  global const uint* begins;  // n + 1: the fan of vertex v is [begins[v], begins[v + 1]), empty if it has few faces
  global const uint2* faces;  // a face, and its corner after v, which is finite in the first
} Fans;

#define GCDT_FAN_PARAMETERS uint fans_made, global const uint *fan_begins, global const uint2 *fan_faces

static inline Fans make_fans(GCDT_FAN_PARAMETERS) {
  const Fans f = {.made = fans_made, .begins = fan_begins, .faces = fan_faces};
  return f;
}

static inline bool has_fan(Fans f, uint v) { return f.made && f.begins[v + 1u] > f.begins[v]; }

// The face of vertex v's fan, which there is, whose closure holds a point next to v towards b; of two, either.
// Directions are compared by their angles counter-clockwise from the first corner y of the fan: that of b is above 180
// degrees if y lies left of v -> b, below if right, and 0 or 180 if y lies on the line. A corner is beyond b in this
// order,
//   y left:   if it is left, too, and clockwise of y
//   y right:  unless it is y, or right or on the line, and counter-clockwise of y
//   y on it:  if it is left, with 180 degrees; with 0 all are but y
// With 0 those that are not left count as not beyond, so that the search ends at the first face or at the last one,
// which both have the edge v-y. Corners of one fan point into distinct directions, less than 180 degrees from one to
// the next. Ends: the range halves.
static uint face_of_fan(Fans f, global const int2* points, uint n, uint v, Vertex at, Vertex b, private uint* steps) {
  const uint begin = f.begins[v];
  uint low = begin, high = f.begins[v + 1u];
  const Vertex y = vertex_at(points, f.faces[begin].y);
  const int first = gcdt_sign64(gcdt_orient2d_from(at, b, y));
  while (high - low > 1u) {
    const uint middle = low + (high - low) / 2u;
    const Vertex corner = load_vertex(points, n, f.faces[middle].y);
    const int side = gcdt_sign64(gcdt_orient2d_from(at, b, corner)),
              turn = gcdt_sign64(gcdt_orient2d_from(at, y, corner));
    const bool beyond = first > 0 ? side > 0 && turn < 0 : first < 0 ? side > 0 || turn < 0 : side > 0;
    ++*steps;
    if (beyond)
      high = middle;
    else
      low = middle;
  }
  return f.faces[low].x;
}

#endif

#endif
