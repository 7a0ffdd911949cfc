// SPDX-License-Identifier: Apache-2.0
// Names every pair of pieces that cross. Only run when the constrain phase or the final check has found
// that some do.
//
// Two pieces cross at a point X inside both. X is no vertex (pieces are split at vertices), so it lies
// in a face or inside an edge, and both pieces pass through every face whose closure holds X, or run
// along one of its edges. So all pairs of pieces in one face are tested, and a pair counts in the face
// that holds X; if X lies on an edge, in the face of the smaller number: exactly once. Where few faces are large and
// each is crossed by many pieces, testing every piece with every other one of its problem is less work
// (lib/phases/crossings.cpp).
#include "constrain/snap.h"
#include "constrain/walk.h"

// One work-item per part. For each face that the part passes (and both faces beside a piece that is an
// edge) counts one record (emit = 0: atomic_inc of starts[face]), or writes the piece to the face's
// range (emit = 1: places by atomic counter; the order within a face is free, since pairs are sorted).
// A face in which one part ends and the next begins would be recorded twice: the later part skips its
// first face, which the earlier one has recorded.
kernel void crossings_records(uint emit, uint pieces, uint capacity, GCDT_MESH_PARAMETERS, global const uint2* ends,
                              global const uint* begins, global const int4* lines, global const uint* part_piece,
                              global const uint* part_face, volatile global uint* starts, volatile global uint* filled,
                              global uint* records, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint parts = begins[pieces];
  FOR_EACH(part, min(parts, capacity)) {
    const uint c = part_piece[part];
    Walk w;
    uint event = walk_begin(&w, mesh, part_face[part], walk_ends(ends[c]), lines[c], part - begins[c],
                            begins[c + 1u] - begins[c]);
    const bool is_edge = event == WALK_HIT && w.hit == w.b && w.code != GCDT_NONE;
    if (is_edge && w.k != 0u) continue;
    bool record = w.k == 0u;
    // Ends: every edge crossed lies further along the piece.
    for (uint pass = 0;; ++pass) {
      if (record && event != WALK_FAILED) {
        if (emit)
          records[starts[w.face] + atomic_inc(filled + w.face)] = c;
        else
          atomic_inc(starts + w.face);
      }
      record = true;
      if (is_edge && pass == 0u && mesh.edge_faces[w.code ^ 1u] != GCDT_NONE) {
        w.face = GCDT_REF_FACE(mesh.edge_faces[w.code ^ 1u]);
        continue;
      }
      if ((event = end_of_part(&w, mesh, event)) != WALK_CROSS) break;
      event = walk_cross(&w, mesh, gate_of_side(mesh, w.code ^ 1u));
      if (w.code != GCDT_NONE) w.face = GCDT_REF_FACE(left_face(&w, mesh));
    }
    if (event == WALK_FAILED || event == WALK_HIT) atomic_or(&counters->failed, GCDT_FAILED_WALK);
  }
}

// The end of the pieces of c's problem: pieces are sorted by their lower ranks, hence by problem. Ends: the range
// halves.
static uint end_of_problem(global const int2* points, uint n, uint pieces, global const uint2* ends, uint c) {
#ifdef GCDT_FOREST
  const uint own = problem_of(points, n, ends[c].x);
  uint low = c + 1u, high = pieces;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (problem_of(points, n, ends[middle].x) == own)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
#else
  return pieces;
#endif
}

// One work-item per face, and per piece. Adds to counters->pairs the pairs of records of the faces, to flips the pairs
// of pieces of a problem, and to hits the pieces with more than `longest` after them. Sums do not depend on order.
kernel void crossings_work(uint faces, uint pieces, uint longest, uint n, global const int2* points,
                           global const uint2* ends, global const uint* counts, volatile global Counters* counters) {
  u64 of_faces = 0, of_problems = 0;
  uint long_rows = 0;
  FOR_EACH(t, faces) {
    const u64 k = counts[t];
    of_faces += k * (k - (k > 0 ? 1u : 0u)) / 2u;
  }
  FOR_EACH(c, pieces) {
    const uint row = end_of_problem(points, n, pieces, ends, c) - c - 1u;
    of_problems += row;
    long_rows += row > longest ? 1u : 0u;
  }
  add_wide(&counters->pairs_low, &counters->pairs_high, of_faces);
  add_wide(&counters->flips_low, &counters->flips_high, of_problems);
  if (long_rows > 0u) atomic_add(&counters->hits, long_rows);
}

// Sign of the side of the line p -> q on which the crossing X lies that divides a1-b1 as s : r, s + r > 0:
// (s + r) orient2d(p, q, X) = s orient2d(p, q, b1) + r orient2d(p, q, a1), below 2^62 * 2^63 * 2 = 2^126.
static int side_of_crossing(Vertex p, Vertex q, Vertex a1, Vertex b1, i64 s, i64 r) {
  return gcdt_sign128(gcdt_add(gcdt_multiply(s, gcdt_orient2d(p, q, b1)), gcdt_multiply(r, gcdt_orient2d(p, q, a1))));
}

static bool cross_in_face(Mesh mesh, uint t, uint2 e1, uint2 e2) {
  const Vertex a1 = load_vertex(mesh.points, mesh.n, e1.x), b1 = load_vertex(mesh.points, mesh.n, e1.y);
  i64 s, r;
  if (!gcdt_segments_cross(a1, b1, load_vertex(mesh.points, mesh.n, e2.x), load_vertex(mesh.points, mesh.n, e2.y), &s,
                           &r))
    return false;
  const uint4 c = mesh.face_data[GCDT_CORNERS(t)], sides = mesh.face_data[GCDT_SIDES(t)];
  for (uint k = 0; k < 3u; ++k) {
    const int side = side_of_crossing(load_vertex(mesh.points, mesh.n, element(c, next_corner(k))),
                                      load_vertex(mesh.points, mesh.n, element(c, previous_corner(k))), a1, b1, s, r);
    if (side < 0) return false;
    const uint across = mesh.edge_faces[element(sides, k) ^ 1u];
    if (side == 0 && across != GCDT_NONE && GCDT_REF_FACE(across) < t) return false;
  }
  return true;
}

// One work-item per record. Tests its piece against those recorded after it in the same face. emit = 0:
// writes how many cross to its own word, and adds to the 64-bit total; emit = 1, `counts` then being their scan:
// writes the pairs (smaller piece first) of numbers first .. last - 1 to their own places. No race.
kernel void crossings_pairs(uint emit, uint first, uint last, uint faces, GCDT_MESH_PARAMETERS,
                            global const uint2* ends, global const uint* starts, global const uint* records,
                            global uint* counts, global uint2* pairs, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint total = starts[faces];
  FOR_EACH(i, total) {
    if (emit && (counts[i] == counts[i + 1u] || counts[i] >= last || counts[i + 1u] <= first)) continue;
    const uint t = last_begin(starts, faces, i);
    const uint c = records[i];
    uint found = 0;
    for (uint j = i + 1u; j < starts[t + 1u]; ++j) {
      const uint d = records[j];
      if (!cross_in_face(mesh, t, ends[c], ends[d])) continue;
      if (emit && counts[i] + found >= first && counts[i] + found < last)
        pairs[counts[i] + found - first] = (uint2)(min(c, d), max(c, d));
      ++found;
    }
    if (!emit) {
      counts[i] = found;
      add_wide(&counters->pairs_low, &counters->pairs_high, found);
    }
  }
}

// The same for all pairs of pieces of a problem, whatever faces they pass: one work-item per piece, tested against
// those after it.
kernel void crossings_all(uint emit, uint first, uint last, uint pieces, uint n, global const int2* points,
                          global const uint2* ends, global uint* counts, global uint2* pairs,
                          volatile global Counters* counters) {
  FOR_EACH(c, pieces) {
    if (emit && (counts[c] == counts[c + 1u] || counts[c] >= last || counts[c + 1u] <= first)) continue;
    const Vertex a = vertex_at(points, ends[c].x), b = vertex_at(points, ends[c].y);
    const uint end = end_of_problem(points, n, pieces, ends, c);
    uint found = 0;
    for (uint d = c + 1u; d < end; ++d) {
      i64 s, r;
      if (!gcdt_segments_cross(a, b, vertex_at(points, ends[d].x), vertex_at(points, ends[d].y), &s, &r)) continue;
      if (emit && counts[c] + found >= first && counts[c] + found < last)
        pairs[counts[c] + found - first] = (uint2)(c, d);
      ++found;
    }
    if (!emit) {
      counts[c] = found;
      add_wide(&counters->pairs_low, &counters->pairs_high, found);
    }
  }
}

// One work-item per pair of pieces that cross. Writes how many pairs of constraints they are parts of to its own word,
// and adds it to the 64-bit total.
kernel void crossings_count_sources(uint count, global const uint* source_offsets, global const uint2* pairs,
                                    global uint* counts, volatile global Counters* counters) {
  u64 all = 0;
  FOR_EACH(i, count) {
    const uint2 pair = pairs[i];
    const u64 own = (u64)(source_offsets[pair.x + 1u] - source_offsets[pair.x]) *
                    (source_offsets[pair.y + 1u] - source_offsets[pair.y]);
    counts[i] = (uint)own;
    all += own;
  }
  add_wide(&counters->pairs_low, &counters->pairs_high, all);
}

// One work-item per pair of pieces that cross, `begins` being the scan of these counts. Writes the pairs of
// constraints, smaller number first, to their own places.
kernel void crossings_sources(uint count, global const uint* source_offsets, global const uint* sources,
                              global const uint2* pairs, global const uint* begins, global uint2* named) {
  FOR_EACH(i, count) {
    const uint2 pair = pairs[i];
    uint at = begins[i];
    for (uint j = source_offsets[pair.x]; j < source_offsets[pair.x + 1u]; ++j)
      for (uint k = source_offsets[pair.y]; k < source_offsets[pair.y + 1u]; ++k)
        named[at++] = (uint2)(min(sources[j], sources[k]), max(sources[j], sources[k]));
  }
}
