// SPDX-License-Identifier: Apache-2.0
// Phase 2: all constraints at once (paper, section 6; rules in kernels/README.md).
//
// Three walks over the same parts: constrain_near finds the nearest piece at each end of every crossed
// edge; constrain_count counts the vertices that each part owns and finds, in hexagons, the farthest
// cuts; constrain_chain writes the chains. Then every chain vertex makes one triangle
// (constrain_triangles), every hexagon one (constrain_fill), in the slots of the crossed faces.
// Claim words in this phase: 0 = not crossed, 1 = crossed, 2 + h = crossed, hexagon h.
#include "near.h"

#define FACE_CROSSED 1u
#define FACE_HEXAGON 2u

#define NEAR_PARAMETERS volatile global uint *near0, volatile global uint *near1

static inline Near make_near(NEAR_PARAMETERS) {
  Near near;
  near.slot0 = near0;
  near.slot1 = near1;
  return near;
}

// One work-item per part. Writes near words by compare-and-exchange (reduce_piece: order cannot
// matter), claim words of crossed faces (every writer stores the same value), and for a piece that is
// an edge already that edge's number and mark (one part, the first, owns the piece's word; marks by
// atomic_or). After: near and crossed faces are complete, or failure bits are set.
kernel void constrain_near(uint pieces, uint capacity, GCDT_WALK_PARAMETERS, volatile global uint* edge_marks,
                           NEAR_PARAMETERS, global const uint2* ends, global const uint* begins,
                           global uint* piece_edge, volatile global Counters* counters) {
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const Near near = make_near(near0, near1);
  const uint parts = begins[pieces];
  uint steps = 0, pairs = 0, existing = 0;
  for (uint part = get_global_id(0); part < parts && part < capacity; part += get_global_size(0)) {
    const uint c = piece_of_part(begins, pieces, part);
    const uint2 e = walk_ends(ends[c]);
    Walk w;
    uint event = walk_begin(&w, levels, level, mesh, h, e.x, e.y, part - begins[c], begins[c + 1u] - begins[c], &steps);
    if (w.k == 0u) {
      const bool is_edge = event == WALK_END && w.hit == w.b;
      piece_edge[c] = is_edge ? GCDT_SIDE_EDGE(w.code) : GCDT_NONE;
      if (is_edge) {
        atomic_or(edge_marks + GCDT_SIDE_EDGE(w.code), GCDT_MARK_CONSTRAINED);
        ++existing;
      } else {
        *claim_word(mesh.face_data, w.face) = FACE_CROSSED;
        ++pairs;
      }
    }
    Compared seen_left = nothing_compared(), seen_right = nothing_compared();
    // Ends: every edge crossed lies further along the piece.
    while (event == WALK_CROSS) {
      volatile global uint *left = near_left(near, w.code), *right = near_right(near, w.code);
      const uint at_left = *left, at_right = *right;
      const Behind behind = look_behind(&w, mesh);
      reduce_piece(left, at_left, c, &w, w.left, 0u, &seen_left, mesh, ends, counters);
      reduce_piece(right, at_right, c, &w, w.right, 0u, &seen_right, mesh, ends, counters);
      event = walk_cross(&w, mesh, behind);
      // Many pieces cross a face: one write will do. (If the word was read too early, it is written again.)
      if (behind.corners.w != FACE_CROSSED) *claim_word(mesh.face_data, w.face) = FACE_CROSSED;
      ++pairs;
    }
    if (event == WALK_HIT) atomic_or(&counters->failed, GCDT_FAILED_HIT);
    if (event == WALK_FAILED) atomic_or(&counters->failed, GCDT_FAILED_WALK);
  }
  add_for_group(&sum, &counters->steps_low, &counters->steps_high, steps);
  add_for_group(&sum, &counters->pairs_low, &counters->pairs_high, pairs);
  existing = sum_of_group(&sum, existing);
  if (get_local_id(0) == 0 && existing > 0u) atomic_add(&counters->existing_edges, existing);
}

// One work-item per face. Flags crossed faces. No race: its own word.
kernel void constrain_crossed_faces(uint faces, global uint4* face_data, global uint* flags) {
  for (uint t = get_global_id(0); t < faces; t += get_global_size(0))
    flags[t] = *claim_word(face_data, t) != 0u ? 1u : 0u;
}

// One work-item per edge. Flags crossed edges; a crossed edge that is a piece means that two pieces
// cross. No race: its own word.
kernel void constrain_crossed_edges(uint edges, global const uint* edge_marks, NEAR_PARAMETERS, global uint* flags,
                                    volatile global Counters* counters) {
  (void)near1;
  for (uint e = get_global_id(0); e < edges; e += get_global_size(0)) {
    const bool crossed = near0[e] != GCDT_NONE;
    flags[e] = crossed ? 1u : 0u;
    if (crossed && (edge_marks[e] & GCDT_MARK_CONSTRAINED)) atomic_or(&counters->failed, GCDT_FAILED_CROSSING);
  }
}

// One work-item per crossed face. A face whose three corners are each cut off by some piece, nearest to
// it on both of its edges, is a hexagon: one hole triangle (paper, 6.5). Writes the face's own claim
// word (hexagons are numbered by an atomic counter: any numbering does). After: counters->hexagons.
kernel void constrain_hexagons(uint count, global const uint* crossed, global uint4* face_data, NEAR_PARAMETERS,
                               volatile global Counters* counters) {
  const Near near = make_near(near0, near1);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint t = crossed[i];
    const uint4 s = face_data[GCDT_SIDES(t)];
    // Edge opposite corner 0 runs from corner 1 (right) to corner 2 (left), and so on.
    const uint a1 = *near_right(near, s.z), a2 = *near_left(near, s.y);
    const uint b1 = *near_right(near, s.x), b2 = *near_left(near, s.z);
    const uint c1 = *near_right(near, s.y), c2 = *near_left(near, s.x);
    uint word = FACE_CROSSED;
    if (a1 != GCDT_NONE && b1 != GCDT_NONE && c1 != GCDT_NONE && a1 == a2 && b1 == b2 && c1 == c2)
      word = FACE_HEXAGON + atomic_inc(&counters->hexagons);
    *claim_word(face_data, t) = word;
  }
}

// One work-item per part. Counts the vertices that the part owns left and right (its own words), and
// reduces the farthest cut at each corner of a hexagon (reduce_piece). After: counts, 0 beyond the
// last part; far[3 h + k] is complete.
kernel void constrain_count(uint pieces, uint capacity, GCDT_WALK_PARAMETERS, NEAR_PARAMETERS, global const uint2* ends,
                            global const uint* begins, global uint* counts_left, global uint* counts_right,
                            volatile global uint* far, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const Near near = make_near(near0, near1);
  const uint parts = begins[pieces];
  uint steps = 0;
  for (uint part = get_global_id(0); part < capacity; part += get_global_size(0)) {
    uint left = 0, right = 0;
    if (part < parts) {
      const uint c = piece_of_part(begins, pieces, part);
      const uint2 e = walk_ends(ends[c]);
      Walk w;
      uint event =
          walk_begin(&w, levels, level, mesh, h, e.x, e.y, part - begins[c], begins[c + 1u] - begins[c], &steps);
      while (event == WALK_CROSS) {
        const Behind behind = look_behind(&w, mesh);
        left += owns_left(&w, near, c) ? 1u : 0u;
        right += owns_right(&w, near, c) ? 1u : 0u;
        const uint word = *claim_word(mesh.face_data, w.face);
        if (w.third_side != 0 && word >= FACE_HEXAGON) {
          volatile global uint* at = far + 3u * (word - FACE_HEXAGON) + cut_corner(&w);
          Compared seen = nothing_compared();
          reduce_piece(at, *at, c, &w, w.third_side > 0 ? w.right : w.left, 1u, &seen, mesh, ends, counters);
        }
        event = walk_cross(&w, mesh, behind);
      }
    }
    counts_left[part] = left;
    counts_right[part] = right;
  }
}

// ---- Chains ----------------------------------------------------------------------------------------
// All left chains in order of the pieces, then all right ones; each chain is a, its owned vertices in
// walk order, b. Part p of piece c starts at left_start + 2c + 1; a and b have distance 0.

// Distance from the line a -> b: |orient2d| < 2^62 for finite vertices, > 0. A symbolic one is farther than
// every finite one, and the farther the greater its symbol.
static inline ulong chain_distance(const private Walk* w, Vertex v) {
  if (v.symbol != 0) return ((ulong)1 << 62) + (ulong)v.symbol;
  const i64 d = gcdt_orient2d(w->va, w->vb, v);
  return (ulong)(d < 0 ? -d : d);
}

typedef struct Chains {
  global uint* vertex;
  global ulong* distance;
  global uint* piece;
} Chains;

static void write_chain(Chains chains, uint at, uint v, uint c, const private Walk* w, Mesh mesh,
                        volatile global Counters* counters) {
  const bool end = v == w->a || v == w->b;
  chains.vertex[at] = v;
  chains.piece[at] = c;
  chains.distance[at] = end ? 0 : chain_distance(w, load_vertex(mesh.points, mesh.n, v));
  if (v >= mesh.n) atomic_inc(&counters->symbolic_chain_vertices);
}

// One work-item per part. Writes the part's own range of both chains, the sentinels a (first part) and
// b (last part), and for a hexagon's corner cut farthest by its piece the place in the chains of the
// hole's corner there: the owned vertex just before this place when the piece is run through with
// the hexagon's middle on its left. One piece is farthest at a corner and passes it once, so that word
// has one writer. After: the chains are complete.
kernel void constrain_chain(uint pieces, uint right_begin, GCDT_WALK_PARAMETERS, NEAR_PARAMETERS,
                            global const uint2* ends, global const uint* begins, global const uint* left_start,
                            global const uint* right_start, global const uint* far, global uint* chain_vertex,
                            global ulong* chain_distances, global uint* chain_piece, global uint* hole_place,
                            volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  const Near near = make_near(near0, near1);
  Chains chains;
  chains.vertex = chain_vertex;
  chains.distance = chain_distances;
  chains.piece = chain_piece;
  const uint parts = begins[pieces];
  uint steps = 0;
  for (uint part = get_global_id(0); part < parts; part += get_global_size(0)) {
    const uint c = piece_of_part(begins, pieces, part);
    const uint2 e = walk_ends(ends[c]);
    Walk w;
    uint event = walk_begin(&w, levels, level, mesh, h, e.x, e.y, part - begins[c], begins[c + 1u] - begins[c], &steps);
    uint left = left_start[part] + 2u * c + 1u, right = right_begin + right_start[part] + 2u * c + 1u;
    if (w.k == 0u) {
      write_chain(chains, left - 1u, w.a, c, &w, mesh, counters);
      write_chain(chains, right - 1u, w.a, c, &w, mesh, counters);
    }
    while (event == WALK_CROSS) {
      const Behind behind = look_behind(&w, mesh);
      const uint word = *claim_word(mesh.face_data, w.face);
      if (w.third_side != 0 && word >= FACE_HEXAGON) {
        const uint at = 3u * (word - FACE_HEXAGON) + cut_corner(&w);
        if (far[at] == c) hole_place[at] = w.third_side > 0 ? left - 1u : right;
      }
      if (owns_left(&w, near, c)) write_chain(chains, left++, w.left, c, &w, mesh, counters);
      if (owns_right(&w, near, c)) write_chain(chains, right++, w.right, c, &w, mesh, counters);
      event = walk_cross(&w, mesh, behind);
    }
    if (w.k + 1u == w.parts) {
      write_chain(chains, left, w.b, c, &w, mesh, counters);
      write_chain(chains, right, w.b, c, &w, mesh, counters);
    }
  }
}

// ---- Distance-ordered retriangulation (paper, 6.3, equation 3) ---------------------------------------
// p = the last place before i with a smaller distance, q = the first place after it with a distance not
// larger. The sentinels' distance 0 is smaller than any other, so a search never leaves its chain.
// Long chains: a tree of minima, each of GCDT_MINIMA_RADIX entries of the layer below.
static inline ulong layer_value(global const ulong* distances, global const ulong* minima,
                                constant MinimaLayers* layers, uint l, uint i) {
  return l == 0u ? distances[i] : minima[layers->begin[l] + i];
}

// One work-item per entry of the layer above. No race: its own word.
kernel void constrain_minima(uint count, uint below_count, uint below_begin, uint above_begin, uint from_distances,
                             global const ulong* distances, global ulong* minima) {
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    ulong least = ~(ulong)0;
    for (uint j = i * GCDT_MINIMA_RADIX; j < min(below_count, (i + 1u) * GCDT_MINIMA_RADIX); ++j)
      least = min(least, from_distances ? distances[j] : minima[below_begin + j]);
    minima[above_begin + i] = least;
  }
}

// The last place before i with a distance < d. Climbs to the first layer where an entry to the left in
// the same group has one, then descends to it: at most 2 * GCDT_MINIMA_RADIX entries a layer. Ends: the
// sentinel is there.
static uint smaller_before(global const ulong* distances, global const ulong* minima, constant MinimaLayers* layers,
                           uint i, ulong d) {
  uint l = 0, at = i;
  for (;;) {
    const uint group = at / GCDT_MINIMA_RADIX * GCDT_MINIMA_RADIX;
    while (at > group && !(layer_value(distances, minima, layers, l, at - 1u) < d)) --at;
    if (at > group) break;
    if (++l == layers->count) return 0;
    at = group / GCDT_MINIMA_RADIX;
  }
  --at;
  while (l > 0u) {
    --l;
    uint j = min(layers->length[l], (at + 1u) * GCDT_MINIMA_RADIX) - 1u;
    while (j > at * GCDT_MINIMA_RADIX && !(layer_value(distances, minima, layers, l, j) < d)) --j;
    at = j;
  }
  return at;
}

// The first place after i with a distance <= d. Mirror image.
static uint not_larger_after(global const ulong* distances, global const ulong* minima, constant MinimaLayers* layers,
                             uint i, ulong d) {
  uint l = 0, at = i + 1u;
  for (;;) {
    const uint group_end =
        min(layers->length[l], (at + GCDT_MINIMA_RADIX - 1u) / GCDT_MINIMA_RADIX * GCDT_MINIMA_RADIX);
    while (at < group_end && layer_value(distances, minima, layers, l, at) > d) ++at;
    if (at < group_end) break;
    if (l + 1u == layers->count) return layers->length[0] - 1u;
    at = (at + GCDT_MINIMA_RADIX - 1u) / GCDT_MINIMA_RADIX;
    ++l;
  }
  while (l > 0u) {
    --l;
    uint j = at * GCDT_MINIMA_RADIX;
    const uint last = min(layers->length[l], (at + 1u) * GCDT_MINIMA_RADIX) - 1u;
    while (j < last && layer_value(distances, minima, layers, l, j) > d) ++j;
    at = j;
  }
  return at;
}

// One work-item per place in the chains. An owned vertex i makes the triangle (p, q, i) if it is left of
// its piece, (q, p, i) if right: counter-clockwise both. Writes the corners of one crossed slot:
// owned vertices before it in all chains are its number, so no two write the same. After: the first
// slots of `crossed` hold the chains' triangles.
kernel void constrain_triangles(uint length, uint right_begin, uint pieces, constant MinimaLayers* layers,
                                global const uint* chain_vertex, global const ulong* chain_distances,
                                global const uint* chain_piece, global const ulong* minima, global const uint* crossed,
                                global uint4* face_data) {
  for (uint i = get_global_id(0); i < length; i += get_global_size(0)) {
    const ulong d = chain_distances[i];
    if (d == 0) continue;
    const uint p = chain_vertex[smaller_before(chain_distances, minima, layers, i, d)];
    const uint q = chain_vertex[not_larger_after(chain_distances, minima, layers, i, d)];
    const bool left = i < right_begin;
    // 2c + 1 sentinels stand before it among the left chains, 2 pieces + 2c + 1 among all.
    const uint number = i - 2u * chain_piece[i] - 1u - (left ? 0u : 2u * pieces);
    face_data[GCDT_CORNERS(crossed[number])] =
        left ? (uint4)(p, q, chain_vertex[i], 0u) : (uint4)(q, p, chain_vertex[i], 0u);
  }
}

// One work-item per hexagon. Writes the hole triangle into its own slot, after the chains' triangles.
kernel void constrain_fill(uint hexagons, uint first, global const uint* hole_place, global const uint* chain_vertex,
                           global const uint* crossed, global uint4* face_data) {
  for (uint h = get_global_id(0); h < hexagons; h += get_global_size(0))
    face_data[GCDT_CORNERS(crossed[first + h])] =
        (uint4)(chain_vertex[hole_place[3u * h]], chain_vertex[hole_place[3u * h + 1u]],
                chain_vertex[hole_place[3u * h + 2u]], 0u);
}
