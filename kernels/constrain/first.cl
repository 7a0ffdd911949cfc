// SPDX-License-Identifier: Apache-2.0
// Where the parts of pieces begin: the faces that hold their division points, found through the history tree. Apart
// from the walks (kernels/constrain/walk.h), since else a GPU waits for many loads one after the other, and has no
// registers for as many work-items; and all walks begin by it, so that its text is compiled once.
#include "common/history.h"
#include "constrain/walk.h"

// The face of v's fan that the germ's line to `other` begins in, if its closure holds the germ, too; else GCDT_NONE.
static uint germ_beside(Fans fans, Mesh mesh, Germ g, uint v, Vertex at, Vertex other, private uint* steps) {
  if (!has_fan(fans, v)) return GCDT_NONE;
  const uint face = face_of_fan(fans, mesh.points, mesh.n, v, at, other, steps);
  if (g.k == 0u) return face;
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)];
#pragma unroll 1
  for (uint i = 0; i < 3u; ++i)
    if (germ_side(g, load_vertex(mesh.points, mesh.n, element(c, i)),
                  load_vertex(mesh.points, mesh.n, element(c, next_corner(i)))) < 0)
      return GCDT_NONE;
  return face;
}

// The face around vertex a, inserted in the last level and not flipped away from since, whose closure holds a point
// next to a towards b; GCDT_NONE if neither of the faces that a brought is around it any more, or if the turn passes
// more than `patience` faces. With a's corners y, z of a face, counter-clockwise, less than 180 degrees apart:
//   b lies between them if it is not right of a -> y and not left of a -> z;
//   else it is less than 180 degrees beyond z, or less than that beyond y, clockwise: there the turn goes.
// b lies beyond the edge that the next face has in common with this one, so the third corner of that face decides.
// Ends: a turn in one direction comes to each face once.
static uint face_around(Mesh mesh, uint a, Vertex at, Vertex b, uint patience, private uint* steps) {
  uint face = new_face(mesh, a, 0u);
  uint4 c = mesh.face_data[GCDT_CORNERS(face)];
  if (c.x != a && c.y != a && c.z != a) {
    face = new_face(mesh, a, 1u);
    c = mesh.face_data[GCDT_CORNERS(face)];
    if (c.x != a && c.y != a && c.z != a) return GCDT_NONE;
  }
  uint k = c.x == a ? 0u : c.y == a ? 1u : 2u;
  const int side_y =
                gcdt_sign64(gcdt_orient2d_from(at, load_vertex(mesh.points, mesh.n, element(c, next_corner(k))), b)),
            side_z = gcdt_sign64(
                gcdt_orient2d_from(at, load_vertex(mesh.points, mesh.n, element(c, previous_corner(k))), b));
  const int turn = side_y < 0 ? -1 : 1;  // counter-clockwise: 1
  if (side_y >= 0 && side_z <= 0) return face;
  for (uint passed = 0; passed < patience; ++passed) {
    // Across the edge a-z, which is opposite y, or a-y.
    const uint4 sides = mesh.face_data[GCDT_SIDES(face)];
    const uint ref = mesh.edge_faces[element(sides, turn > 0 ? next_corner(k) : previous_corner(k)) ^ 1u];
    if (ref == GCDT_NONE) return GCDT_NONE;
    face = GCDT_REF_FACE(ref);
    c = mesh.face_data[GCDT_CORNERS(face)];
    const uint third = GCDT_REF_CORNER(ref);
    k = turn > 0 ? next_corner(third) : previous_corner(third);
    ++*steps;
    const int side = gcdt_sign64(gcdt_orient2d_from(at, load_vertex(mesh.points, mesh.n, element(c, third)), b));
    if (side * turn <= 0) return face;
  }
  return GCDT_NONE;
}

// A face whose closure holds division point k of a-b, moved infinitely little towards b, or GCDT_NONE if that takes too
// long. Walks in the top layer turn around vertices with many faces: the constraint may begin or end at one (its own
// first point is the germ of k = 0), and then lie beside it for long.
GCDT_APART uint locate_division_point(GCDT_LEVELS_POINTER levels, uint level, Walked walked, History h, uint2 ends,
                                      int4 line, uint k, uint parts, private uint* steps) {
  const Mesh mesh = walked.mesh;
  const uint a = ends.x, b = ends.y;
  Germ g;
  g.p = line_begin(line);
  g.q = line_end(line);
  g.k = k;
  g.parts = parts;
  for (uint end = 0; end < (k > 0u ? 2u : 1u); ++end) {
    const uint face = germ_beside(walked.fans, mesh, g, end ? b : a, end ? g.q : g.p, end ? g.p : g.q, steps);
    if (face != GCDT_NONE) return face;
  }
  if (k == 0u && a >= h.begin && a < h.end) {
    const uint face = face_around(mesh, a, g.p, g.q, walked.patience, steps);
    if (face != GCDT_NONE) return face;
  }
  uint zero;
  const uint top = find_in_top_layer(levels, level, mesh, h, g, a, k == 0u, walked.patience, steps, &zero);
  return top == GCDT_NONE ? top : descend_history(mesh.points, mesh.n, h, g, top, steps);
}

// One work-item per part. Writes the part's piece, if it is not listed but GCDT_NONE, and its first face, and for the
// first one of a piece its line: its own words. The face is GCDT_NONE if a hasty search takes too long, or the mesh is
// wrong. If `again`, pieces have been walked from the same point or from the one that their parts are cut at now, and
// walked_face says where it was. If `missing`, only faces that are GCDT_NONE are searched.
kernel void first_faces(uint hasty, uint again, uint missing, uint pieces, uint capacity, GCDT_LEVELS_POINTER levels,
                        uint level, GCDT_MESH_PARAMETERS, GCDT_HISTORY_PARAMETERS, GCDT_FAN_PARAMETERS,
                        global const uint2* ends, global const uint* begins, global const uint2* walked,
                        global const uint* walked_face, global int4* lines, global uint* part_piece,
                        global uint* part_face, volatile global Counters* counters) {
  local uint sum;
  Walked through =
      make_walked(make_mesh(n, points, face_data, edge_faces), make_fans(fans_made, fan_begins, fan_faces), hasty);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const uint parts = begins[pieces];
  uint steps = 0;
  FOR_EACH(part, min(parts, capacity)) {
    if (missing && part_face[part] != GCDT_NONE) continue;
    const uint listed = part_piece[part], c = listed != GCDT_NONE ? listed : last_begin(begins, pieces, part);
    const uint k = part - begins[c], count = begins[c + 1u] - begins[c];
    const uint2 before = again ? walked[c] : (uint2)(0u, 0u);
    const uint cut = before.y > 0u ? count / before.y : 0u;  // into so many
    const uint2 e = walk_ends(ends[c]);
    const int4 line = line_of(points, e);
    part_piece[part] = c;
    const uint face = cut > 0u && k % cut == 0u
                          ? walked_face[before.x + k / cut]
                          : locate_division_point(levels, level, through, h, e, line, k, count, &steps);
    if (face == GCDT_NONE) lose_patience(&through);
    part_face[part] = face;
    if (k == 0u) lines[c] = line;
  }
  add_for_group(&sum, &counters->steps_low, &counters->steps_high, steps);
}
