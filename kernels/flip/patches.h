// SPDX-License-Identifier: Apache-2.0
// Flips within patches of the mesh: a work-group takes the faces of a small span into local memory, does whole rounds
// among them there, and puts them back. OpenCL C, and for the host the sizes.
//
// An edge is flipped here if its number and both its faces are the patch's. All others are left in the queue of the
// whole mesh, by the patch that has their number.
//
// Places have 16 bits. A vertex of other patches at a corner of the patch's faces has an entry in a hash table, and a
// side of an edge of other patches its code in a list. A face for which one of these has no room is nobody's in this
// launch; where most will have none, since the vertices stand in lines and their faces lead to other lines, the patch
// leaves all its edges to others.
#ifndef GCDT_PATCHES_H
#define GCDT_PATCHES_H

#include "flip/span.h"

// Local memory of a patch with room for so many vertices and so many others, in words: its span; counts; coordinates of
// all vertices, numbers of the others; others' sides; corners and sides of its faces and faces of its edges' sides,
// half a word each; the list of places of edges; bits of its edges, and of its faces.
#define GCDT_PATCH_X (GCDT_SPAN_WORDS + 3u)
#define GCDT_PATCH_Y(room, others) (GCDT_PATCH_X + (room) + (others))
#define GCDT_PATCH_NUMBERS(room, others) (GCDT_PATCH_Y(room, others) + (room) + (others))
#define GCDT_PATCH_CODES(room, others) (GCDT_PATCH_NUMBERS(room, others) + (others))
#define GCDT_PATCH_CORNERS(room, others) (GCDT_PATCH_CODES(room, others) + (others))
#define GCDT_PATCH_SIDES(room, others) (GCDT_PATCH_CORNERS(room, others) + 3u * (room))
#define GCDT_PATCH_REFS(room, others) (GCDT_PATCH_SIDES(room, others) + 3u * (room))
#define GCDT_PATCH_LIST(room, others) (GCDT_PATCH_REFS(room, others) + 3u * (room))
#define GCDT_PATCH_QUEUED(room, others) (GCDT_PATCH_LIST(room, others) + (3u * (room) + 1u) / 2u)
#define GCDT_PATCH_FIXED(room, others) (GCDT_PATCH_QUEUED(room, others) + GCDT_BIT_WORDS(3u * (room)))
#define GCDT_PATCH_TAKEN(room, others) (GCDT_PATCH_FIXED(room, others) + GCDT_BIT_WORDS(3u * (room)))
#define GCDT_PATCH_TOUCHED(room, others) (GCDT_PATCH_TAKEN(room, others) + GCDT_BIT_WORDS(2u * (room)))
#define GCDT_PATCH_WORDS(room, others) (GCDT_PATCH_TOUCHED(room, others) + GCDT_BIT_WORDS(2u * (room)))
// Places have 16 bits: those of a face's corners need two more than the face's, and two values mean something else.
#define GCDT_MOST_PATCH_ROOM 4095u

#ifdef __OPENCL_VERSION__

// Entries of the hash table that a vertex may be at.
#define PATCH_PROBES 16u
// Vertices of the finest level that tell whether there is room for the faces of all.
#define PATCH_SAMPLE 256u
// No place.
#define PATCH_NONE 0xFFFFu
// A side of another patch's edge: this, and its place in the list of their codes.
#define PATCH_OTHERS_SIDE 0x8000u
// Of an edge in the list of tests: it has both its faces.
#define PATCH_WON 0x8000u

typedef struct Patch {
  Span span;
  uint room, others;                                         // others: a power of two
  volatile local uint *listed, *others_kept, *others_sides;  // edges of the list, entries of the table, codes
  local int *x, *y;                                          // of places, then of the others' entries
  volatile local uint* numbers;
  local uint* codes;
  // By 3 * face + corner: a vertex; a side, 2 * edge + side or another patch's. By 2 * edge + side: 4 * face + corner.
  local ushort *corners, *sides, *refs;
  local ushort* list;  // of edges to be tested
  // Bits of edges: to be tested, or not to be flipped here; the latter. Of faces: an edge has it; one has flipped it.
  volatile local uint *queued, *fixed, *taken, *touched;
} Patch;

// Called by the whole group. The patch of a span, with lists and bits that are empty.
GCDT_GIVEN_LOCAL Patch make_patch(Span span, local uint* memory, uint room, uint others) {
  Patch p;
  p.span = span;
  p.room = room, p.others = others;
  p.listed = memory + GCDT_SPAN_WORDS, p.others_kept = p.listed + 1, p.others_sides = p.listed + 2;
  p.x = (local int*)(memory + GCDT_PATCH_X), p.y = (local int*)(memory + GCDT_PATCH_Y(room, others));
  p.numbers = memory + GCDT_PATCH_NUMBERS(room, others);
  p.codes = memory + GCDT_PATCH_CODES(room, others);
  p.corners = (local ushort*)(memory + GCDT_PATCH_CORNERS(room, others));
  p.sides = (local ushort*)(memory + GCDT_PATCH_SIDES(room, others));
  p.refs = (local ushort*)(memory + GCDT_PATCH_REFS(room, others));
  p.list = (local ushort*)(memory + GCDT_PATCH_LIST(room, others));
  p.queued = memory + GCDT_PATCH_QUEUED(room, others);
  p.fixed = memory + GCDT_PATCH_FIXED(room, others);
  p.taken = memory + GCDT_PATCH_TAKEN(room, others);
  p.touched = memory + GCDT_PATCH_TOUCHED(room, others);
  FOR_ALL_TILES(tile, max(others, GCDT_BIT_WORDS(3u * room))) {
    const uint i = tile + get_local_id(0);
    if (i < others) p.numbers[i] = GCDT_NONE;
    if (i < GCDT_BIT_WORDS(3u * room)) p.fixed[i] = p.queued[i] = 0u;
    if (i < GCDT_BIT_WORDS(2u * room)) p.touched[i] = 0u;
  }
  if (get_local_id(0) == 0) *p.listed = *p.others_kept = *p.others_sides = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  return p;
}

// ---- The patch in local memory ---------------------------------------------------------------------

GCDT_GIVEN_LOCAL void keep_point(Patch p, Mesh mesh, uint vertex, uint place) {
  const int2 at = mesh.points[vertex];
  p.x[place] = at.x, p.y[place] = at.y;
}

// Where vertex v of a face stands: at its place, or behind them at its entry of the table, which whoever takes it first
// fills. GCDT_NONE if there is no room. Ends: after so many probes.
GCDT_GIVEN_LOCAL uint keep_vertex(Patch p, Mesh mesh, uint v) {
  const uint place = place_of_vertex(p.span, v);
  if (place != GCDT_NONE) return place;
  uint entry = (v * 0x9E3779B1u >> 16) & (p.others - 1u);
  for (uint probe = 0; probe < PATCH_PROBES; ++probe, entry = (entry + 1u) & (p.others - 1u)) {
    const uint seen = atomic_cmpxchg(p.numbers + entry, GCDT_NONE, v);
    if (seen == v) return p.room + entry;
    if (seen != GCDT_NONE) continue;
    if (v < mesh.n) keep_point(p, mesh, v, p.room + entry);
    atomic_inc(p.others_kept);
    return p.room + entry;
  }
  return GCDT_NONE;
}

// The side with this code. GCDT_NONE if it is another patch's and there is no room.
GCDT_GIVEN_LOCAL uint keep_side(Patch p, Mesh mesh, uint code) {
  const uint place = place_of_edge(p.span, mesh, GCDT_SIDE_EDGE(code));
  if (place != GCDT_NONE) return 2u * place + (code & 1u);
  const uint i = atomic_inc(p.others_sides);
  if (i >= p.others) return GCDT_NONE;
  p.codes[i] = code;
  return PATCH_OTHERS_SIDE | i;
}

// Keeps the face with this place, corners and sides. Its first corner is PATCH_NONE if there is no room for all of it.
GCDT_GIVEN_LOCAL void keep_face(Patch p, Mesh mesh, uint place, uint4 c, uint4 s) {
  const uint c0 = keep_vertex(p, mesh, c.x), c1 = keep_vertex(p, mesh, c.y), c2 = keep_vertex(p, mesh, c.z);
  const uint s0 = keep_side(p, mesh, s.x), s1 = keep_side(p, mesh, s.y), s2 = keep_side(p, mesh, s.z);
  const bool whole =
      c0 != GCDT_NONE && c1 != GCDT_NONE && c2 != GCDT_NONE && s0 != GCDT_NONE && s1 != GCDT_NONE && s2 != GCDT_NONE;
  local ushort *corners = p.corners + 3u * place, *sides = p.sides + 3u * place;
  corners[0] = (ushort)(whole ? c0 : PATCH_NONE), corners[1] = (ushort)c1, corners[2] = (ushort)c2;
  sides[0] = (ushort)s0, sides[1] = (ushort)s1, sides[2] = (ushort)s2;
}

// Takes the point and the faces of the vertex with this place into local memory. All is asked for at once.
GCDT_GIVEN_LOCAL void take_faces(Patch p, Mesh mesh, uint place) {
  const uint v = vertex_at_place(p.span, place);
  global const uint4* faces = mesh.face_data + GCDT_CORNERS(new_face(mesh, v, 0u));
  const uint4 c0 = faces[0], s0 = faces[1], c1 = faces[2], s1 = faces[3];
  keep_point(p, mesh, v, place);
  keep_face(p, mesh, 2u * place, c0, s0);
  keep_face(p, mesh, 2u * place + 1u, c1, s1);
}

// Called by the whole group. Takes the points and faces of the vertices with places from begin up to end.
GCDT_GIVEN_LOCAL void take_all_faces(Patch p, Mesh mesh, uint begin, uint end) {
  FOR_ALL_TILES(tile, end - begin) {
    if (tile + get_local_id(0) < end - begin) take_faces(p, mesh, begin + tile + get_local_id(0));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

GCDT_GIVEN_LOCAL bool is_whole(Patch p, uint face) { return p.corners[3u * face] != PATCH_NONE; }

GCDT_GIVEN_LOCAL uint keep_ref(Patch p, Mesh mesh, uint ref) {
  if (ref == GCDT_NONE) return PATCH_NONE;
  const uint face = place_of_face(p.span, mesh, GCDT_REF_FACE(ref));
  return face != GCDT_NONE && is_whole(p, face) ? GCDT_FACE_REF(face, GCDT_REF_CORNER(ref)) : PATCH_NONE;
}

// Keeps the edge with this place, e of the mesh, and sets its bits: it is to be tested, or is not flipped here and
// stands in the queue of the whole mesh if others may flip it.
GCDT_GIVEN_LOCAL void keep_edge(Patch p, Mesh mesh, global uint* edge_marks, uint place, uint e, uint2 refs,
                                uint marks) {
  const uint near = keep_ref(p, mesh, refs.x), far = keep_ref(p, mesh, refs.y);
  p.refs[2u * place] = (ushort)near, p.refs[2u * place + 1u] = (ushort)far;
  const bool constrained = (marks & GCDT_MARK_CONSTRAINED) != 0u, own = near != PATCH_NONE && far != PATCH_NONE;
  const bool left = !constrained && !own && refs.x != GCDT_NONE && refs.y != GCDT_NONE;
  if (left != ((marks & GCDT_MARK_QUEUED) != 0u)) edge_marks[e] = marks ^ GCDT_MARK_QUEUED;
  set_bit(p.queued, place);
  if (!own || constrained) set_bit(p.fixed, place);
}

// Takes the edges of the vertex with this place into local memory, after all faces.
GCDT_GIVEN_LOCAL void take_edges(Patch p, Mesh mesh, global uint* edge_marks, uint place) {
  const uint e = new_edge(mesh, vertex_at_place(p.span, place), 0u);
  global const uint2* refs = (global const uint2*)mesh.edge_faces + e;
  const uint2 r0 = refs[0], r1 = refs[1], r2 = refs[2];
  const uint m0 = edge_marks[e], m1 = edge_marks[e + 1u], m2 = edge_marks[e + 2u];
  keep_edge(p, mesh, edge_marks, 3u * place, e, r0, m0);
  keep_edge(p, mesh, edge_marks, 3u * place + 1u, e + 1u, r1, m1);
  keep_edge(p, mesh, edge_marks, 3u * place + 2u, e + 2u, r2, m2);
}

GCDT_GIVEN_LOCAL uint number_of_vertex(Patch p, uint kept) {
  return kept < p.room ? vertex_at_place(p.span, kept) : p.numbers[kept - p.room];
}

// Corner k of the face with this place: puts its side's face back, and returns the side's code.
GCDT_GIVEN_LOCAL uint put_side(Patch p, Mesh mesh, uint place, uint face, uint k) {
  const uint side = p.sides[3u * place + k];
  if (side < PATCH_OTHERS_SIDE) return GCDT_SIDE(edge_at_place(p.span, mesh, side / 2u), side % 2u);
  const uint code = p.codes[side - PATCH_OTHERS_SIDE];
  mesh.edge_faces[code] = GCDT_FACE_REF(face, k);
  return code;
}

// Puts the face with this place back, if it has been flipped. The claim word becomes 0, which is nobody's ticket, and
// the word beside the sides is 0 wherever edges are flipped.
GCDT_GIVEN_LOCAL void put_face(Patch p, Mesh mesh, uint place) {
  if (!is_set(p.touched, place)) return;
  const uint face = face_at_place(p.span, mesh, place);
  local const ushort* corners = p.corners + 3u * place;
  mesh.face_data[GCDT_CORNERS(face)] =
      (uint4)(number_of_vertex(p, corners[0]), number_of_vertex(p, corners[1]), number_of_vertex(p, corners[2]), 0u);
  mesh.face_data[GCDT_SIDES(face)] = (uint4)(put_side(p, mesh, place, face, 0u), put_side(p, mesh, place, face, 1u),
                                             put_side(p, mesh, place, face, 2u), 0u);
}

GCDT_GIVEN_LOCAL bool is_touched(Patch p, uint ref) {
  return ref != PATCH_NONE && is_set(p.touched, GCDT_REF_FACE(ref));
}

// Puts the edge with this place back: those of its sides whose faces have been flipped. If it is still to be tested, it
// stands in the queue of the whole mesh.
GCDT_GIVEN_LOCAL void put_edge(Patch p, Mesh mesh, global uint* edge_marks, uint place) {
  const uint e = edge_at_place(p.span, mesh, place), near = p.refs[2u * place], far = p.refs[2u * place + 1u];
  const bool puts_near = is_touched(p, near), puts_far = is_touched(p, far);
  if (is_set(p.queued, place) && !is_set(p.fixed, place)) edge_marks[e] = GCDT_MARK_QUEUED;
  if (!puts_near && !puts_far) return;
  const uint2 refs = (uint2)(GCDT_FACE_REF(face_at_place(p.span, mesh, GCDT_REF_FACE(near)), GCDT_REF_CORNER(near)),
                             GCDT_FACE_REF(face_at_place(p.span, mesh, GCDT_REF_FACE(far)), GCDT_REF_CORNER(far)));
  if (puts_near && puts_far)
    ((global uint2*)mesh.edge_faces)[e] = refs;
  else
    mesh.edge_faces[2u * e + (puts_near ? 0u : 1u)] = puts_near ? refs.x : refs.y;
}

// ---- Rounds ----------------------------------------------------------------------------------------

// Lists those of eight edges that are to be tested, and takes their bits. Ends: a bit goes in each step.
GCDT_GIVEN_LOCAL void list_queued(Patch p, uint eight) {
  const uint word = eight / 4u, mask = 0xFFu << (eight % 4u * 8u), fixed = p.fixed[word];
  if ((p.queued[word] & ~fixed & mask) == 0u) return;
  uint bits = atomic_and(p.queued + word, fixed | ~mask) & ~fixed & mask;
  uint at = atomic_add(p.listed, popcount(bits));
  for (; bits != 0u; bits &= bits - 1u) p.list[at++] = (ushort)(32u * word + 31u - clz(bits & (0u - bits)));
}

GCDT_GIVEN_LOCAL Vertex vertex_of_patch(Patch p, Mesh mesh, uint kept) {
  if (kept >= p.room && p.numbers[kept - p.room] >= mesh.n)
    return gcdt_symbolic_vertex((int)symbol_of(p.numbers[kept - p.room], mesh.n));
  return gcdt_finite_vertex(p.x[kept], p.y[kept]);
}

// 4 * face + corner: where the corner stands among three of each face.
static inline uint corner_of_ref(uint ref) { return ref - ref / 4u; }

GCDT_GIVEN_LOCAL bool is_illegal_in_patch(Patch p, Mesh mesh, uint near, uint far) {
  const uint t = 3u * GCDT_REF_FACE(near), b = GCDT_REF_CORNER(near);
  return gcdt_must_flip(
      vertex_of_patch(p, mesh, p.corners[t + previous_corner(b)]), vertex_of_patch(p, mesh, p.corners[t + b]),
      vertex_of_patch(p, mesh, p.corners[t + next_corner(b)]), vertex_of_patch(p, mesh, p.corners[corner_of_ref(far)]));
}

// Flips the edge with this place, as flip.h shows, and queues the edges around it. What leads to another patch's edge
// is left to others: that patch has left the edge in the queue of the whole mesh.
GCDT_GIVEN_LOCAL void flip_in_patch(Patch p, uint place) {
  const uint near = p.refs[2u * place], far = p.refs[2u * place + 1u];
  const uint b = GCDT_REF_CORNER(near), d = GCDT_REF_CORNER(far);
  const uint x = next_corner(b), y_of_u = next_corner(d), t = GCDT_REF_FACE(near), u = GCDT_REF_FACE(far);
  local ushort *ct = p.corners + 3u * t, *cu = p.corners + 3u * u, *st = p.sides + 3u * t, *su = p.sides + 3u * u;
  const uint ex = st[x], fy = su[y_of_u], ey = st[previous_corner(b)], fx = su[previous_corner(d)];
  ct[previous_corner(b)] = cu[d];
  cu[previous_corner(d)] = ct[b];
  st[b] = (ushort)fy;
  st[x] = (ushort)(2u * place);
  su[d] = (ushort)ex;
  su[y_of_u] = (ushort)(2u * place + 1u);
  p.refs[2u * place] = (ushort)GCDT_FACE_REF(t, x);
  p.refs[2u * place + 1u] = (ushort)GCDT_FACE_REF(u, y_of_u);
  set_bit(p.touched, t);
  set_bit(p.touched, u);
  if (fy < PATCH_OTHERS_SIDE) p.refs[fy] = (ushort)GCDT_FACE_REF(t, b);
  if (ex < PATCH_OTHERS_SIDE) p.refs[ex] = (ushort)GCDT_FACE_REF(u, d);
  if (fy < PATCH_OTHERS_SIDE) set_bit(p.queued, fy / 2u);
  if (ey < PATCH_OTHERS_SIDE) set_bit(p.queued, ey / 2u);
  if (ex < PATCH_OTHERS_SIDE) set_bit(p.queued, ex / 2u);
  if (fx < PATCH_OTHERS_SIDE) set_bit(p.queued, fx / 2u);
}

// Called by the whole group. Up to `most` rounds among the patch's `vertices` vertices, adding to `flips`. Returns how
// many rounds were done. Ends: after `most`.
GCDT_GIVEN_LOCAL uint rounds_of_patch(Patch p, Mesh mesh, uint vertices, uint most, private uint* flips) {
  const uint edges = 3u * vertices;
  uint round = 0;
  for (; round < most; ++round) {
    FOR_ALL_TILES(tile, (edges + 7u) / 8u) {
      const uint i = tile + get_local_id(0);
      if (8u * i < edges) list_queued(p, i);
      if (32u * i < 2u * vertices) p.taken[i] = 0u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint count = *p.listed;
    if (count == 0u) break;
    FOR_ALL_TILES(tile, count) {
      const uint i = tile + get_local_id(0);
      if (i >= count) continue;
      const uint place = p.list[i], near = p.refs[2u * place], far = p.refs[2u * place + 1u];
      if (!is_illegal_in_patch(p, mesh, near, far)) continue;
      if (take_both(p.taken, GCDT_REF_FACE(near), GCDT_REF_FACE(far)))
        p.list[i] = (ushort)(place | PATCH_WON);
      else
        set_bit(p.queued, place);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) *p.listed = 0u;
    FOR_ALL_TILES(tile, count) {
      const uint i = tile + get_local_id(0);
      if (i >= count || !(p.list[i] & PATCH_WON)) continue;
      flip_in_patch(p, p.list[i] & ~PATCH_WON);
      ++*flips;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  return round;
}

#endif  // __OPENCL_VERSION__

#endif
