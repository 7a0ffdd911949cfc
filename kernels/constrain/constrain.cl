// SPDX-License-Identifier: Apache-2.0
// Phase 2: all constraints at once (paper, section 6; rules in kernels/README.md).
//
// Two walks over the same parts, whose first faces first.cl finds: constrain_near finds the nearest piece at
// each end of every crossed edge; constrain_own writes the vertices that each part owns and finds, in hexagons, the
// farthest cuts. constrain_chain puts the chains together. What follows is in retriangulate.cl, holes.cl and stitch.cl.
// Claim words in this phase, above those of the phases before: claim + h = hexagon h.
#include "common/append.h"
#include "constrain/chains.h"
#include "constrain/chunks.h"
#include "constrain/near.h"
#include "constrain/slots.h"

// The edge a-b of the face, which has it; GCDT_NONE if it does not.
static inline uint edge_of_face(Mesh mesh, uint face, uint a, uint b) {
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)], sides = mesh.face_data[GCDT_SIDES(face)];
  const uint k = c.x == a ? 0u : c.y == a ? 1u : c.z == a ? 2u : GCDT_NONE;
  if (k == GCDT_NONE) return GCDT_NONE;
  if (element(c, next_corner(k)) == b) return GCDT_SIDE_EDGE(element(sides, previous_corner(k)));
  if (element(c, previous_corner(k)) == b) return GCDT_SIDE_EDGE(element(sides, next_corner(k)));
  return GCDT_NONE;
}

// One work-item per piece, after cleaning, in a mesh that has not changed since. A piece that is a whole constraint and
// crosses no face is an edge of the face in which its walk began, whose closure holds points of it next to its end.
// Marks that edge, by atomic_or, and writes whether the piece is none: its own word.
kernel void constrain_existing(uint pieces, GCDT_MESH_PARAMETERS, volatile global uint* edge_marks,
                               global const uint2* ends, global const uint* weights, global const uint2* walked,
                               global const uint* walked_face, global uint* others) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  FOR_EACH(c, pieces) {
    const uint2 e = ends[c], parts = walked[c];
    const uint face = weights[c] == 0u && parts.y > 0u ? walked_face[parts.x] : GCDT_NONE,
               edge = face == GCDT_NONE ? GCDT_NONE : edge_of_face(mesh, face, e.x, e.y);
    if (edge != GCDT_NONE) atomic_or(edge_marks + edge, GCDT_MARK_CONSTRAINED);
    others[c] = edge == GCDT_NONE ? 1u : 0u;
  }
}

// What constrain_near has counted: edges crossed and pieces that are none already, and pieces that are.
typedef struct Nearing {
  u32 pairs, existing;
} Nearing;

// What constrain_near does for `items`, of the parts.
GCDT_APART Nearing find_near(Items items, Mesh mesh, Gates gates, volatile global uint* edge_marks,
                             volatile global uint* near, global const uint2* ends, global const uint* begins,
                             global const int4* lines, global const uint* part_piece, global const uint* part_face,
                             uint ordered, global const uint* order, global uint* piece_edge,
                             volatile global Counters* counters) {
  Nearing done = {0u, 0u};
  FOR_ITEMS(i, items) {
    const uint part = ordered ? order[i] : i;
    const uint c = part_piece[part];
    Walk w;
    uint event = walk_begin(&w, mesh, part_face[part], walk_ends(ends[c]), lines[c], part - begins[c],
                            begins[c + 1u] - begins[c]);
    if (w.k == 0u) {
      const bool is_edge = event == WALK_HIT && w.hit == w.b;
      piece_edge[c] = is_edge ? GCDT_SIDE_EDGE(w.code) : GCDT_NONE;
      if (is_edge) {
        atomic_or(edge_marks + GCDT_SIDE_EDGE(w.code), GCDT_MARK_CONSTRAINED);
        ++done.existing;
      } else if (event != WALK_FAILED) {
        ++done.pairs;
      }
    }
    // Ends: every edge crossed lies further along the piece.
    while (event == WALK_CROSS || event == WALK_HIT) {
      event = end_of_part(&w, mesh, event);
      if (event != WALK_CROSS) break;
      const uint2 at = near_both(near, w.code);
      const Gate behind = look_behind(&w, mesh, gates);
      reduce_near(near, at.x, at.y, c, &w, lines, counters);
      event = walk_cross(&w, mesh, behind);
      ++done.pairs;
    }
    if (event == WALK_HIT)
      atomic_or(&counters->failed, GCDT_FAILED_HIT);
    else if (event != WALK_END)
      atomic_or(&counters->failed, GCDT_FAILED_WALK);
  }
  return done;
}

// One work-item per part, in the order that is given if `ordered`. Writes near words by compare-and-exchange
// (reduce_near: order cannot matter), and for a piece that is an edge already that edge's number and mark (one part,
// the first, owns the piece's word; marks by atomic_or). After: near is complete, or failure bits are set.
kernel void constrain_near(uint pieces, uint capacity, GCDT_MESH_PARAMETERS, GCDT_GATE_PARAMETERS,
                           volatile global uint* edge_marks, volatile global uint* near, global const uint2* ends,
                           global const uint* begins, global const int4* lines, global const uint* part_piece,
                           global const uint* part_face, uint ordered, global const uint* order,
                           global uint* piece_edge, volatile global Counters* counters) {
  local uint sum;
  const Nearing done =
      find_near(items_of_this(min(begins[pieces], capacity)), make_mesh(n, points, face_data, edge_faces),
                make_gates(gates_made, gates_at), edge_marks, near, ends, begins, lines, part_piece, part_face, ordered,
                order, piece_edge, counters);
  add_for_group(&sum, &counters->pairs_low, &counters->pairs_high, done.pairs);
  const uint existing = sum_of_group(&sum, done.existing);
  if (get_local_id(0) == 0 && existing > 0u) atomic_add(&counters->existing_edges, existing);
}

// The near words of a face's sides, which all are asked for at once: x, y and z are those of side 0, 1 and 2, which
// runs from its right to its left end across from corner 0, 1 and 2.
typedef struct Nearest {
  uint4 right, left;
} Nearest;

static inline Nearest nearest_of(global const uint* near, uint4 s) {
  const Nearest at = {near_words(near, s), near_words(near, s ^ 1u)};
  return at;
}

// A crossed face whose three corners are each cut off by some piece, nearest to it on both of its edges, is a hexagon:
// one hole triangle (paper, 6.5). Corner 0 is the right end of side 2 and the left end of side 1, and so on.
static inline bool is_hexagon(Nearest at) {
  return at.right.x != GCDT_NONE && at.right.y != GCDT_NONE && at.right.z != GCDT_NONE && at.right.z == at.left.y &&
         at.right.x == at.left.z && at.right.y == at.left.x;
}

// How the two pieces lie in the face that are met first from the ends of its edge e = {u, v} across from corner k,
// which is w (paper, figure 6), as a 1 in one place. x: both cut off the same corner; y: both come from w; z: one cuts
// off u, one v; w: one comes from w, the other cuts off u or v; nowhere: there are no two. A piece that crosses e comes
// from w or crosses one more edge. p, the first from u, cuts u off if it is the first from u on {u, w}, too (L6), and
// if it cuts v off, so does q, which is nearer to v.
GCDT_APART uint4 intersection_case(Nearest at, uint4 c, uint k, global const uint2* ends) {
  const uint p = element(at.right, k), q = element(at.left, k);
  if (p == q) return (uint4)(0u);
  const uint w = element(c, k);
  const uint2 of_p = ends[p], of_q = ends[q];
  const uint from = (of_p.x == w || of_p.y == w) + (of_q.x == w || of_q.y == w);
  if (from > 0u) return (uint4)(0u, from == 2u, 0u, from == 1u);
  const bool cuts_u = element(at.left, previous_corner(k)) == p;
  const bool cuts_v = element(at.right, next_corner(k)) == q;
  return (uint4)(!(cuts_u && cuts_v), 0u, cuts_u && cuts_v, 0u);
}

// Adds the group's amounts to a counter, by one atomic.
GCDT_GIVEN_LOCAL void add_count(volatile local uint* sum, volatile global uint* counter, uint amount) {
  const uint all = sum_of_group(sum, amount);
  if (get_local_id(0) == 0 && all > 0u) atomic_add(counter, all);
}

// One work-item per face. Lists crossed faces, in any order: it decides only which slot a new triangle gets. (A piece
// that crosses a face leaves it by an edge, or comes into it by one.) Writes the claim words of hexagons among them,
// each its own face's: they are numbered by an atomic counter, as any numbering does. If `grouped`, counts the others
// by piece, by atomic_inc (slots.cl). After: counters->hexagons and pairs_of_two.
kernel void constrain_crossed_faces(uint grouped, uint faces, uint claim, global uint4* face_data,
                                    global const uint* near, global const uint2* ends, global uint* crossed,
                                    volatile global uint* of_pieces, volatile global Counters* counters) {
  local uint sum;
  uint4 pairs = (uint4)(0u);
  DECLARE_APPENDER(list);
  const Appender list = make_appender(list_items, list_gathered, crossed, &counters->crossed_faces);
  FOR_EACH_TILE(tile, faces) {
    const uint t = tile + get_local_id(0);
    Nearest at;
    at.right = (uint4)(GCDT_NONE);
    if (t < faces) at = nearest_of(near, face_data[GCDT_SIDES(t)]);
    if (at.right.x != GCDT_NONE || at.right.y != GCDT_NONE || at.right.z != GCDT_NONE) {
      append(list, t);
      const uint4 corners = face_data[GCDT_CORNERS(t)];
      pairs += intersection_case(at, corners, 0u, ends) + intersection_case(at, corners, 1u, ends) +
               intersection_case(at, corners, 2u, ends);
      if (is_hexagon(at))
        *claim_word(face_data, t) = claim + atomic_inc(&counters->hexagons);
      else if (grouped)
        atomic_inc(of_pieces + piece_of_face(at.right));
    }
    append_flush(list, APPEND_CAPACITY / 2u);
  }
  append_flush(list, 0u);
  add_count(&sum, counters->pairs_of_two, pairs.x);
  add_count(&sum, counters->pairs_of_two + 1, pairs.y);
  add_count(&sum, counters->pairs_of_two + 2, pairs.z);
  add_count(&sum, counters->pairs_of_two + 3, pairs.w);
}

// One work-item per edge. Lists crossed edges, in any order, and counts them by piece, too; a crossed edge that is a
// piece means that two pieces cross.
kernel void constrain_crossed_edges(uint grouped, uint edges, global const uint* edge_marks, global const uint* near,
                                    global uint* crossed_edges, volatile global uint* of_pieces,
                                    volatile global Counters* counters) {
  DECLARE_APPENDER(list);
  const Appender list = make_appender(list_items, list_gathered, crossed_edges, &counters->crossed_edges);
  FOR_EACH_TILE(tile, edges) {
    const uint e = tile + get_local_id(0);
    if (e < edges && near[2u * e] != GCDT_NONE) {
      append(list, e);
      if (grouped) atomic_inc(of_pieces + near[2u * e]);
      if (edge_marks[e] & GCDT_MARK_CONSTRAINED) atomic_or(&counters->failed, GCDT_FAILED_CROSSING);
    }
    append_flush(list, APPEND_CAPACITY / 2u);
  }
  append_flush(list, 0u);
}

// One work-item per crossed face. Lists hexagons by number, and if gates are made says at those into one that its claim
// word is to be read. No race: numbers are distinct, and a side is one face's.
kernel void constrain_list_hexagons(uint count, uint claim, global const uint* crossed, global uint4* face_data,
                                    global uint* hexagon_face, uint gates_made, global int4* gates_at) {
  FOR_EACH(i, count) {
    const uint face = crossed[i], word = *claim_word(face_data, face);
    if (word < claim) continue;
    hexagon_face[word - claim] = face;
    if (!gates_made) continue;
    const uint4 sides = face_data[GCDT_SIDES(face)];
    for (uint k = 0; k < 3u; ++k) gates_at[element(sides, k)].y |= (int)GCDT_GATE_SIGN;
  }
}

// ---- Chains ----------------------------------------------------------------------------------------
// All left chains in order of the pieces, then all right ones; each chain is a, its owned vertices in
// walk order, b. See left_begin; a and b have distance 0.
//
// Where the edge from a vertex of a chain to the one before it is an edge of the mesh already, not crossed, it is a
// side of the face in which the walk comes to the later vertex, if it left the earlier one there, and both are owned.
// (A piece that is nearer to u on the edge where the walk leaves u behind is nearer on all edges between them that end
// in u: it cannot cross this piece, so it crosses them all. So to own u is the same on each.) No other chain finds the
// same side: who owns both ends there is unique. All other edges between neighbours in chains are left to stitch.cl.

// The side `along` from a chain's vertex to the next, if the first is owned too: its near word stands at `word` on
// the edge where the walk came in, or it is the piece's end. Marks it. No race: the vertex at the exit edge (or, in the
// last face, at the edge where the walk came in) has one owner, and one part of that piece comes there. Both words are
// asked for before either is waited for: who owns nothing there may read one that is being marked, and does nothing.
static inline uint chain_side(volatile global uint* near, uint along, bool from_end, uint word, uint c) {
  const uint at_word = near[word], at_along = near[along];
  if (!(from_end || at_word == c) || at_along != GCDT_NONE) return GCDT_NONE;
  near[along] = NEAR_CHAIN;
  return along;
}

// In the last face, across from whose corner `b` the walk came in: the sides to b from the left and from the right.
static uint2 last_sides(const private Walk* w, Mesh mesh, volatile global uint* near, uint c) {
  const uint4 corners = mesh.face_data[GCDT_CORNERS(w->face)], sides = mesh.face_data[GCDT_SIDES(w->face)];
  const uint k = corners.x == w->b ? 0u : corners.y == w->b ? 1u : 2u, in = element(sides, k);
  return (uint2)(chain_side(near, element(sides, previous_corner(k)), false, in, c),
                 chain_side(near, element(sides, next_corner(k)), false, in ^ 1u, c));
}

// What constrain_own does for `items`, of the parts. Returns how many vertices these own left and right.
GCDT_APART uint2 find_owned(Items items, uint pieces, uint capacity, Mesh mesh, Gates gates, Chunks chunks,
                            volatile global uint* near, global const uint2* ends, global const uint* begins,
                            global const uint* piece_edge, global const int4* lines, global const uint* part_piece,
                            global const uint* part_face, uint ordered, global const uint* order, global uint* counts,
                            volatile global uint* far, global uint2* last, uint claim,
                            volatile global Counters* counters) {
  const uint parts = begins[pieces];
  uint all_left = 0, all_right = 0;
  FOR_ITEMS(i, items) {
    const uint part = ordered ? order[i] : i;
    Owned o = own_nothing(part);
    if (part < parts) {
      const uint c = part_piece[part];
      Walk w;
      uint event = WALK_END;
      if (piece_edge[c] == GCDT_NONE)
        event = walk_begin(&w, mesh, part_face[part], walk_ends(ends[c]), lines[c], part - begins[c],
                           begins[c + 1u] - begins[c]);
      uint word = event == WALK_CROSS ? *claim_word(mesh.face_data, w.face) : 0u;
      // Ends: every edge crossed lies further along the piece.
      while (event == WALK_CROSS) {
        event = end_of_part(&w, mesh, event);
        if (event != WALK_CROSS) break;
        const Gate behind = look_behind(&w, mesh, gates);
        const uint2 at = near_complete((global const uint*)near, w.code);
        if (owns_left(&w, at, c)) own_vertex(chunks, &o, w.code, 0u, w.third_side == 0, counters);
        if (owns_right(&w, at, c)) own_vertex(chunks, &o, w.code, 1u, w.third_side == 0, counters);
        if (w.third_side != 0 && word >= claim)
          reduce_far(far + 3u * (word - claim) + cut_corner(&w, mesh), c, &w, lines, counters);
        word = behind.word;
        event = walk_cross(&w, mesh, behind);
      }
      end_chunk(chunks, &o);
      // The last part comes to b; the one before may, too.
      if (piece_edge[c] == GCDT_NONE && part + 1u == begins[c + 1u] && event == WALK_HIT)
        last[c] = last_sides(&w, mesh, near, c);
    }
    counts[part] = o.left;
    counts[capacity + part] = o.right;
    all_left += o.left;
    all_right += o.right;
  }
  return (uint2)(all_left, all_right);
}

// One work-item per part, as before. Writes where the part owns vertices to chunks, the first of which all parts have,
// and how many are left and right (its own words, the right ones `capacity` behind), and reduces the farthest cut at
// each corner of a hexagon (reduce_far). Of the last face it marks known sides along chains with NEAR_CHAIN. A piece
// that is an edge already crosses nothing. After: counts, 0 beyond the last part; far[3 h + k] is complete; last[c] of
// each piece that was walked.
kernel void constrain_own(uint pieces, uint capacity, uint chunk_capacity, GCDT_MESH_PARAMETERS, GCDT_GATE_PARAMETERS,
                          volatile global uint* near, global const uint2* ends, global const uint* begins,
                          global const uint* piece_edge, global const int4* lines, global const uint* part_piece,
                          global const uint* part_face, uint ordered, global const uint* order, global uint* counts,
                          volatile global uint* far, global ChunkHead* heads, global uint* entries, global uint2* last,
                          uint claim, volatile global Counters* counters) {
  local uint sum;
  const Chunks chunks = {.heads = heads, .entries = entries, .pool = capacity, .capacity = chunk_capacity};
  const uint2 owned = find_owned(items_of_this(capacity), pieces, capacity, make_mesh(n, points, face_data, edge_faces),
                                 make_gates(gates_made, gates_at), chunks, near, ends, begins, piece_edge, lines,
                                 part_piece, part_face, ordered, order, counts, far, last, claim, counters);
  const uint all_left = sum_of_group(&sum, owned.x);
  if (get_local_id(0) == 0 && all_left > 0u) atomic_add(&counters->owned_left, all_left);
  const uint all_right = sum_of_group(&sum, owned.y);
  if (get_local_id(0) == 0 && all_right > 0u) atomic_add(&counters->owned_right, all_right);
}

typedef struct Chains {
  global uint* vertex;
  global ulong* distance;
  global uint* piece;
  global uint* side;  // along the chain to the place before, or GCDT_NONE
} Chains;

// Distance from the line a -> b: |orient2d| < 2^62 for finite vertices, > 0. A symbolic one is farther than
// every finite one, and the farther the greater its symbol.
static inline ulong chain_distance(Vertex a, Vertex b, Vertex v) {
  if (v.symbol != 0) return ((ulong)1 << 62) + (ulong)v.symbol;
  const i64 d = gcdt_orient2d_finite(a, b, v);
  return (ulong)(d < 0 ? -d : d);
}

static void write_chain(Chains chains, uint at, uint v, uint c, ulong distance, uint side) {
  chains.vertex[at] = v;
  chains.piece[at] = c;
  chains.distance[at] = distance;
  chains.side[at] = side;
}

// What constrain_chain does for `items`, of the places in chunks.
GCDT_APART void write_chunks(Items items, uint pieces, uint capacity, Mesh mesh, volatile global uint* near,
                             global const uint* begins, global const int4* lines, global const uint* part_piece,
                             global const uint* starts, global const ChunkHead* heads, global const uint* entries,
                             Chains chains, volatile global Counters* counters) {
  const uint parts = begins[pieces];
  FOR_ITEMS(i, items) {
    const uint j = i % GCDT_CHUNK_LENGTH, own = i / GCDT_CHUNK_LENGTH,
               chunk = own < parts ? own : capacity + (own - parts);
    const ChunkHead head = heads[chunk];
    if (j >= chunk_length(head)) continue;
    const bool right = chunk_right(head, j);
    const uint c = part_piece[head.x], right_before = chunk_rights_before(head, j);
    const uint at = right ? right_begin(starts, capacity, pieces, head.x, c) + 1u + head.z + right_before
                          : left_begin(starts, head.x, c) + 1u + head.y + (j - right_before);
    const uint exit = entries[GCDT_CHUNK_LENGTH * chunk + j], ref = mesh.edge_faces[exit];
    const uint face = GCDT_REF_FACE(ref), third = GCDT_REF_CORNER(ref);
    const uint4 corners = mesh.face_data[GCDT_CORNERS(face)], sides = mesh.face_data[GCDT_SIDES(face)];
    const uint v = element(corners, right ? next_corner(third) : previous_corner(third)),
               across_right = element(sides, next_corner(third)), across_left = element(sides, previous_corner(third));
    const uint side = chain_side(near, right ? across_left : across_right, chunk_from_end(head, j),
                                 right ? across_right ^ 1u : across_left, c);
    const int4 line = lines[c];
    write_chain(chains, at, v, c, chain_distance(line_begin(line), line_end(line), load_vertex(mesh.points, mesh.n, v)),
                side);
    if (v >= mesh.n) atomic_inc(&counters->symbolic_chain_vertices);
  }
}

// One work-item per place in a chunk, of the parts' own and of `taken` from the pool behind them, and one per piece.
// Writes the chunk's vertices to its own range of the chains, the piece's ends around its chains, and marks known sides
// along chains with NEAR_CHAIN. Apart from the walk, which lanes go on with at once. After: the chains are complete.
kernel void constrain_chain(uint pieces, uint taken, uint capacity, GCDT_MESH_PARAMETERS, volatile global uint* near,
                            global const uint2* ends, global const uint* begins, global const uint* piece_edge,
                            global const int4* lines, global const uint* part_piece, global const uint2* last_of_piece,
                            global const uint* starts, global const ChunkHead* heads, global const uint* entries,
                            global uint* chain_vertex, global ulong* chain_distances, global uint* chain_piece,
                            global uint* chain_side_before, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Chains chains = {
      .vertex = chain_vertex, .distance = chain_distances, .piece = chain_piece, .side = chain_side_before};
  write_chunks(items_of_this(GCDT_CHUNK_LENGTH * (begins[pieces] + taken)), pieces, capacity, mesh, near, begins, lines,
               part_piece, starts, heads, entries, chains, counters);
  FOR_EACH(c, pieces) {
    const uint2 e = walk_ends(ends[c]);
    const uint first = begins[c], last = begins[c + 1u];
    const uint2 sides = piece_edge[c] == GCDT_NONE ? last_of_piece[c] : (uint2)(GCDT_NONE, GCDT_NONE);
    write_chain(chains, left_begin(starts, first, c), e.x, c, 0u, GCDT_NONE);
    write_chain(chains, left_begin(starts, last, c) + 1u, e.y, c, 0u, sides.x);
    write_chain(chains, right_begin(starts, capacity, pieces, first, c), e.x, c, 0u, GCDT_NONE);
    write_chain(chains, right_begin(starts, capacity, pieces, last, c) + 1u, e.y, c, 0u, sides.y);
  }
}
