// SPDX-License-Identifier: Apache-2.0
// What a face is: fine, or to be mended, or left as it is (docs/refinement.md, A). OpenCL C only.
#ifndef GCDT_JUDGE_H
#define GCDT_JUDGE_H

#include "refine/candidates.h"

// Verdicts beyond the reasons to leave a triangle (GCDT_LEFT_...).
#define VERDICT_FINE 16u
#define VERDICT_SHARP 17u
#define VERDICT_LARGE 18u

#define JUDGE_PARAMETERS                                                                                      \
  GCDT_MESH_PARAMETERS, global const RefineRules *given_rules, volatile global uint *edge_marks, uint inputs, \
      global const uint4 *origins, global const uint2 *pieces, global const uint *sizes, global const ulong *areas

typedef struct Judge {
  Mesh mesh;
  RefineRules rules;
  volatile global uint* marks;
  Origins origins;
  global const uint2* pieces;
  global const uint* edge_pieces;  // this and the next one only for find_place
  global const uint* sharp;
  global const uint* sizes;   // by vertex, if rules.sized
  global const ulong* areas;  // by label less 1, if rules.by_label: the largest doubled areas
} Judge;

#define MAKE_JUDGE(judge)                                   \
  Judge judge;                                              \
  judge.mesh = make_mesh(n, points, face_data, edge_faces); \
  judge.rules = *given_rules;                               \
  judge.marks = edge_marks;                                 \
  judge.origins.inputs = inputs;                            \
  judge.origins.of = origins;                               \
  judge.pieces = pieces;                                    \
  judge.edge_pieces = judge.sharp = 0;                      \
  judge.sizes = sizes;                                      \
  judge.areas = areas

typedef struct Judged {
  uint verdict;
  Shape shape;
  uint4 corners;
} Judged;

// Do u and v lie on two pieces with a common end, about as far from it? (Miller, Pav and Walkington: between
// constraints that meet at a small angle such a side cannot be mended.)
static bool beside_angle(Judge judge, uint u, uint v) {
  const uint pu = piece_under(judge.origins, u), pv = piece_under(judge.origins, v);
  if (pu == GCDT_NONE || pv == GCDT_NONE || pu == pv) return false;
  const uint2 a = judge.pieces[pu], b = judge.pieces[pv];
  const uint z = a.x == b.x || a.x == b.y ? a.x : a.y == b.x || a.y == b.y ? a.y : GCDT_NONE;
  if (z == GCDT_NONE) return false;
  const Vertex end = vertex_at(judge.mesh.points, z);
  const u64 du = gcdt_square_root(gcdt_squared_length(end, vertex_at(judge.mesh.points, u))),
            dv = gcdt_square_root(gcdt_squared_length(end, vertex_at(judge.mesh.points, v)));
  const u64 most = max(du, dv), least = min(du, dv);
  return most - least <= 2u + most / 512u;
}

// Of a kept face.
static Judged judge_face(Judge judge, uint face) {
  Judged j;
  const Mesh mesh = judge.mesh;
  const uint4 c = j.corners = mesh.face_data[GCDT_CORNERS(face)], s = mesh.face_data[GCDT_SIDES(face)];
  j.shape = gcdt_shape(vertex_at(mesh.points, c.x), vertex_at(mesh.points, c.y), vertex_at(mesh.points, c.z));
  const u64 wanted = judge.rules.sized ? (u64)judge.sizes[c.x] + judge.sizes[c.y] + judge.sizes[c.z] : 0u;
  const bool sharp = gcdt_is_sharp(j.shape, judge.rules);
  const u64 most_area =
      judge.rules.by_label ? min(judge.rules.most_area, judge.areas[s.w - 1u]) : judge.rules.most_area;
  const bool large = gcdt_is_large(j.shape, most_area, judge.rules.sized, wanted);
  j.verdict = VERDICT_FINE;
  if (!sharp && !large) return j;
  uint excuse = VERDICT_FINE;
  const uint k = j.shape.corner;
  if (sharp) {
    if (is_constrained(judge.marks, element(s, next_corner(k))) &&
        is_constrained(judge.marks, element(s, previous_corner(k))))
      excuse = GCDT_LEFT_INPUT_ANGLE;
    else if (beside_angle(judge, element(c, next_corner(k)), element(c, previous_corner(k))))
      excuse = GCDT_LEFT_BESIDE_ANGLE;
  }
  const bool excused = sharp && excuse != VERDICT_FINE;
  if (excused && !large)
    j.verdict = excuse;
  else if (j.shape.shortest < judge.rules.least_squared)
    j.verdict = GCDT_LEFT_GRID;
  else
    j.verdict = sharp && !excused ? VERDICT_SHARP : VERDICT_LARGE;
  return j;
}

#endif
