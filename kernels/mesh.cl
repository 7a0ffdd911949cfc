// SPDX-License-Identifier: Apache-2.0
// What every phase needs of the mesh.
#include "mesh.h"

// One work-item per root (one, but in forests). Writes the symbolic triangle as face p with edges 3p, 3p+1, 3p+2
// that have no other side. No race: each its own words. After: a mesh without finite vertices.
kernel void mesh_root(GCDT_MESH_PARAMETERS) {
  const uint roots = root_count(points, n);
  FOR_EACH(p, roots) {
    const uint v = n + 3u * p, e = 3u * p;
    face_data[GCDT_CORNERS(p)] = (uint4)(v, v + 1u, v + 2u, 0u);
    face_data[GCDT_SIDES(p)] = (uint4)(GCDT_SIDE(e, 0u), GCDT_SIDE(e + 1u, 0u), GCDT_SIDE(e + 2u, 0u), 0u);
    for (uint k = 0; k < 3u; ++k) {
      edge_faces[2u * (e + k)] = GCDT_FACE_REF(p, k);
      edge_faces[2u * (e + k) + 1u] = GCDT_NONE;
    }
  }
}

// One work-item per face. Sets the claim words to 0, before the first stamp of a phase and when the
// stamps are used up. No race: each its own word.
kernel void mesh_clear_claims(uint faces, global uint4* face_data) {
  FOR_EACH(t, faces) * claim_word(face_data, t) = 0u;
}
