// SPDX-License-Identifier: Apache-2.0
// Canonical order: finite triangles rotated to their vertex of least rank and sorted by the ranks of
// their first two corners. Ranks follow the Z-order curve, so the order depends on coordinates only.
#include "common/levels.h"
#include "common/prefetch.h"
#include "output/triangle.h"

// Writes the key and the reference of face f. Returns whether its corners are finite.
static bool key_face(uint f, global const Levels* levels, uint bits, global const uint4* face_data, global ulong* keys,
                     global uint* refs) {
  const uint4 c = face_data[GCDT_CORNERS(f)];
  const bool finite = max(max(c.x, c.y), c.z) < levels->n;
  ulong key = ((ulong)1 << (2u * bits)) - 1u;
  uint first = 0;
  if (finite) {
    const uint4 ranks = (uint4)(gcdt_rank_of_vertex(levels, c.x), gcdt_rank_of_vertex(levels, c.y),
                                gcdt_rank_of_vertex(levels, c.z), 0u);
    first = least_corner(ranks.x, ranks.y, ranks.z);
    const uint4 r = rotate_to(ranks, first);
    key = ((ulong)r.x << bits) | r.y;
  }
  keys[f] = key;
  refs[f] = GCDT_FACE_REF(f, first);
  return finite;
}

// The same of all `items`. Returns how many have finite corners.
GCDT_APART uint key_faces_among(Items items, global const Levels* levels, uint bits, global const uint4* face_data,
                                global ulong* keys, global uint* refs) {
  uint finite = 0;
  FOR_ITEMS(f, items)
  if (key_face(f, levels, bits, face_data, keys, refs)) ++finite;
  return finite;
}

// One work-item per face.
// Reads levels and corners.
// Writes keys[f] and refs[f] for face f; adds to *triangles.
// Words f have one writer; *triangles is a sum made by atomic_add, whose order cannot matter.
// After this kernel refs[f] is the reference of face f's first corner, and its key is (rank of the first
// corner, rank of the second), `bits` bits each. Every directed edge is in one face, so these keys are
// distinct. A face with a symbolic corner has the key of all ones, above every other: a rank is at most
// n - 1 < 2^bits - 1.
kernel void key_faces(const uint count, global const Levels* levels, const uint bits, global const uint4* face_data,
                      global ulong* keys, global uint* refs, global uint* triangles) {
  const uint finite = key_faces_among(items_of_this(count), levels, bits, face_data, keys, refs);
  if (finite != 0) atomic_add(triangles, finite);
}

// One work-item per triangle, in canonical order.
// Reads refs: every finite face once. Writes positions[f] for the face of refs[i]; those of others are -1.
// Every finite face stands in refs once: every word has one writer.
// After this kernel positions[f] is the number of face f in canonical order, -1 for symbolic faces.
kernel void place_faces(const uint count, global const uint* refs, global int* positions) {
  FOR_EACH(i, count) positions[GCDT_REF_FACE(refs[i])] = (int)i;
}

// What triangles after the i-th of a share that ends before `end` will ask for: the face, and then the edges of its
// sides.
static inline void prefetch_triangle(uint i, uint end, global const uint4* face_data, global const uint* edge_faces,
                                     global const uint* edge_marks, global const uint* refs) {
#ifdef GCDT_PREFETCHES
  if (i + 2u * GCDT_FAR_AHEAD < end)
    GCDT_PREFETCH(face_data + GCDT_CORNERS(GCDT_REF_FACE(refs[i + 2u * GCDT_FAR_AHEAD])));
  if (i + GCDT_FAR_AHEAD >= end) return;
  const uint4 s = face_data[GCDT_SIDES(GCDT_REF_FACE(refs[i + GCDT_FAR_AHEAD]))];
  for (uint k = 0; k < 3u; ++k) {
    GCDT_PREFETCH(edge_faces + (element(s, k) ^ 1u));
    GCDT_PREFETCH(edge_marks + GCDT_SIDE_EDGE(element(s, k)));
  }
#else
  (void)i;
  (void)end;
  (void)face_data;
  (void)edge_faces;
  (void)edge_marks;
  (void)refs;
#endif
}

// One work-item per triangle, in canonical order.
// Reads the mesh, refs and positions.
// Writes the triangle's corners, neighbours and constrained flags.
// Words 3i .. 3i+2 and byte i have one writer.
// After this kernel corner 0 has the least rank, neighbour k is across from corner k, -1 where the face
// across is symbolic, and bit k of constrained tells of the same edge.
kernel void gather_triangles(const uint count, global const uint4* face_data, global const uint* edge_faces,
                             global const uint* edge_marks, global const uint* refs, global const int* positions,
                             global uint* out_corners, global int* out_neighbours, global uchar* out_constrained) {
  const Items items = items_of_this(count);
  FOR_ITEMS(i, items) {
    prefetch_triangle(i, items.y, face_data, edge_faces, edge_marks, refs);
    gather_triangle(i, face_data, edge_faces, edge_marks, refs, positions, out_corners, out_neighbours,
                    out_constrained);
  }
}

static inline void number_corner(uint i, global const uint* vertex_input, global uint* corners) {
  corners[i] = vertex_input[corners[i]];
}

// One work-item per corner.
// Reads vertex_input.
// Writes corners[i], the word that it replaces.
// Word i has one reader and writer.
// After this kernel corners are the representatives' input numbers.
kernel void number_corners(const uint count, global const uint* vertex_input, global uint* corners) {
  FOR_EACH(i, count) number_corner(i, vertex_input, corners);
}

static inline void number_representative(uint i, global const uint* vertex_input, global const uint* input_vertex,
                                         global uint* representatives) {
  representatives[i] = vertex_input[input_vertex[i]];
}

// One work-item per input point.
// Reads vertex_input and input_vertex, if there are fewer vertices than points; else all points are distinct.
// Writes representatives[i].
// Word i has one writer.
// After this kernel representatives[i] is the input number that stands for input point i.
kernel void number_representatives(const uint count, const uint vertices, global const uint* vertex_input,
                                   global const uint* input_vertex, global uint* representatives) {
  FOR_EACH(i, count) {
    if (vertices == count)
      representatives[i] = i;
    else
      number_representative(i, vertex_input, input_vertex, representatives);
  }
}
