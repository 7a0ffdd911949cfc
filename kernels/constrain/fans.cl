// SPDX-License-Identifier: Apache-2.0
// Fans in a mesh that is being made.
#include "common/mesh.h"

#define FACES_PARAMETERS global const uint4 *face_data, global const uint *edge_faces
#define FACES face_data, edge_faces

static inline uint4 corners_of_face(FACES_PARAMETERS, uint t) { return face_data[GCDT_CORNERS(t)]; }

// All fans are closed here: symbolic vertices surround the others.
static inline uint next_around(FACES_PARAMETERS, uint t, uint k, volatile global Counters* counters) {
  const uint ref = edge_faces[element(face_data[GCDT_SIDES(t)], next_corner(k)) ^ 1u];
  if (ref == GCDT_NONE) {
    atomic_or(&counters->failed, GCDT_FAILED_WALK);
    return GCDT_NONE;
  }
  // Seen from there, the edge between them begins at the vertex.
  return 4u * GCDT_REF_FACE(ref) + next_corner(GCDT_REF_CORNER(ref));
}

// The corner after the vertex is finite in the first.
static inline uint begin_of_fan(FACES_PARAMETERS, uint t, uint k, uint4 c, uint n, uint at) {
  return element(c, next_corner(k)) < n ? at : GCDT_NONE;
}

#include "constrain/fans.h"
