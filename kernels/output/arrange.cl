// SPDX-License-Identifier: Apache-2.0
// Orders for CPUs and batches of small problems: of each problem's vertices and triangles by one work-item, while they
// are in its cache. What order_problems.cpp and output.cl do by sorting all.
//
// A forest with one level (order_problems.cpp): vertices are ranks, and those of a problem are consecutive, and so are
// their faces, while enforce.cl alone has enforced constraints. The order is that of (least corner, the corner after
// it), found by counting, the less significant first. No word has two writers: all of a problem's are its work-item's,
// which reads no others.
#ifndef GCDT_FOREST
#define GCDT_FOREST
#endif
#include "common/mesh.h"
#include "output/triangle.h"
#include "sort/sort_by_one_item.h"

// ---- Vertices ---------------------------------------------------------------------------------------

// So few keys are sorted faster by insertion.
#define ARRANGE_FEW 32u

// One work-item per problem. Sorts its keys and values by the key, below 2^64, stably: by insertion, or by
// eight digits, so that they are back in these arrays.
// Reads, writes: keys, values, other_keys, other_values, from first_input on; the other ones are void afterwards.
// A word belongs to one problem.
// After this kernel the keys of each problem ascend.
kernel void arrange_keys(uint problems, global const uint* first_input, global ulong* keys, global uint* values,
                         global ulong* other_keys, global uint* other_values) {
  FOR_EACH_DEALT(p, problems) {
    const uint begin = first_input[p], end = first_input[p + 1u];
    if (end - begin <= ARRANGE_FEW) {
      sort_run(keys, values, begin, end);
      continue;
    }
    sort_by_digits(end - begin, 64u, keys + begin, values + begin, other_keys + begin, other_values + begin);
  }
}

// ---- Triangles --------------------------------------------------------------------------------------

// The reference of a face at its least corner, GCDT_NONE if a corner is symbolic; its corners from there on.
static inline uint ref_of_face(Mesh mesh, uint t, private uint4* corners) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(t)];
  if (max(max(c.x, c.y), c.z) >= mesh.n) return GCDT_NONE;
  const uint k = least_corner(c.x, c.y, c.z);
  *corners = rotate_to(c, k);
  return GCDT_FACE_REF(t, k);
}

// Face i of a problem with vertices from `begin` on: its root, then what they bring.
static inline uint face_of_problem(Mesh mesh, uint problem, uint begin, uint i) {
  return i == 0u ? problem : new_face(mesh, begin, i - 1u);
}

// One work-item per problem. Writes how many triangles have each of its vertices as least corner, and as the one after
// that, and how many it has.
kernel void arrange_count(uint problems, GCDT_MESH_PARAMETERS, global uint* least, global uint* second,
                          global uint* triangles) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH_DEALT(p, problems) {
    const uint begin = first_rank(points, n, p), end = first_rank(points, n, p + 1u);
    const uint faces = gcdt_forest_faces(end - begin, 1u);
    for (uint v = begin; v < end; ++v) least[v] = second[v] = 0u;
    uint count = 0;
    for (uint i = 0; i < faces; ++i) {
      uint4 c;
      if (ref_of_face(mesh, face_of_problem(mesh, p, begin, i), &c) == GCDT_NONE) continue;
      ++least[c.x];
      ++second[c.y];
      ++count;
    }
    triangles[p] = count;
  }
}

// One work-item per problem. Reads the scan of what arrange_count has written of triangles. Writes positions[t] of each
// face, -1 for those with symbolic corners, and the triangles as gather_triangles of output.cl does; `least`, `second`
// and refs are void afterwards.
kernel void arrange_problems(uint problems, GCDT_MESH_PARAMETERS, global const uint* edge_marks,
                             global const uint* first_triangle, global uint* least, global uint* second,
                             global uint* refs, global uint* ordered, global int* positions, global uint* out_corners,
                             global int* out_neighbours, global uchar* out_constrained) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH_DEALT(p, problems) {
    const uint begin = first_rank(points, n, p), end = first_rank(points, n, p + 1u);
    const uint faces = gcdt_forest_faces(end - begin, 1u), first = first_triangle[p], last = first_triangle[p + 1u];
    for (uint v = begin, l = first, s = first; v < end; ++v) {
      const uint with_least = least[v], with_second = second[v];
      least[v] = l;
      second[v] = s;
      l += with_least;
      s += with_second;
    }
    for (uint i = 0; i < faces; ++i) {
      uint4 c;
      const uint t = face_of_problem(mesh, p, begin, i), ref = ref_of_face(mesh, t, &c);
      if (ref == GCDT_NONE)
        positions[t] = -1;
      else
        refs[second[c.y]++] = ref;
    }
    for (uint i = first; i < last; ++i) {
      const uint t = GCDT_REF_FACE(refs[i]);
      const uint at = least[element(face_data[GCDT_CORNERS(t)], GCDT_REF_CORNER(refs[i]))]++;
      ordered[at] = refs[i];
      positions[t] = (int)at;
    }
    for (uint i = first; i < last; ++i)
      gather_triangle(i, face_data, edge_faces, edge_marks, ordered, positions, out_corners, out_neighbours,
                      out_constrained);
  }
}
