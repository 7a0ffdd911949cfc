// SPDX-License-Identifier: Apache-2.0
// A finite face as a triangle of the result. OpenCL C only.
#ifndef GCDT_TRIANGLE_H
#define GCDT_TRIANGLE_H

#include "common/corners.h"
#include "common/shared.h"

// Writes triangle i, which is the face of refs[i] from that corner on: its corners; across from each the neighbour by
// positions, by face; which of the same edges are constrained.
static inline void gather_triangle(uint i, global const uint4* face_data, global const uint* edge_faces,
                                   global const uint* edge_marks, global const uint* refs, global const int* positions,
                                   global uint* out_corners, global int* out_neighbours,
                                   global uchar* out_constrained) {
  const uint f = GCDT_REF_FACE(refs[i]), first = GCDT_REF_CORNER(refs[i]);
  vstore3(rotate_to(face_data[GCDT_CORNERS(f)], first).xyz, i, out_corners);
  const uint3 s = rotate_to(face_data[GCDT_SIDES(f)], first).xyz;
  const uint3 across = (uint3)(edge_faces[s.x ^ 1u], edge_faces[s.y ^ 1u], edge_faces[s.z ^ 1u]);
  vstore3((int3)(positions[GCDT_REF_FACE(across.x)], positions[GCDT_REF_FACE(across.y)],
                 positions[GCDT_REF_FACE(across.z)]),
          i, out_neighbours);
  const uint3 marks =
      (uint3)(edge_marks[GCDT_SIDE_EDGE(s.x)], edge_marks[GCDT_SIDE_EDGE(s.y)], edge_marks[GCDT_SIDE_EDGE(s.z)]) &
      GCDT_MARK_CONSTRAINED;
  out_constrained[i] = (uchar)(marks.x | marks.y << 1 | marks.z << 2);
}

#endif
