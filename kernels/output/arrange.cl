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
  const Items mine = problems_of_this(problems, first_input);
  FOR_ITEMS(p, mine) {
    const uint begin = first_input[p], end = first_input[p + 1u];
    if (end - begin <= ARRANGE_FEW) {
      sort_run(keys, values, begin, end);
      continue;
    }
    sort_by_digits(end - begin, 0u, 64u, keys + begin, values + begin, other_keys + begin, other_values + begin);
  }
}

// ---- Triangles --------------------------------------------------------------------------------------

// Face i of a problem with vertices from `begin` on: its root, then what they bring.
static inline uint face_of_problem(Mesh mesh, uint problem, uint begin, uint i) {
  return i == 0u ? problem : new_face(mesh, begin, i - 1u);
}

// One work-item per problem. Writes how many triangles it has.
kernel void arrange_count(uint problems, GCDT_MESH_PARAMETERS, global uint* triangles) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Items mine = problems_of_this(problems, first_ranks(points, n));
  FOR_ITEMS(p, mine) {
    const uint begin = first_rank(points, n, p), end = first_rank(points, n, p + 1u);
    const uint faces = gcdt_forest_faces(end - begin, 1u);
    uint count = 0;
    for (uint i = 0; i < faces; ++i) {
      const uint4 c = mesh.face_data[GCDT_CORNERS(face_of_problem(mesh, p, begin, i))];
      count += max(max(c.x, c.y), c.z) < n ? 1u : 0u;
    }
    triangles[p] = count;
  }
}

// One work-item per problem. Reads the scan of what arrange_count has written. Writes positions[t] of each face, -1 for
// those with symbolic corners, and the triangles as gather_triangles of output.cl does; least, second and refs are void
// afterwards.
kernel void arrange_problems(uint problems, GCDT_MESH_PARAMETERS, global const uint* edge_marks,
                             global const uint* first_triangle, global uint* least, global uint* second,
                             global uint* refs, global uint* ordered, global int* positions, global uint* out_corners,
                             global int* out_neighbours, global uchar* out_constrained) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Items mine = problems_of_this(problems, first_ranks(points, n));
  FOR_ITEMS(p, mine) {
    const uint begin = first_rank(points, n, p), end = first_rank(points, n, p + 1u);
    const uint faces = gcdt_forest_faces(end - begin, 1u), first = first_triangle[p], last = first_triangle[p + 1u];
    for (uint v = begin; v < end; ++v) least[v] = second[v] = 0u;
    // Triangles as they come, and how many have each vertex as least corner, and as the one after that. One face in
    // four has a symbolic corner here or there, and no branch foretells which: it is written, too, where the next
    // triangle will be, and counts nothing. Its least corner is a vertex, as only a problem's root has none.
    uint i = 0;
    for (uint at = first; at < last; ++i) {
      const uint t = face_of_problem(mesh, p, begin, i);
      const uint4 c = mesh.face_data[GCDT_CORNERS(t)];
      const uint k = least_corner(c.x, c.y, c.z), x = element(c, k);
      const uint counts = max(max(c.x, c.y), c.z) < n ? 1u : 0u;
      positions[t] = -1;
      ordered[at] = GCDT_FACE_REF(t, k);
      at += counts;
      least[x] += counts;
      second[counts ? element(c, next_corner(k)) : x] += counts;
    }
    for (; i < faces; ++i) positions[face_of_problem(mesh, p, begin, i)] = -1;
    for (uint v = begin, l = first, s = first; v < end; ++v) {
      const uint with_least = least[v], with_second = second[v];
      least[v] = l;
      second[v] = s;
      l += with_least;
      s += with_second;
    }
    for (uint i = first; i < last; ++i) {
      const uint ref = ordered[i];
      refs[second[element(face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))], next_corner(GCDT_REF_CORNER(ref)))]++] = ref;
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
