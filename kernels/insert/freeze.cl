// SPDX-License-Identifier: Apache-2.0
// The mesh as it is becomes the top layer of a history tree: before a level's vertices are inserted (insert.cl), or for
// constraints, also where grow.cl inserted and kept no history; a file of its own, so that those need not build
// insert.cl for it.
#include "common/history.h"

// One work-item per face of the coarser mesh. Reads the mesh; writes the frozen top layer, and for each vertex the face
// of the greatest number: of the faces around it those that are greater than both beside them, one of which is the
// greatest, ask by atomic_max, so the order of work-items cannot matter (vertex_face starts at 0). After: the top layer
// stands apart from the mesh, each face a leaf; the counters, which nobody else uses in this launch, are zero.
// (They come as words: of a pointer to words that is made of one to a struct, Mesa 22.3 stores the first alone.)
kernel void insert_freeze(uint faces, GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS, global uint* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(i, (uint)(sizeof(Counters) / sizeof(uint))) { counters[i] = 0u; }
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  FOR_EACH(t, faces) {
    const uint4 c = mesh.face_data[GCDT_CORNERS(t)], s = mesh.face_data[GCDT_SIDES(t)];
    const uint a0 = mesh.edge_faces[s.x ^ 1u], a1 = mesh.edge_faces[s.y ^ 1u], a2 = mesh.edge_faces[s.z ^ 1u];
    h.top[GCDT_CORNERS(t)] = (uint4)(c.x, c.y, c.z, HISTORY_REF(t, HISTORY_LEAF));
    const uint3 across = (uint3)(a0 == GCDT_NONE ? a0 : GCDT_REF_FACE(a0), a1 == GCDT_NONE ? a1 : GCDT_REF_FACE(a1),
                                 a2 == GCDT_NONE ? a2 : GCDT_REF_FACE(a2));
    h.top[GCDT_SIDES(t)] = (uint4)(across.x, across.y, across.z, 0u);
    mesh.face_data[GCDT_CORNERS(t)].w = 0u;
    const bool above_x = a0 == GCDT_NONE || t > across.x, above_y = a1 == GCDT_NONE || t > across.y,
               above_z = a2 == GCDT_NONE || t > across.z;
    if (c.x < n && above_y && above_z) atomic_max(h.vertex_face + c.x, t);
    if (c.y < n && above_x && above_z) atomic_max(h.vertex_face + c.y, t);
    if (c.z < n && above_x && above_y) atomic_max(h.vertex_face + c.z, t);
  }
}
