// SPDX-License-Identifier: Apache-2.0
// From the triangles of a result back to the mesh that phases work on (layout: shared.h). Its triangles, which cover
// the hull, become the finite faces; around them come those with symbolic corners (predicates.h).
//
// Numbers, of T triangles and h edges of the hull. Faces: triangle t is face t; beyond hull edge j lies face T + j; the
// face between the symbols c and c + 1 (modulo 3) is T + h + c. Edges: c < 3 joins these two symbols; 3 + j leads from
// the head of hull edge j to the symbol beyond it; 3 + h + c leads from the vertex of face T + h + c to symbol c + 1;
// then come the finite ones. That is 2n + 1 faces and 3n + 3 edges, since T = 2n - 2 - h.
//
// Symbols. Symbol 0 is so far away that no circle of finite triangles reaches it, so Delaunay wants it joined to every
// edge of the hull that it sees; so is symbol 1, of the hull of all that with symbol 0, and symbol 2 gets the rest. So
// beyond an edge of the hull there is the least symbol that sees it. Going round the hull counter-clockwise, its
// normals turn once, and that symbol goes through 0, 1, 2 once: at the vertex where it leaves c, one face has c and c
// + 1.
#include "common/mesh.h"

// One work-item per half edge.
// Reads neighbours. Writes owned[i] and hull[i]. Words i have one writer.
// After this kernel the scan of `owned` numbers the finite edges, each by its half edge in the lesser triangle, and
// that of `hull` the edges of the hull.
kernel void relink_flags(const uint count, global const int* neighbours, global uint* owned, global uint* hull) {
  FOR_EACH(i, count) {
    const int across = neighbours[i];
    owned[i] = across < 0 || i / 3u < (uint)across ? 1u : 0u;
    hull[i] = across < 0 ? 1u : 0u;
  }
}

// The ends of half edge i, its triangle on the left: from x to y.
static inline uint2 ends_of(uint i, global const uint* corners, global const uint* input_vertex) {
  const uint first = i / 3u * 3u, k = i - first;
  return (uint2)(input_vertex[corners[first + next_corner(k)]], input_vertex[corners[first + previous_corner(k)]]);
}

// One work-item per edge of the hull.
// Reads its half edge, and the triangles. Writes entering[v] for the vertex v where it ends: in a convex hull one edge.
// After this kernel entering[v] is the edge of the hull that ends in v, of those in the hull.
kernel void relink_entering(const uint count, global const uint* hull, global const uint* corners,
                            global const uint* input_vertex, global uint* entering) {
  FOR_EACH(j, count) entering[ends_of(hull[j], corners, input_vertex).y] = j;
}

// One work-item per triangle.
// Reads the triangles, and `owned`, scanned. Writes its face, its words of edge_faces, the marks of the edges that it
// owns, and its reference. Each half edge has a side of its own, and each edge one owner: every word has one writer.
// Ends: three sides, and two triangles share one edge at most, so that the half edge across is found among three.
kernel void relink_faces(const uint count, const uint hull_edges, global const uint* corners,
                         global const int* neighbours, global const uchar* constrained, global const uint* input_vertex,
                         global const uint* owned, global uint4* face_data, global uint* edge_faces,
                         global uint* edge_marks, global uint* refs) {
  FOR_EACH(t, count) {
    uint sides[3];
    for (uint k = 0; k < 3u; ++k) {
      const uint i = 3u * t + k;
      const int across = neighbours[i];
      const bool owns = across < 0 || t < (uint)across;
      uint owner = i;
      if (!owns) {
        owner = 3u * (uint)across;
        if (neighbours[owner] != (int)t) owner += neighbours[owner + 1u] == (int)t ? 1u : 2u;
      }
      const uint edge = 6u + hull_edges + owned[owner];
      sides[k] = GCDT_SIDE(edge, owns ? 0u : 1u);
      edge_faces[sides[k]] = GCDT_FACE_REF(t, k);
      if (owns) edge_marks[edge] = (constrained[t] >> k) & 1u ? GCDT_MARK_CONSTRAINED : 0u;
    }
    face_data[GCDT_CORNERS(t)] = (uint4)(input_vertex[corners[3u * t]], input_vertex[corners[3u * t + 1u]],
                                         input_vertex[corners[3u * t + 2u]], 0u);
    face_data[GCDT_SIDES(t)] = (uint4)(sides[0], sides[1], sides[2], 0u);
    refs[t] = GCDT_FACE_REF(t, 0u);
  }
}

// The least symbol that sees an edge of the hull, from ends.x to ends.y, from outside. The last one sees what the
// others do not.
static inline uint symbol_beyond(global const int2* points, uint2 ends) {
  const Vertex a = vertex_at(points, ends.x), b = vertex_at(points, ends.y);
  if (gcdt_orient2d(b, a, gcdt_symbolic_vertex(0)) > 0) return 0u;
  return gcdt_orient2d(b, a, gcdt_symbolic_vertex(1)) > 0 ? 1u : 2u;
}

// One work-item per edge of the hull.
// Reads the edges and triangles of the hull, `entering`, and `owned`, scanned. Writes the face beyond it, and those
// between symbols around the vertex where it starts; their words of edge_faces; the marks of edges 3 + j, c and 3 + h +
// c for these faces.
// A face beyond an edge is that edge's, one between symbols of the vertex where the symbol changes, and their sides are
// theirs: every word has one writer. Ends: c goes round three symbols, to one of them.
kernel void relink_outside(const uint count, const uint triangles, const uint n, global const int2* points,
                           global const uint* hull, global const uint* corners, global const uint* input_vertex,
                           global const uint* owned, global const uint* entering, global uint4* face_data,
                           global uint* edge_faces, global uint* edge_marks) {
  FOR_EACH(j, count) {
    const uint2 ends = ends_of(hull[j], corners, input_vertex);
    const uint before = entering[ends.x], symbol = symbol_beyond(points, ends);
    // The last side that was met around the vertex, from the edge before it to this one.
    uint met = GCDT_SIDE(3u + before, 1u);
    for (uint c = symbol_beyond(points, ends_of(hull[before], corners, input_vertex)); c != symbol; c = (c + 1u) % 3u) {
      const uint face = triangles + count + c, spoke = 3u + count + c;
      face_data[GCDT_CORNERS(face)] = (uint4)(ends.x, n + c, n + (c + 1u) % 3u, 0u);
      face_data[GCDT_SIDES(face)] = (uint4)(GCDT_SIDE(c, 0u), GCDT_SIDE(spoke, 0u), met, 0u);
      edge_faces[GCDT_SIDE(c, 0u)] = GCDT_FACE_REF(face, 0u);
      edge_faces[GCDT_SIDE(c, 1u)] = GCDT_NONE;
      edge_faces[GCDT_SIDE(spoke, 0u)] = GCDT_FACE_REF(face, 1u);
      edge_faces[met] = GCDT_FACE_REF(face, 2u);
      edge_marks[c] = edge_marks[spoke] = 0u;
      met = GCDT_SIDE(spoke, 1u);
    }
    const uint face = triangles + j, beyond = GCDT_SIDE(6u + count + owned[hull[j]], 1u);
    face_data[GCDT_CORNERS(face)] = (uint4)(ends.y, ends.x, n + symbol, 0u);
    face_data[GCDT_SIDES(face)] = (uint4)(met, GCDT_SIDE(3u + j, 0u), beyond, 0u);
    edge_faces[met] = GCDT_FACE_REF(face, 0u);
    edge_faces[GCDT_SIDE(3u + j, 0u)] = GCDT_FACE_REF(face, 1u);
    edge_faces[beyond] = GCDT_FACE_REF(face, 2u);
    edge_marks[3u + j] = 0u;
  }
}
