// SPDX-License-Identifier: Apache-2.0
// Phase 2: all constraints at once (paper, section 6; rules in kernels/README.md).
//
// Two walks over the same parts: constrain_near finds the nearest piece at each end of every crossed
// edge; constrain_own writes the vertices that each part owns and finds, in hexagons, the farthest
// cuts. constrain_chain puts the chains together. Then every chain vertex makes one triangle
// (constrain_triangles), every hexagon one (constrain_fill), in the slots of the crossed faces.
// Claim words in this phase: 0 = not crossed, 1 = crossed, 2 + h = crossed, hexagon h.
#include "near.h"

#define FACE_CROSSED 1u
#define FACE_HEXAGON 2u

// One work-item per part. Writes near words by compare-and-exchange (reduce_piece: order cannot
// matter), claim words of crossed faces (every writer stores the same value), and for a piece that is
// an edge already that edge's number and mark (one part, the first, owns the piece's word; marks by
// atomic_or). After: near and crossed faces are complete, or failure bits are set.
kernel void constrain_near(uint pieces, uint capacity, GCDT_WALK_PARAMETERS, volatile global uint* edge_marks,
                           volatile global uint* near, global const uint2* ends, global const uint* begins,
                           global uint* piece_edge, volatile global Counters* counters) {
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
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
kernel void constrain_crossed_edges(uint edges, global const uint* edge_marks, volatile global uint* near,
                                    global uint* flags, volatile global Counters* counters) {
  for (uint e = get_global_id(0); e < edges; e += get_global_size(0)) {
    const bool crossed = near[2u * e] != GCDT_NONE;
    flags[e] = crossed ? 1u : 0u;
    if (crossed && (edge_marks[e] & GCDT_MARK_CONSTRAINED)) atomic_or(&counters->failed, GCDT_FAILED_CROSSING);
  }
}

// One work-item per crossed face. A face whose three corners are each cut off by some piece, nearest to
// it on both of its edges, is a hexagon: one hole triangle (paper, 6.5). Writes the face's own claim
// word (hexagons are numbered by an atomic counter: any numbering does). After: counters->hexagons.
kernel void constrain_hexagons(uint count, global const uint* crossed, global uint4* face_data,
                               volatile global uint* near, volatile global Counters* counters) {
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

// One work-item per crossed face. Lists hexagons by number. No race: numbers are distinct.
kernel void constrain_list_hexagons(uint count, global const uint* crossed, global uint4* face_data,
                                    global uint* hexagon_face) {
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint word = *claim_word(face_data, crossed[i]);
    if (word >= FACE_HEXAGON) hexagon_face[word - FACE_HEXAGON] = crossed[i];
  }
}

// ---- Chains ----------------------------------------------------------------------------------------
// All left chains in order of the pieces, then all right ones; each chain is a, its owned vertices in
// walk order, b. Part p of piece c starts at left_start[p] + 2c + 1; a and b have distance 0.
//
// How long each part's share is, is known after its walk. So the walk writes what it owns to chunks, taken from a
// pool by an atomic counter, and each chunk knows its place within the part.
#define CHUNK_LENGTH 8u

// A chunk: its part, the vertices that the part owns left and right before it, its length.
typedef uint4 ChunkHead;

typedef struct Chunks {
  global ChunkHead* heads;
  global uint* entries;  // (vertex << 1) | right
  uint capacity;
} Chunks;

// One part's stream of owned vertices.
typedef struct Owned {
  uint part, chunk, length;  // the current chunk, or GCDT_NONE
  uint left, right;          // so far
} Owned;

static void end_chunk(Chunks chunks, const private Owned* o) {
  if (o->chunk != GCDT_NONE) chunks.heads[o->chunk].w = o->length;
}

// No race: chunks taken are distinct. There are enough for as many vertices as faces are crossed, and more are owned
// only if pieces cross.
static void own_vertex(Chunks chunks, private Owned* o, uint v, uint right, volatile global Counters* counters) {
  if (o->chunk == GCDT_NONE || o->length == CHUNK_LENGTH) {
    end_chunk(chunks, o);
    o->chunk = atomic_inc(&counters->chunks);
    o->length = 0u;
    if (o->chunk >= chunks.capacity) {
      atomic_or(&counters->failed, GCDT_FAILED_COUNT);
      o->chunk = GCDT_NONE;
      return;
    }
    chunks.heads[o->chunk] = (ChunkHead)(o->part, o->left, o->right, 0u);
  }
  chunks.entries[CHUNK_LENGTH * o->chunk + o->length++] = v << 1 | right;
  if (right)
    ++o->right;
  else
    ++o->left;
}

// One work-item per part. Writes the vertices that the part owns to chunks, and how many are left and right (its own
// words), and reduces the farthest cut at each corner of a hexagon (reduce_piece). A piece that is an edge already
// crosses nothing, and is not located again. After: counts, 0 beyond the last part; far[3 h + k] is complete.
kernel void constrain_own(uint pieces, uint capacity, uint chunk_capacity, GCDT_WALK_PARAMETERS,
                          volatile global uint* near, global const uint2* ends, global const uint* begins,
                          global const uint* piece_edge, global uint* counts_left, global uint* counts_right,
                          volatile global uint* far, global ChunkHead* heads, global uint* entries,
                          volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  Chunks chunks;
  chunks.heads = heads;
  chunks.entries = entries;
  chunks.capacity = chunk_capacity;
  const uint parts = begins[pieces];
  uint steps = 0;
  for (uint part = get_global_id(0); part < capacity; part += get_global_size(0)) {
    Owned o;
    o.part = part, o.chunk = GCDT_NONE, o.length = 0u, o.left = 0u, o.right = 0u;
    if (part < parts) {
      const uint c = piece_of_part(begins, pieces, part);
      const uint2 e = walk_ends(ends[c]);
      Walk w;
      uint event = WALK_END;
      if (piece_edge[c] == GCDT_NONE)
        event = walk_begin(&w, levels, level, mesh, h, e.x, e.y, part - begins[c], begins[c + 1u] - begins[c], &steps);
      uint word = event == WALK_CROSS ? *claim_word(mesh.face_data, w.face) : 0u;
      // Ends: every edge crossed lies further along the piece.
      while (event == WALK_CROSS) {
        const Behind behind = look_behind(&w, mesh);
        if (owns_left(&w, near, c)) own_vertex(chunks, &o, w.left, 0u, counters);
        if (owns_right(&w, near, c)) own_vertex(chunks, &o, w.right, 1u, counters);
        if (w.third_side != 0 && word >= FACE_HEXAGON) {
          volatile global uint* at = far + 3u * (word - FACE_HEXAGON) + cut_corner(&w);
          Compared seen = nothing_compared();
          reduce_piece(at, *at, c, &w, w.third_side > 0 ? w.right : w.left, 1u, &seen, mesh, ends, counters);
        }
        word = behind.corners.w;
        event = walk_cross(&w, mesh, behind);
      }
      end_chunk(chunks, &o);
    }
    counts_left[part] = o.left;
    counts_right[part] = o.right;
  }
}

typedef struct Chains {
  global uint* vertex;
  global ulong* distance;
  global uint* piece;
} Chains;

// Distance from the line a -> b: |orient2d| < 2^62 for finite vertices, > 0. A symbolic one is farther than
// every finite one, and the farther the greater its symbol.
static inline ulong chain_distance(Vertex a, Vertex b, Vertex v) {
  if (v.symbol != 0) return ((ulong)1 << 62) + (ulong)v.symbol;
  const i64 d = gcdt_orient2d(a, b, v);
  return (ulong)(d < 0 ? -d : d);
}

static void write_chain(Chains chains, uint at, uint v, uint c, ulong distance) {
  chains.vertex[at] = v;
  chains.piece[at] = c;
  chains.distance[at] = distance;
}

// One work-item per chunk, and one per piece. Writes the chunk's vertices to its own range of the chains, the
// piece's ends around its chains. After: the chains are complete.
kernel void constrain_chain(uint pieces, uint chunk_count, uint right_begin, uint n, global const int2* points,
                            global const uint2* ends, global const uint* begins, global const uint* left_start,
                            global const uint* right_start, global const ChunkHead* heads, global const uint* entries,
                            global uint* chain_vertex, global ulong* chain_distances, global uint* chain_piece,
                            volatile global Counters* counters) {
  Chains chains;
  chains.vertex = chain_vertex;
  chains.distance = chain_distances;
  chains.piece = chain_piece;
  for (uint i = get_global_id(0); i < chunk_count; i += get_global_size(0)) {
    const ChunkHead head = heads[i];
    const uint c = piece_of_part(begins, pieces, head.x);
    const Vertex a = load_vertex(points, n, ends[c].x), b = load_vertex(points, n, ends[c].y);
    uint left = left_start[head.x] + 2u * c + 1u + head.y;
    uint right = right_begin + right_start[head.x] + 2u * c + 1u + head.z;
    for (uint j = 0; j < head.w; ++j) {
      const uint entry = entries[CHUNK_LENGTH * i + j], v = entry >> 1;
      write_chain(chains, entry & 1u ? right++ : left++, v, c, chain_distance(a, b, load_vertex(points, n, v)));
      if (v >= n) atomic_inc(&counters->symbolic_chain_vertices);
    }
  }
  for (uint c = get_global_id(0); c < pieces; c += get_global_size(0)) {
    const uint2 e = walk_ends(ends[c]);
    const uint first = begins[c], last = begins[c + 1u];
    write_chain(chains, left_start[first] + 2u * c, e.x, c, 0u);
    write_chain(chains, left_start[last] + 2u * c + 1u, e.y, c, 0u);
    write_chain(chains, right_begin + right_start[first] + 2u * c, e.x, c, 0u);
    write_chain(chains, right_begin + right_start[last] + 2u * c + 1u, e.y, c, 0u);
  }
}

// The part of piece c that crosses the edge from `right` to `left`: the first that does not end before it
// (come_to_edge). Ends: the range halves.
static uint part_that_crosses(Mesh mesh, Vertex a, Vertex b, uint right, uint left, uint parts) {
  const Vertex r = load_vertex(mesh.points, mesh.n, right), l = load_vertex(mesh.points, mesh.n, left);
  uint low = 0, high = parts - 1u;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if (gcdt_orient2d_division(r, l, a, b, middle + 1u, parts) > 0)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
}

// One work-item per corner of a hexagon. Writes the place in the chains of the hole's corner there: the owned vertex
// just before this place when the piece that cuts the corner farthest is run through with the hexagon's middle on its
// left. Walks the one part that leaves the hexagon, up to there, and counts what it owns. No race: its own word.
kernel void constrain_holes(uint hexagons, uint right_begin, GCDT_WALK_PARAMETERS, volatile global uint* near,
                            global const uint2* ends, global const uint* begins, global const uint* left_start,
                            global const uint* right_start, global const uint* far, global const uint* hexagon_face,
                            global uint* hole_place, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const History h = make_history(begin, end, top, vertex_face, nodes, shape);
  for (uint i = get_global_id(0); i < 3u * hexagons; i += get_global_size(0)) {
    const uint c = far[i], k = i % 3u, t = hexagon_face[i / 3u];
    hole_place[i] = 0u;
    if (c == GCDT_NONE) {
      atomic_or(&counters->failed, GCDT_FAILED_WALK);
      continue;
    }
    const uint4 corners = mesh.face_data[GCDT_CORNERS(t)];
    const uint2 e = walk_ends(ends[c]);
    const Vertex a = load_vertex(mesh.points, mesh.n, e.x), b = load_vertex(mesh.points, mesh.n, e.y);
    const bool cut_right = gcdt_orient2d(a, b, load_vertex(mesh.points, mesh.n, element(corners, k))) < 0;
    const uint third = cut_right ? previous_corner(k) : next_corner(k), parts = begins[c + 1u] - begins[c];
    const uint part = part_that_crosses(mesh, a, b, element(corners, next_corner(third)),
                                        element(corners, previous_corner(third)), parts);
    uint left = left_start[begins[c] + part] + 2u * c + 1u, steps = 0;
    uint right = right_begin + right_start[begins[c] + part] + 2u * c + 1u;
    Walk w;
    uint event = walk_begin(&w, levels, level, mesh, h, e.x, e.y, part, parts, &steps);
    // Ends: every edge crossed lies further along the piece.
    while (event == WALK_CROSS && w.face != t) {
      left += owns_left(&w, near, c) ? 1u : 0u;
      right += owns_right(&w, near, c) ? 1u : 0u;
      event = walk_cross(&w, mesh, look_behind(&w, mesh));
    }
    if (event != WALK_CROSS) atomic_or(&counters->failed, GCDT_FAILED_WALK);
    hole_place[i] = cut_right ? left - 1u : right;
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
