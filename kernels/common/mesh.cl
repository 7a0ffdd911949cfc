// SPDX-License-Identifier: Apache-2.0
// What every phase needs of the mesh.
#include "common/mesh.h"

// One work-item per root (one, but in forests). Writes what it brings. No race: each its own words. After: a mesh
// without finite vertices.
kernel void mesh_root(GCDT_MESH_PARAMETERS) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(p, mesh.roots) make_root(mesh, p);
}

// One work-item per face. Sets the claim words to 0, before the first stamp of a phase and when the
// stamps are used up. No race: each its own word.
kernel void mesh_clear_claims(uint faces, global uint4* face_data) {
  FOR_EACH(t, faces) * claim_word(face_data, t) = 0u;
}
