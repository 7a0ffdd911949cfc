// SPDX-License-Identifier: Apache-2.0
// What the check of a finished mesh reports. OpenCL C and C++17.
#ifndef GCDT_CHECK_H
#define GCDT_CHECK_H

#include "common/shared.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// What can be wrong, in the order in which it is reported. The offending thing is a triangle t, a half
// edge 3t + k (the edge of triangle t across from corner k), a vertex or a piece.
#define GCDT_CHECK_CORNER 0u      // triangle: a corner is no vertex
#define GCDT_CHECK_ORIENT 1u      // triangle: not counter-clockwise
#define GCDT_CHECK_NEIGHBOUR 2u   // half edge: the neighbour is no triangle
#define GCDT_CHECK_REVERSED 3u    // half edge: the neighbour does not have the reversed edge
#define GCDT_CHECK_BACK 4u        // half edge: the neighbour does not link back
#define GCDT_CHECK_FORK 5u        // vertex: two boundary edges begin there, or two end
#define GCDT_CHECK_CONVEX 6u      // vertex: the boundary turns right or back there
#define GCDT_CHECK_UNUSED 7u      // vertex: not a corner
#define GCDT_CHECK_COLLINEAR 8u   // vertex: no triangles, although not on one line
#define GCDT_CHECK_FLAG 9u        // half edge: flagged on one side only; or t has flags that are no edge's
#define GCDT_CHECK_EXTRA 10u      // half edge: flagged, but no piece
#define GCDT_CHECK_MISSING 11u    // piece: no edge
#define GCDT_CHECK_UNFLAGGED 12u  // piece: an edge, but not flagged
#define GCDT_CHECK_DELAUNAY 13u   // half edge: the vertex across lies inside the circle
#define GCDT_CHECK_TIE 14u        // half edge: cocircular, and the other diagonal holds the least vertex
#define GCDT_CHECK_KINDS 15u

typedef struct CheckReport {
  u32 first[GCDT_CHECK_KINDS];  // the least offending number of each kind, GCDT_NONE if there is none
  u32 hull_vertices;            // vertices on the boundary
  u32 least_corners;            // boundary vertices below both neighbours there, x first
  u32 constrained_edges;
} CheckReport;

#ifdef __OPENCL_VERSION__
// atomic_min finds the least number of a kind, whatever the schedule.
static inline void note(global CheckReport* report, uint kind, uint number) {
  atomic_min(&report->first[kind], number);
}
#else
static_assert(sizeof(CheckReport) == 18 * sizeof(u32), "CheckReport has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif
