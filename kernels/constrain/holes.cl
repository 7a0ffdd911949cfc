// SPDX-License-Identifier: Apache-2.0
// The triangles of holes, which chains leave in hexagons (paper, 6.5): a program of its own, as few inputs have some.
#include "constrain/chains.h"
#include "constrain/near.h"

// The part of piece c that crosses the edge from `right` to `left`: the first that does not end before it
// (end_of_part). Ends: the range halves.
static uint part_that_crosses(Mesh mesh, Vertex a, Vertex b, uint right, uint left, uint parts) {
  const Vertex r = load_vertex(mesh.points, mesh.n, right), l = load_vertex(mesh.points, mesh.n, left);
  uint low = 0, high = parts - 1u;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (gcdt_orient2d_division(r, l, a, b, middle + 1u, parts) > 0)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
}

// One work-item per corner of a hexagon. Writes the place in the chains of the hole's corner there: the owned vertex
// just before this place when the piece that cuts the corner farthest is run through with the hexagon's middle on its
// left. Walks the one part that leaves the hexagon, up to there, hence before its end, and counts what it owns. No
// race: its own word.
kernel void hole_corners(uint hexagons, uint pieces, uint capacity, GCDT_MESH_PARAMETERS, GCDT_GATE_PARAMETERS,
                         global const uint* near, global const uint2* ends, global const uint* begins,
                         global const int4* lines, global const uint* part_face, global const uint* starts,
                         global const uint* far, global const uint* hexagon_face, global uint* hole_place,
                         volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Gates gates = make_gates(gates_made, gates_at);
  FOR_EACH(i, 3u * hexagons) {
    const uint c = far[i], k = i % 3u, t = hexagon_face[i / 3u];
    hole_place[i] = 0u;
    if (c == GCDT_NONE) {
      atomic_or(&counters->failed, GCDT_FAILED_WALK);
      continue;
    }
    const uint4 corners = mesh.face_data[GCDT_CORNERS(t)];
    const Vertex a = line_begin(lines[c]), b = line_end(lines[c]);
    const bool cut_right = gcdt_orient2d(a, b, load_vertex(mesh.points, mesh.n, element(corners, k))) < 0;
    const uint third = cut_right ? previous_corner(k) : next_corner(k), parts = begins[c + 1u] - begins[c];
    const uint part = part_that_crosses(mesh, a, b, element(corners, next_corner(third)),
                                        element(corners, previous_corner(third)), parts);
    uint left = left_begin(starts, begins[c] + part, c) + 1u;
    uint right = right_begin(starts, capacity, pieces, begins[c] + part, c) + 1u;
    const uint leaves = face_side(mesh, t, third);  // by this edge the walk leaves the hexagon
    Walk w;
    uint event = walk_begin(&w, mesh, part_face[begins[c] + part], walk_ends(ends[c]), lines[c], part, parts);
    // Ends: every edge crossed lies further along the piece.
    while (event == WALK_CROSS && w.code != leaves) {
      const uint2 at = near_complete(near, w.code);
      left += owns_left(&w, at, c) ? 1u : 0u;
      right += owns_right(&w, at, c) ? 1u : 0u;
      event = walk_cross(&w, mesh, look_behind(&w, mesh, gates));
    }
    if (event != WALK_CROSS) atomic_or(&counters->failed, GCDT_FAILED_WALK);
    hole_place[i] = cut_right ? left - 1u : right;
  }
}

// One work-item per hexagon. Writes the hole triangle into its own slot, after the chains' triangles. Its links
// are left to stitch.cl.
kernel void hole_triangles(uint hexagons, uint first, global const uint* hole_place, global const uint* chain_vertex,
                           global const uint* crossed, global uint4* face_data) {
  FOR_EACH(h, hexagons) {
    const uint t = crossed[first + h];
    face_data[GCDT_CORNERS(t)] = (uint4)(chain_vertex[hole_place[3u * h]], chain_vertex[hole_place[3u * h + 1u]],
                                         chain_vertex[hole_place[3u * h + 2u]], 0u);
    for (uint k = 0; k < 3u; ++k) set_side(face_data, t, k, GCDT_NONE);
  }
}
