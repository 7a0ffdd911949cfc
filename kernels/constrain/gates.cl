// SPDX-License-Identifier: Apache-2.0
// Makes the gates of all edges (kernels/constrain/gates.h) of a mesh that does not change while they are used.
#include "constrain/gates.h"

static int4 gate_to_keep(Mesh mesh, uint side) {
  const uint ref = mesh.edge_faces[side];
  if (ref == GCDT_NONE) return (int4)(0, 0, (int)GCDT_NONE, (int)GCDT_NONE);
  const Gate g = gate_of_side(mesh, side);
  return (int4)(g.apex, (int)g.after, (int)g.before);
}

// One work-item per edge. Writes the gates of its two sides: its own words.
kernel void gates_make(uint edges, GCDT_MESH_PARAMETERS, global int4* at) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(e, edges) {
    const int4 first = gate_to_keep(mesh, GCDT_SIDE(e, 0u)), second = gate_to_keep(mesh, GCDT_SIDE(e, 1u));
    at[GCDT_SIDE(e, 0u)] = first;
    at[GCDT_SIDE(e, 1u)] = second;
  }
}
