// SPDX-License-Identifier: Apache-2.0
// Proves a forest's meshes: what check.cl counts in one mesh is counted in each. Its lemma holds problem by problem,
// since links and boundary chains do not lead from one to another (forest_begins sorts triangles by problem, and
// check_edges found no link to a triangle without the reversed edge).
#ifndef GCDT_FOREST
#define GCDT_FOREST
#endif
#include "check/check.h"
#include "common/forest.h"
#include "common/predicates.h"

// One work-item per vertex, after check_boundary of check.cl has noted nothing.
// Reads points and the boundary. Writes hull[p] and least[p], per problem: vertices on the boundary, and those below
//   both neighbours there.
// atomic_inc decides, in any order the same.
// After this kernel least[p] is the number of turns of problem p's boundary chains.
kernel void check_forest_boundary(uint n, global const int2* points, global const uint* next,
                                  global const uint* previous, volatile global uint* hull,
                                  volatile global uint* least) {
  FOR_EACH(v, n) {
    const uint before = previous[v], after = next[v];
    if (before == GCDT_NONE || after == GCDT_NONE) continue;
    const uint p = problem_of(points, n, v);
    const u64 here = gcdt_tie_key(vertex_at(points, v));
    atomic_inc(hull + p);
    if (here < gcdt_tie_key(vertex_at(points, before)) && here < gcdt_tie_key(vertex_at(points, after)))
      atomic_inc(least + p);
  }
}

// One work-item per problem.
// Reads its counts: triangles, pieces, vertices, hull, least corners. Writes bad[0] by atomic_min: the first problem
//   with triangles whose boundary is not one polygon, or whose triangles are not 2n - 2 - h; bad[1] by atomic_add: the
//   pieces of problems without triangles, which are no edges of any.
// After this kernel, if nothing is noted, every problem with triangles is covered once.
kernel void check_forest_counts(uint problems, uint n, global const int2* points, global const uint* first_triangle,
                                global const uint* first_piece, global const uint* hull, global const uint* least,
                                volatile global uint* bad) {
  FOR_EACH(p, problems) {
    const uint triangles = first_triangle[p + 1u] - first_triangle[p];
    const uint vertices = first_rank(points, n, p + 1u) - first_rank(points, n, p);
    if (triangles == 0u) atomic_add(bad + 1, first_piece[p + 1u] - first_piece[p]);
    if (triangles != 0u && (least[p] != 1u || triangles + 2u + hull[p] != 2u * vertices)) atomic_min(bad, p);
  }
}

// One work-item per vertex.
// Reads points and levels. Writes bad[0] by atomic_min: the first problem without triangles whose vertices are not all
//   on the line through its first two.
// After this kernel, if nothing is noted, problems have no triangles only if there are none.
kernel void check_forest_lines(uint n, global const Levels* levels, global const int2* points,
                               global const uint* first_triangle, volatile global uint* bad) {
  const uint last = levels->count - 1u;
  FOR_EACH(v, n) {
    const uint p = problem_of(points, n, v);
    if (first_triangle[p] != first_triangle[p + 1u]) continue;
    const uint rank = first_rank(points, n, p);
    if (first_rank(points, n, p + 1u) - rank < 3u) continue;
    const Vertex a = vertex_at(points, gcdt_vertex_of_rank(levels, last, rank));
    const Vertex b = vertex_at(points, gcdt_vertex_of_rank(levels, last, rank + 1u));
    if (gcdt_orient2d_finite(a, b, vertex_at(points, v)) != 0) atomic_min(bad, p);
  }
}
