// SPDX-License-Identifier: Apache-2.0
// Phase 2: new triangles in the slots of the crossed faces, one for each vertex of the chains (paper, 6.3, equation 3)
// and one for each hexagon, and what is known of their links.
//
// Vertex i of a chain makes the triangle p, q, i: p is the last place before i with a smaller distance, q the first
// place after it with a distance not larger. The sentinels' distance 0 is smaller than any other, so a search never
// leaves its chain. The triangle's edges:
//   base pq  If p and q are the chain's ends, the piece itself, which is the base of one triangle on the other side too
//            or of none. Else its parent's: that of q if q's distance is larger than p's, else that of p. Then nothing
//            between p and q is as near as the parent, so with the parent q, p is also the last before q with
//            a smaller distance, and with p, q is also the first after p with one not larger: pq is the parent's edge.
//   pi, iq   If p is the place just before i, the side that the walk found there, or one that is found in stitch.cl.
//            Else it is the base of a child: the nearest vertex between them.
// So each base makes a new edge and joins both its sides; a side is written once, by itself or by its child.
#include "common/append.h"
#include "constrain/chains.h"
#include "constrain/slots.h"

// Long chains: a tree of minima, each of GCDT_MINIMA_RADIX entries of the layer below.
static inline ulong layer_value(global const ulong* distances, global const ulong* minima,
                                constant MinimaLayers* layers, uint l, uint i) {
  return l == 0u ? distances[i] : minima[layers->begin[l] + i];
}

static inline uint layer_above(uint entries) { return (entries - 1u) / GCDT_MINIMA_RADIX + 1u; }

// The least of up to GCDT_MINIMA_RADIX entries, of `count`, that are entry i of the layer above.
static inline ulong least_of(global const ulong* entries, uint count, uint i) {
  ulong least = ~(ulong)0;
  for (uint j = i * GCDT_MINIMA_RADIX; j < min(count, (i + 1u) * GCDT_MINIMA_RADIX); ++j)
    least = min(least, entries[j]);
  return least;
}

// One work-item per entry of the layer above. No race: its own word.
kernel void retriangulate_minima(uint count, uint below_count, uint below_begin, uint above_begin, uint from_distances,
                                 global const ulong* distances, global ulong* minima) {
  FOR_EACH(i, count) {
    minima[above_begin + i] = least_of(from_distances ? distances : minima + below_begin, below_count, i);
  }
}

// One work-group. Says how many layers there are over chains of `length` places, and where they begin; and makes those
// behind the first `made`, the distances counted. No race: a word has one writer, and who reads it does so behind a
// barrier. Ends: lengths fall, and 8 layers reach beyond 2^32 places.
kernel void retriangulate_top(uint length, uint made, global const ulong* distances, global ulong* minima,
                              global MinimaLayers* layers) {
  uint count = 1, total = 0, entries = length, begin = 0;
  if (get_local_id(0) == 0) layers->begin[0] = 0u, layers->length[0] = length;
  while (entries > GCDT_MINIMA_RADIX && count < GCDT_MINIMA_LAYERS) {
    const uint above = layer_above(entries);
    if (count >= made)
      for (uint i = get_local_id(0); i < above; i += get_local_size(0))
        minima[total + i] = least_of(count == 1u ? distances : minima + begin, entries, i);
    if (get_local_id(0) == 0) layers->begin[count] = total, layers->length[count] = above;
    barrier(CLK_GLOBAL_MEM_FENCE);
    begin = total;
    total += above;
    entries = above;
    ++count;
  }
  if (get_local_id(0) == 0) layers->count = count;
}

// The last place before i with a distance < d. Climbs to the first layer where an entry to the left in
// the same group has one, then descends to it: at most 2 * GCDT_MINIMA_RADIX entries a layer. Ends: the
// sentinel is there.
GCDT_APART uint smaller_before(global const ulong* distances, global const ulong* minima, constant MinimaLayers* layers,
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
#pragma unroll 1  // drivers take as long as the text is
  while (l > 0u) {
    --l;
    uint j = min(layers->length[l], (at + 1u) * GCDT_MINIMA_RADIX) - 1u;
    while (j > at * GCDT_MINIMA_RADIX && !(layer_value(distances, minima, layers, l, j) < d)) --j;
    at = j;
  }
  return at;
}

// The first place after i with a distance <= d. Mirror image.
GCDT_APART uint not_larger_after(global const ulong* distances, global const ulong* minima,
                                 constant MinimaLayers* layers, uint i, ulong d) {
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
#pragma unroll 1
  while (l > 0u) {
    --l;
    uint j = at * GCDT_MINIMA_RADIX;
    const uint last = min(layers->length[l], (at + 1u) * GCDT_MINIMA_RADIX) - 1u;
    while (j < last && layer_value(distances, minima, layers, l, j) > d) ++j;
    at = j;
  }
  return at;
}

// The triangle is (p, q, i) left of its piece and (q, p, i) right of it, counter-clockwise both: base across from
// corner 2, and these are across from p and q.
static inline uint corner_of_p(bool left) { return left ? 0u : 1u; }
static inline uint corner_of_q(bool left) { return left ? 1u : 0u; }

// The side of t along the chain, which a walk has found or stitch.cl will.
static inline void join_along(global uint4* face_data, global uint* edge_faces, uint t, uint k, uint code) {
  if (code == GCDT_NONE)
    set_side(face_data, t, k, code);
  else
    join(face_data, edge_faces, t, k, code);
}

// One work-item per place in the chains. Writes the corners of one crossed slot, the owned vertex's number (slots.cl),
// so no two write the same; its sides along the chain; and its base with the parent's side there, in a new edge, or
// itself to roots: roots[c].x is the left one of piece c, roots[c].y the right one, GCDT_NONE before. Edges for which
// the piece has no slot take spare ones.
kernel void retriangulate_chains(uint grouped, uint length, uint right_begin, uint pieces,
                                 constant MinimaLayers* layers, global const uint* chain_vertex,
                                 global const ulong* chain_distances, global const uint* chain_piece,
                                 global const uint* chain_side, global const ulong* minima, global const uint4* records,
                                 global const uint* crossed, global const uint* crossed_edges, global const uint* spare,
                                 global uint4* face_data, global uint* edge_faces, global uint* edge_marks,
                                 global uint* roots, volatile global Counters* counters) {
  local uint taken[2];
  FOR_EACH_TILE(tile, length) {
    const uint i = tile + get_local_id(0);
    uint p = 0, q = 0, t = GCDT_NONE, parent = GCDT_NONE, number = 0, e = GCDT_NONE;
    const ulong d = i < length ? chain_distances[i] : 0u;
    if (d != 0u) {
      const uint4 record = slots_of_piece(grouped, pieces, records, chain_piece[i]);
      number = i < right_begin ? record.x : record.y;
      p = smaller_before(chain_distances, minima, layers, i, d);
      q = not_larger_after(chain_distances, minima, layers, i, d);
      t = crossed[number + i];
      parent = chain_distances[q] > chain_distances[p] ? q : chain_distances[p] > 0u ? p : GCDT_NONE;
      const uint slot = number + (parent == q ? q - 1u : p) + record.z;
      if (parent != GCDT_NONE && slot < record.w) e = crossed_edges[slot];
    }
    const uint other = take_spare(taken, grouped, parent != GCDT_NONE && e == GCDT_NONE, spare, counters);
    if (t == GCDT_NONE) continue;
    if (e == GCDT_NONE) e = other;
    const bool left = i < right_begin;
    const uint kp = corner_of_p(left), kq = corner_of_q(left), v = chain_vertex[i];
    face_data[GCDT_CORNERS(t)] =
        left ? (uint4)(chain_vertex[p], chain_vertex[q], v, 0u) : (uint4)(chain_vertex[q], chain_vertex[p], v, 0u);
    if (p + 1u == i) join_along(face_data, edge_faces, t, kq, chain_side[i]);
    if (i + 1u == q) join_along(face_data, edge_faces, t, kp, chain_side[q]);
    if (parent == GCDT_NONE) {
      roots[2u * chain_piece[i] + (left ? 0u : 1u)] = t;
      set_side(face_data, t, 2u, GCDT_NONE);
    } else if (e == GCDT_NONE) {
      atomic_or(&counters->failed, GCDT_FAILED_MATCH);
    } else {
      edge_marks[e] = 0u;
      join(face_data, edge_faces, t, 2u, GCDT_SIDE(e, 0u));
      join(face_data, edge_faces, crossed[number + parent], parent == q ? kq : kp, GCDT_SIDE(e, 1u));
    }
  }
}

// One work-item per piece. Joins the triangles on its two sides, if both are of its own chains, in a new edge, and
// names that in piece_edge. No race: roots are triangles of one piece. The bases of single roots are left to stitch.cl.
kernel void retriangulate_pieces(uint grouped, uint pieces, global const uint2* roots, global const uint* begins,
                                 global const uint* starts, global const uint4* records,
                                 global const uint* crossed_edges, global const uint* spare, global uint4* face_data,
                                 global uint* edge_faces, global uint* edge_marks, global uint* piece_edge,
                                 volatile global Counters* counters) {
  local uint taken[2];
  FOR_EACH_TILE(tile, pieces) {
    const uint c = tile + get_local_id(0);
    const uint2 root = c < pieces ? roots[c] : (uint2)(GCDT_NONE, GCDT_NONE);
    const bool both = root.x != GCDT_NONE && root.y != GCDT_NONE;
    uint e = GCDT_NONE;
    if (both && grouped) {
      const uint4 record = records[c];
      const uint slot = record.x + left_begin(starts, begins[c + 1u], c) + record.z;  // behind its last one left
      if (slot < record.w) e = crossed_edges[slot];
    }
    const uint other = take_spare(taken, grouped, both && e == GCDT_NONE, spare, counters);
    if (!both) continue;
    if (e == GCDT_NONE) e = other;
    if (e == GCDT_NONE) {
      atomic_or(&counters->failed, GCDT_FAILED_MATCH);
      continue;
    }
    edge_marks[e] = GCDT_MARK_CONSTRAINED;
    piece_edge[c] = e;
    join(face_data, edge_faces, root.x, 2u, GCDT_SIDE(e, 0u));
    join(face_data, edge_faces, root.y, 2u, GCDT_SIDE(e, 1u));
  }
}
