// SPDX-License-Identifier: Apache-2.0
// The finite faces in any order, where nobody asked for the canonical one.
#include "common/mesh.h"

// One work-item per face.
// Reads corners. Writes finite[f]: 1 if all corners of face f are finite vertices, else 0.
// Word f has one writer.
// After this kernel the scan of `finite` numbers the finite faces.
kernel void select_finite(const uint count, const uint n, global const uint4* face_data, global uint* finite) {
  FOR_EACH(f, count) {
    const uint4 c = face_data[GCDT_CORNERS(f)];
    finite[f] = max(max(c.x, c.y), c.z) < n ? 1u : 0u;
  }
}

// One work-item per face.
// Reads before, the scan of `finite` (count + 1 elements). Writes refs at the places of finite faces.
// The scan gives each of them a place of its own.
// After this kernel refs holds the reference of the first corner of every finite face.
kernel void select_refs(const uint count, global const uint* before, global uint* refs) {
  FOR_EACH(f, count)
  if (before[f + 1] != before[f]) refs[before[f]] = GCDT_FACE_REF(f, 0u);
}
