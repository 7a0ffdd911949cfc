// SPDX-License-Identifier: Apache-2.0
// Fans in a finished mesh that covers the convex hull, whose corners are numbers of input vertices (`by_input`) or of
// vertices.
#include "common/mesh.h"
#include "query/locate.h"

#define FACES_PARAMETERS \
  global const uint *mesh_corners, global const int *neighbours, const uint by_input, global const uint *input_vertex
#define FACES mesh_corners, neighbours, by_input, input_vertex

static inline uint4 corners_of_face(FACES_PARAMETERS, uint t) {
  return (uint4)(vertex_of(input_vertex, by_input, mesh_corners[3u * t]),
                 vertex_of(input_vertex, by_input, mesh_corners[3u * t + 1u]),
                 vertex_of(input_vertex, by_input, mesh_corners[3u * t + 2u]), 0u);
}

// None beyond the convex hull. Of the face there, the corner that has the same vertex.
static inline uint next_around(FACES_PARAMETERS, uint t, uint k, volatile global Counters* counters) {
  const int other = neighbours[3u * t + next_corner(k)];
  if (other < 0) return GCDT_NONE;
  const uint corner = mesh_corners[3u * t + k];
  for (uint j = 0; j < 3u; ++j)
    if (mesh_corners[3u * (uint)other + j] == corner) return 4u * (uint)other + j;
  atomic_or(&counters->failed, GCDT_FAILED_WALK);
  return GCDT_NONE;
}

// On the hull a fan begins with the face that has none before it.
static inline uint begin_of_fan(FACES_PARAMETERS, uint t, uint k, uint4 c, uint n, uint at) {
  return neighbours[3u * t + previous_corner(k)] < 0 ? at : at | GCDT_RING_CLOSED;
}

#include "constrain/fans.h"
