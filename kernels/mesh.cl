// SPDX-License-Identifier: Apache-2.0
// What every phase needs of the mesh.
#include "mesh.h"

// One work-item per face. Sets the claim words to 0, before the first stamp of a phase and when the
// stamps are used up. No race: each its own word.
kernel void mesh_clear_claims(uint faces, global uint4* face_data) {
  for (uint t = get_global_id(0); t < faces; t += get_global_size(0)) *claim_word(face_data, t) = 0u;
}
