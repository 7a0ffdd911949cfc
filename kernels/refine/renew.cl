// SPDX-License-Identifier: Apache-2.0
// Quality refinement: before the first round and after the last. The mesh gets room for more vertices, labels and
// subsegments; then its vertices are numbered anew, and its subsegments become pieces.
#include "common/pieces.h"
#include "refine/candidates.h"

// ---- Before -----------------------------------------------------------------------------------------------

// One work-item per face. Symbolic vertices, so far from `from` on, are numbered from `to` on. With `clears` no face is
// kept. No race: its own words.
kernel void refine_room(uint faces, uint from, uint to, uint clears, global uint4* face_data) {
  FOR_EACH(t, faces) {
    const uint4 c = face_data[GCDT_CORNERS(t)];
    face_data[GCDT_CORNERS(t)] = (uint4)(c.x < from ? c.x : c.x - from + to, c.y < from ? c.y : c.y - from + to,
                                         c.z < from ? c.z : c.z - from + to, c.w);
    if (clears) face_data[GCDT_SIDES(t)].w = 0u;
  }
}

// One work-item per finite face; `refs` has them in an order, and kept[i] is the place of the i-th among those of the
// domain, or -1; with `all` it is i. Writes the label of each that is kept: 1 + its place. (A region has the labels of
// all its triangles.) No race: its own word.
kernel void refine_label(uint count, uint all, global const uint* refs, global const int* kept,
                         global uint4* face_data) {
  FOR_EACH(i, count) {
    const int place = all ? (int)i : kept[i];
    if (place >= 0) face_data[GCDT_SIDES(GCDT_REF_FACE(refs[i]))].w = (uint)place + 1u;
  }
}

// The ends of an edge that has a finite face; returns how many of its faces are finite, and in `kept` how many have a
// label.
static inline uint finite_faces(Mesh mesh, uint e, uint2* ends, uint* kept) {
  uint finite = 0;
  *kept = 0u;
  for (uint side = 0; side < 2u; ++side) {
    const uint ref = mesh.edge_faces[2u * e + side];
    if (ref == GCDT_NONE) continue;
    const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
    if (max(max(c.x, c.y), c.z) >= mesh.n) continue;
    ++finite;
    if (label_of(mesh, GCDT_REF_FACE(ref)) != 0u) ++*kept;
    *ends = (uint2)(element(c, next_corner(GCDT_REF_CORNER(ref))), element(c, previous_corner(GCDT_REF_CORNER(ref))));
  }
  return finite;
}

// What kernels that find subsegments count.
#define SUBSEGMENTS_OWN 0u     // edges that are pieces of their own
#define SUBSEGMENTS_FAILED 1u  // constrained edges that are no piece

// One work-item per edge. Writes its piece; an edge of the hull that is on none becomes one of its own, from place
// `count` on. With `adopted` so does an edge between a kept face and another, and marks are made anew: of the edges
// that are on a piece. No race: its own words, and places that an atomic gives; which edge has which place does not
// matter.
kernel void refine_subsegments(uint edges, uint count, uint adopted, GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS,
                               global uint* edge_marks, global uint2* pieces, global uint* edge_pieces,
                               volatile global uint* counts) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(e, edges) {
    uint2 ends = (uint2)(0u, 0u);
    uint kept, piece = GCDT_NONE;
    const uint finite = finite_faces(mesh, e, &ends, &kept);
    const bool marked = (edge_marks[e] & GCDT_MARK_CONSTRAINED) != 0u;
    if (finite > 0u && (marked || adopted)) piece = find_piece(levels, count, pieces, ends.x, ends.y);
    if (marked && !adopted) {
      if (piece == GCDT_NONE) atomic_inc(counts + SUBSEGMENTS_FAILED);
    } else if (piece == GCDT_NONE && (finite == 1u || (adopted && finite == 2u && kept == 1u))) {
      piece = count + atomic_inc(counts + SUBSEGMENTS_OWN);
      pieces[piece] = ends;
    }
    if (adopted) edge_marks[e] &= ~GCDT_MARK_CONSTRAINED;
    if (piece != GCDT_NONE) edge_marks[e] |= GCDT_MARK_CONSTRAINED;
    edge_pieces[e] = piece;
  }
}

// One work-item per edge of a mesh that was refined before. Writes the piece of the link that it is, of `count` ones,
// and constrains it if there is one. No race: its own words.
kernel void refine_links(uint edges, uint count, GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS,
                         global uint* edge_marks, global const uint2* links, global const uint* link_pieces,
                         global uint* edge_pieces, volatile global uint* counts) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(e, edges) {
    uint2 ends = (uint2)(0u, 0u);
    uint kept;
    const uint link =
        finite_faces(mesh, e, &ends, &kept) > 0u ? find_piece(levels, count, links, ends.x, ends.y) : GCDT_NONE;
    if (link != GCDT_NONE)
      edge_marks[e] |= GCDT_MARK_CONSTRAINED;
    else if (edge_marks[e] & GCDT_MARK_CONSTRAINED)
      atomic_inc(counts + SUBSEGMENTS_FAILED);
    edge_pieces[e] = link != GCDT_NONE ? link_pieces[link] : GCDT_NONE;
  }
}

// One work-item per link. Writes the piece of that end which is farther along it, if that is not the piece's own end:
// to origins[v].w. No race: places on a piece ascend along its links, so each vertex on it is the farther end of one.
kernel void refine_standing(uint count, global const int2* points, global const uint2* links,
                            global const uint* link_pieces, global const uint2* pieces, global uint4* origins) {
  FOR_EACH(i, count) {
    const uint2 link = links[i], ends = pieces[link_pieces[i]];
    const Piece piece = gcdt_piece(vertex_at(points, ends.x), vertex_at(points, ends.y));
    const i64 kx = gcdt_place_of(piece, vertex_at(points, link.x)),
              ky = gcdt_place_of(piece, vertex_at(points, link.y));
    const uint v = kx > ky ? link.x : link.y;
    if (v != ends.x && v != ends.y) origins[v].w = link_pieces[i];
  }
}

// 0 where a vertex was put on the piece.
static inline uint end_bit(uint2 ends, uint v) { return ends.x == v ? 1u : ends.y == v ? 2u : 0u; }

// One work-item per edge. From a subsegment, at the first end as either face has it, turns counter-clockwise over kept
// faces to the next one. If that is at less than 60 degrees, both pieces get the bit of that end in `sharp` by
// atomic_or. Ends: at 60 degrees, or where faces are not kept; the limit stops a mesh that is wrong.
kernel void refine_sharp(uint edges, GCDT_MESH_PARAMETERS, global const uint* edge_marks, global const uint2* pieces,
                         global const uint* edge_pieces, volatile global uint* sharp) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(item, 2u * edges) {
    const uint e = item / 2u;
    if (edge_pieces[e] == GCDT_NONE) continue;
    uint ref = edge_faces[item], left = gcdt_forest_faces(n, 1u);
    const uint4 first = face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
    const uint z = element(first, next_corner(GCDT_REF_CORNER(ref))),
               to = element(first, previous_corner(GCDT_REF_CORNER(ref)));
    while (left-- > 0u) {
      const uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
      const uint4 c = face_data[GCDT_CORNERS(face)], s = face_data[GCDT_SIDES(face)];
      if (s.w == 0u) break;
      const Vertex at = vertex_at(points, z), p = vertex_at(points, to), q = vertex_at(points, element(c, k));
      const i64 dot = gcdt_dot(at, p, q), cross = gcdt_orient2d_finite(at, p, q);
      // cross / dot < tan(60 degrees); turning, cross is positive up to 180 degrees.
      if (dot <= 0 || cross <= 0 || !gcdt_product_less(1000000u, (u64)cross, 1732051u, (u64)dot)) break;
      const uint code = element(s, previous_corner(k)), other = edge_pieces[GCDT_SIDE_EDGE(code)];
      if (other != GCDT_NONE) {
        atomic_or(sharp + edge_pieces[e], end_bit(pieces[edge_pieces[e]], z));
        atomic_or(sharp + other, end_bit(pieces[other], z));
        break;
      }
      ref = edge_faces[code ^ 1u];
    }
  }
}

// One work-item per kept triangle as it was. Writes its label's largest doubled area: that of its seed, if it has one.
// No race.
kernel void refine_areas(uint count, global const int* seeds, global const ulong* given, global ulong* areas) {
  FOR_EACH(i, count) areas[i] = seeds[i] < 0 ? ~0ul : given[seeds[i]];
}

// ---- After ------------------------------------------------------------------------------------------------

// One work-item per vertex with an origin, from `first` on. Of one on a piece, but beside the line through its ends,
// writes the cross product and the squared length of which the distance is made. No race: places that an atomic gives;
// nothing depends on their order.
kernel void refine_moves(uint count_of_origins, uint first, global const int2* points, global const uint4* origins,
                         global const uint2* pieces, volatile global uint* count, global ulong2* moves) {
  FOR_EACH(i, count_of_origins) {
    if (origins[i].w == GCDT_NONE) continue;
    const uint2 ends = pieces[origins[i].w];
    const Vertex a = vertex_at(points, ends.x), b = vertex_at(points, ends.y);
    const i64 cross = gcdt_orient2d_finite(a, b, vertex_at(points, first + i));
    if (cross != 0) moves[atomic_inc(count)] = (ulong2)(abs(cross), gcdt_squared_length(a, b));
  }
}

// One work-item per added vertex, from `inputs` on. Writes its key (x, y) and its place. No race.
kernel void refine_keys(uint count, uint inputs, global const int2* points, global ulong* keys, global uint* numbers) {
  FOR_EACH(i, count) {
    keys[i] = gcdt_tie_key(vertex_at(points, inputs + i));
    numbers[i] = i;
  }
}

// One work-item per input number and per added vertex in order: their points, and the place of each added one. No race.
kernel void refine_join(uint given, uint added, uint inputs, global const int2* points, global const uint* input_vertex,
                        global const uint* numbers, global int2* joined, global int2* added_points,
                        global uint* places) {
  FOR_EACH(i, given + added) {
    if (i < given) {
      joined[i] = points[input_vertex[i]];
      continue;
    }
    const uint number = numbers[i - given];
    joined[i] = added_points[i - given] = points[inputs + number];
    places[number] = i - given;
  }
}

// One work-item per vertex as it was numbered. Writes its input number: the representative's, or of an added one what
// follows from its place. No race.
kernel void refine_numbers(uint count, uint inputs, uint given, global const uint* vertex_input,
                           global const uint* places, global uint* input_numbers) {
  FOR_EACH(v, count) input_numbers[v] = v < inputs ? vertex_input[v] : given + places[v - inputs];
}

static inline uint renamed(uint v, uint from, uint to, global const uint* input_numbers,
                           global const uint* input_vertex) {
  return v >= from ? v - from + to : input_vertex[input_numbers[v]];
}

// One work-item per face. Replaces its corners by the vertices as they are numbered now; symbolic ones, from `from` on,
// are from `to` on. No race.
kernel void refine_rename(uint faces, uint from, uint to, global const uint* input_numbers,
                          global const uint* input_vertex, global uint4* face_data) {
  FOR_EACH(t, faces) {
    const uint4 c = face_data[GCDT_CORNERS(t)];
    face_data[GCDT_CORNERS(t)] = (uint4)(renamed(c.x, from, to, input_numbers, input_vertex),
                                         renamed(c.y, from, to, input_numbers, input_vertex),
                                         renamed(c.z, from, to, input_numbers, input_vertex), c.w);
  }
}

// One work-item per piece. Writes its ends as vertices are numbered now. No race: its own words.
kernel void refine_rename_ends(uint count, global const uint* input_numbers, global const uint* input_vertex,
                               global const uint2* pieces, global uint2* renamed_ends) {
  FOR_EACH(i, count)
  renamed_ends[i] = (uint2)(input_vertex[input_numbers[pieces[i].x]], input_vertex[input_numbers[pieces[i].y]]);
}

// One work-item per added vertex, of which the origins begin at place `first`. Writes at its place what it was put on,
// in input numbers: three corners, or two ends and GCDT_NONE; and the piece, as it was numbered before. No race.
kernel void refine_origins(uint count, uint first, global const uint4* origins, global const uint* places,
                           global const uint* input_numbers, global uint4* named) {
  FOR_EACH(i, count) {
    const uint4 o = origins[first + i];
    named[places[i]] =
        (uint4)(input_numbers[o.x], input_numbers[o.y], o.z == GCDT_NONE ? GCDT_NONE : input_numbers[o.z], o.w);
  }
}

// One work-item per edge. Flags subsegments of the first `pieces` pieces, all others lose their constraint. No race.
kernel void refine_select(uint edges, uint pieces, global const uint* edge_pieces, global uint* edge_marks,
                          global uint* flags) {
  FOR_EACH(e, edges) {
    flags[e] = edge_pieces[e] < pieces ? 1u : 0u;
    if (flags[e])
      edge_marks[e] |= GCDT_MARK_CONSTRAINED;
    else
      edge_marks[e] &= ~GCDT_MARK_CONSTRAINED;
  }
}

// One work-item per subsegment. Writes the ranks of its ends, the lower above. No race.
kernel void refine_piece_keys(uint count, uint bits, GCDT_LEVELS_POINTER levels, global const uint4* face_data,
                              global const uint* edge_faces, global const uint* edges, global ulong* keys) {
  FOR_EACH(i, count) {
    const uint ref = edge_faces[2u * edges[i]], k = GCDT_REF_CORNER(ref);
    const uint4 c = face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
    const uint p = gcdt_rank_of_vertex(levels, element(c, next_corner(k))),
               q = gcdt_rank_of_vertex(levels, element(c, previous_corner(k)));
    keys[i] = ((ulong)min(p, q) << bits) | max(p, q);
  }
}

// One work-item per subsegment in order. Writes its ends, its piece, and how many sources it has: those of its piece,
// of which the first `count` have any. No race.
kernel void refine_pieces(uint subsegments, uint bits, uint count, GCDT_LEVELS_POINTER levels, global const ulong* keys,
                          global const uint* edges, global const uint* edge_pieces, global const uint* offsets,
                          global uint2* ends, global uint* numbers, global uint* lengths) {
  const uint last = levels->count - 1u;
  FOR_EACH(i, subsegments) {
    const ulong key = keys[i];
    ends[i] = (uint2)(gcdt_vertex_of_rank(levels, last, (uint)(key >> bits)),
                      gcdt_vertex_of_rank(levels, last, (uint)(key & (((ulong)1 << bits) - 1u))));
    const uint piece = numbers[i] = edge_pieces[edges[i]];
    lengths[i] = piece < count ? offsets[piece + 1u] - offsets[piece] : 0u;
  }
}

// One work-item per subsegment in order. Copies the sources of its piece. No race: its own words.
kernel void refine_sources(uint subsegments, global const uint* edges, global const uint* edge_pieces,
                           global const uint* offsets, global const uint* sources, global const uint* new_offsets,
                           global uint* new_sources) {
  FOR_EACH(i, subsegments) {
    const uint first = offsets[edge_pieces[edges[i]]];
    for (uint at = new_offsets[i]; at < new_offsets[i + 1u]; ++at)
      new_sources[at] = sources[first + at - new_offsets[i]];
  }
}

// One work-item per triangle of the result's hull. Writes its flags anew, and 1 if its face is kept. No race.
kernel void refine_flags(uint count, global const uint* refs, global const uint4* face_data,
                         global const uint* edge_marks, global uchar* constrained, global uint* kept) {
  FOR_EACH(i, count) {
    const uint k = GCDT_REF_CORNER(refs[i]);
    const uint4 s = face_data[GCDT_SIDES(GCDT_REF_FACE(refs[i]))], r = rotate_to(s, k);
    constrained[i] = (uchar)((edge_marks[GCDT_SIDE_EDGE(r.x)] & GCDT_MARK_CONSTRAINED) |
                             (edge_marks[GCDT_SIDE_EDGE(r.y)] & GCDT_MARK_CONSTRAINED) << 1u |
                             (edge_marks[GCDT_SIDE_EDGE(r.z)] & GCDT_MARK_CONSTRAINED) << 2u);
    kept[i] = s.w != 0u ? 1u : 0u;
  }
}

// One work-item per triangle of the result. Writes the label of its face less 1. No race.
kernel void refine_labels(uint count, global const uint* refs, global const int* places, global const uint4* face_data,
                          global uint* labels) {
  FOR_EACH(i, count) {
    if (places[i] >= 0) labels[places[i]] = face_data[GCDT_SIDES(GCDT_REF_FACE(refs[i]))].w - 1u;
  }
}

// One work-item per triangle of the result's hull. Writes what was said of its face, if it is kept. No race.
kernel void refine_excuses(uint count, global const uint* refs, global const int* places, global const uint* reasons,
                           global uchar* excuses) {
  FOR_EACH(i, count) {
    if (places[i] >= 0) excuses[places[i]] = (uchar)reasons[GCDT_REF_FACE(refs[i])];
  }
}

// One work-item per element. Writes from[index[i]]. No race.
kernel void refine_gather(uint count, global const uint* index, global const uint* from, global uint* to) {
  FOR_EACH(i, count) to[i] = from[index[i]];
}

// One work-item per added vertex, of crossings and then of the refinement. Writes its point and origin, with the first
// source of the piece in place of its number: of the first `pieces` ones, which have any. Crossings have GCDT_NONE for
// theirs. No race.
kernel void refine_append(uint crossings, uint added, uint pieces, global const uint* offsets,
                          global const uint* sources, global const int2* crossing_points,
                          global const int2* added_points, global const uint4* added_origins, global int2* points,
                          global uint4* origins) {
  FOR_EACH(i, crossings + added) {
    if (i < crossings) {
      points[i] = crossing_points[i];
      origins[i] = (uint4)(GCDT_NONE);
      continue;
    }
    uint4 origin = added_origins[i - crossings];
    origin.w = origin.w < pieces ? sources[offsets[origin.w]] : GCDT_NONE;
    points[i] = added_points[i - crossings];
    origins[i] = origin;
  }
}
