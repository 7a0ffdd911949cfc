// SPDX-License-Identifier: Apache-2.0
// Phase 2 for CPUs and batches of small problems: each problem's constraints by one work-item, one after the other,
// while the problem is in its cache. What clean.cl, constrain.cl, retriangulate.cl, stitch.cl and the flips after them
// do for all constraints at once.
//
// The mesh is constrained Delaunay before and after each constraint. One that comes to lie along edges marks these.
// Else the faces that it crosses up to the next vertex on it are made anew: two chains of vertices, left and right of
// it, each triangulated by distance (L7), and the new edges are flipped. No further edge becomes illegal: an edge
// around the crossed faces was constrained Delaunay, and a further constraint only hides vertices from one another.
// A constraint that crosses an edge of one before it is left out, and the mesh is as if it were not there.
//
// Of a forest with one level (order_problems.cpp) the vertices of a problem are consecutive, as those of one problem by
// itself are anyhow, and so are their faces. No word has two writers: all of a problem's are its work-item's, which
// reads no others.
#include "flip/flip.h"
#include "sort/sort_by_one_item.h"

// Numbers of no vertex. A walk did not find what must be there.
#define ENFORCE_FAILED GCDT_NONE
// A constraint that crosses another one's edge.
#define ENFORCE_CROSSES (GCDT_NONE - 1u)
// One that had better begin at its other end: its first vertex has more faces than ENFORCE_STAR.
#define ENFORCE_TURN (GCDT_NONE - 2u)
#define ENFORCE_STAR 64u
// Edges that are remembered while flips go on around one; a further pass finds those beyond.
#define ENFORCE_WORKLIST 64u

// What the work-item of a problem has.
typedef struct Problem {
  Mesh mesh;
  global uint* marks;
  global uint* vertex_face;  // a face of each vertex, always
  global uint4* crossed;     // (face, the edge through which it was entered, vertex << 1 | right, side along the chain)
  global uint4* stack;       // (vertex, side to the one below, distance low, high)
  u32 capacity;              // of `crossed` and `stack`: its faces
  u32 zero_length, hits, existing, owned, pairs, flips;
} Problem;

static inline Vertex vertex_of(const private Problem* p, uint v) { return load_vertex(p->mesh.points, p->mesh.n, v); }

// ---- Triangles --------------------------------------------------------------------------------------

// `around` gets codes of the four edges around.
static void flip_and_know(private Problem* p, uint e, uint2 refs, private uint* around) {
  const uint t = GCDT_REF_FACE(refs.x), u = GCDT_REF_FACE(refs.y);
  const uint4 ct = p->mesh.face_data[GCDT_CORNERS(t)], cu = p->mesh.face_data[GCDT_CORNERS(u)];
  flip_edge(p->mesh, e, refs, ct, cu, around);
  // The ends of the old edge have one of the faces each, those of the new one both.
  const uint4 rt = rotate_to(ct, GCDT_REF_CORNER(refs.x));
  const uint d = element(cu, GCDT_REF_CORNER(refs.y));
  if (rt.x < p->mesh.n) p->vertex_face[rt.x] = t;
  if (rt.y < p->mesh.n) p->vertex_face[rt.y] = t;
  if (rt.z < p->mesh.n) p->vertex_face[rt.z] = u;
  if (d < p->mesh.n) p->vertex_face[d] = u;
  ++p->flips;
}

static inline void set_face(private Problem* p, uint t, uint4 corners, uint4 sides) {
  p->mesh.face_data[GCDT_CORNERS(t)] = corners;
  p->mesh.face_data[GCDT_SIDES(t)] = sides;
  p->mesh.edge_faces[sides.x] = GCDT_FACE_REF(t, 0u);
  p->mesh.edge_faces[sides.y] = GCDT_FACE_REF(t, 1u);
  p->mesh.edge_faces[sides.z] = GCDT_FACE_REF(t, 2u);
  p->vertex_face[corners.x] = t;
  p->vertex_face[corners.y] = t;
  p->vertex_face[corners.z] = t;
}

// One side of a constraint whose crossed faces are made anew. The stack holds the vertices so far that no triangle has
// covered yet, by growing distance.
typedef struct Chain {
  u32 top;           // of the stack
  u32 right;         // 1: right of the constraint
  u32 base;          // the right side of the constraint's edge, which the left chain makes
  u32 slots, edges;  // of `crossed`, used so far by both
} Chain;

// The next vertex of the chain, `code` being the inner side along the edge to it from the one before. What is not
// nearer becomes the apex of a triangle between its neighbours. Ends: the stack gets shorter.
static void chain_add(private Problem* p, private Chain* chain, uint q, uint code, u64 distance) {
  while (chain->top > 0u) {
    const uint4 i = p->stack[chain->top], below = p->stack[chain->top - 1u];
    if (((u64)i.z | (u64)i.w << 32) < distance) break;
    const uint t = p->crossed[chain->slots++].x;
    const bool last = distance == 0u && chain->top == 1u;
    uint base = chain->base, beyond = GCDT_NONE;
    if (!last || !chain->right) {
      const uint e = p->crossed[++chain->edges].y;
      p->marks[e] = last ? GCDT_MARK_CONSTRAINED : 0u;
      base = GCDT_SIDE(e, 0u);
      beyond = GCDT_SIDE(e, 1u);
      if (last) chain->base = beyond;
    }
    if (chain->right)
      set_face(p, t, (uint4)(q, below.x, i.x, 0u), (uint4)(i.y, code, base, 0u));
    else
      set_face(p, t, (uint4)(below.x, q, i.x, 0u), (uint4)(code, i.y, base, 0u));
    code = beyond;
    --chain->top;
  }
  p->stack[++chain->top] = (uint4)(q, code, (uint)distance, (uint)(distance >> 32));
}

static inline u64 distance_from(const private Problem* p, Vertex a, Vertex b, uint v) {
  const i64 d = gcdt_orient2d_finite(a, b, vertex_of(p, v));
  return (u64)(d < 0 ? -d : d);
}

// Flips the new edges, `count` of them, and what becomes illegal around those, but no constraint's: passes over all
// alone would be as many as the longest chain of flips. Ends: each pass of the inner loop takes an edge from the
// worklist, and only flips add edges; a further pass of the outer one is after flips (L4).
static void settle_crossed(private Problem* p, uint count) {
  bool left = true;
  while (left) {
    left = false;
    for (uint i = 1; i <= count; ++i) {
      uint work[ENFORCE_WORKLIST];
      uint size = 1;
      work[0] = p->crossed[i].y;
      while (size > 0u) {
        const uint e = work[--size];
        if (p->marks[e] & GCDT_MARK_CONSTRAINED) continue;
        const uint2 refs = faces_of_edge(p->mesh, e);
        if (refs.x == GCDT_NONE || refs.y == GCDT_NONE || !is_illegal(p->mesh, refs.x, refs.y)) continue;
        uint around[4];
        flip_and_know(p, e, refs, around);
        for (uint k = 0; k < 4u; ++k)
          if (size < ENFORCE_WORKLIST)
            work[size++] = GCDT_SIDE_EDGE(around[k]);
          else
            left = true;
      }
    }
  }
}

// An edge that is part of a constraint as it is. Some are part of several.
static inline void mark_existing(private Problem* p, uint e) {
  p->existing += p->marks[e] & GCDT_MARK_CONSTRAINED ? 0u : 1u;
  p->marks[e] = GCDT_MARK_CONSTRAINED;
}

// ---- One constraint -----------------------------------------------------------------------------------

// Makes an edge from a towards b, through corner k of face t, across from which a piece of the constraint leaves it;
// but only if the edge reaches b, unless `part`. Returns the vertex at its other end, or what went wrong, and then has
// changed nothing. Ends: each face lies further along.
static uint cross(private Problem* p, uint a, uint b, uint t, uint k, bool part) {
  const Mesh mesh = p->mesh;
  const Vertex va = vertex_of(p, a), vb = vertex_of(p, b);
  const uint4 first = rotate_to(mesh.face_data[GCDT_CORNERS(t)], k), side = rotate_to(mesh.face_data[GCDT_SIDES(t)], k);
  if (max(first.y, first.z) >= mesh.n) return ENFORCE_FAILED;
  uint count = 0, code = side.x, end, end_left, end_right;
  p->crossed[0] = (uint4)(t, GCDT_NONE, 0u, 0u);
  for (;;) {
    const uint e = GCDT_SIDE_EDGE(code), ref = mesh.edge_faces[code ^ 1u];
    if (p->marks[e] & GCDT_MARK_CONSTRAINED) return ENFORCE_CROSSES;
    if (ref == GCDT_NONE || count + 2u >= p->capacity) return ENFORCE_FAILED;
    // In the face behind, (z, left, right), the side of z decides.
    const uint u = GCDT_REF_FACE(ref), j = GCDT_REF_CORNER(ref);
    const uint4 c = rotate_to(mesh.face_data[GCDT_CORNERS(u)], j), s = rotate_to(mesh.face_data[GCDT_SIDES(u)], j);
    if (c.x >= mesh.n) return ENFORCE_FAILED;
    const i64 o = gcdt_orient2d_finite(va, vb, vertex_of(p, c.x));
    p->crossed[++count] = (uint4)(u, e, c.x << 1 | (o < 0 ? 1u : 0u), o > 0 ? s.z : s.y);
    if (o == 0) {
      end = c.x, end_left = s.z, end_right = s.y;
      break;
    }
    code = o > 0 ? s.y : s.z;
  }
  if (end != b && !part) return end;
  p->pairs += count + 1u;
  if (count == 1u) {  // across one edge lies a strictly convex quadrilateral
    const uint e = p->crossed[1].y;
    uint around[4];
    flip_and_know(p, e, faces_of_edge(mesh, e), around);
    p->marks[e] = GCDT_MARK_CONSTRAINED;
    p->owned += 2u;
    return end;
  }
  Chain chain;
  chain.slots = chain.edges = chain.base = 0u;
  for (uint right = 0; right < 2u; ++right) {
    chain.right = right;
    chain.top = 0u;
    p->stack[0] = (uint4)(a, GCDT_NONE, 0u, 0u);
    const uint v = right ? first.y : first.z;
    chain_add(p, &chain, v, right ? side.z : side.y, distance_from(p, va, vb, v));
    for (uint i = 1; i < count; ++i) {
      const uint4 c = p->crossed[i];
      if ((c.z & 1u) == right) chain_add(p, &chain, c.z >> 1, c.w, distance_from(p, va, vb, c.z >> 1));
    }
    chain_add(p, &chain, end, right ? end_right : end_left, 0u);
  }
  p->owned += count + 1u;
  settle_crossed(p, count);
  return end;
}

// Where a walk around a vertex is: a face of its star, and the corner at the vertex.
typedef struct Place {
  u32 face, corner;
} Place;

static inline Place place_at(Mesh mesh, uint face, uint a) {
  Place at;
  at.face = face;
  at.corner = (uint)(face_corner(mesh, face, 1u) == a) | (uint)(face_corner(mesh, face, 2u) == a) << 1;
  return at;
}

// The next face counter-clockwise: the star is closed.
static inline Place next_around(Mesh mesh, Place at) {
  const uint ref = mesh.edge_faces[face_side(mesh, at.face, next_corner(at.corner)) ^ 1u];
  at.face = GCDT_REF_FACE(ref);
  at.corner = next_corner(GCDT_REF_CORNER(ref));
  return at;
}

// The edge from the vertex to the face's next corner.
static inline uint edge_at(Mesh mesh, Place at) {
  return GCDT_SIDE_EDGE(face_side(mesh, at.face, previous_corner(at.corner)));
}

// Makes the constraint from a towards b edges up to the first vertex on it, but only if that is b, unless `part`.
// Returns that vertex, or what went wrong; or ENFORCE_TURN, if a has more than `most` faces and b is not among the
// first. Ends: it goes once around a, twice at most, whose star is closed.
static uint enforce_piece(private Problem* p, uint a, uint b, uint most, bool part) {
  const Mesh mesh = p->mesh;
  const uint begin = p->vertex_face[a];
  Place at = place_at(mesh, begin, a);
  uint faces = 0;
  do {  // most constraints are edges already
    if (faces++ == most) return ENFORCE_TURN;
    if (face_corner(mesh, at.face, next_corner(at.corner)) == b) {
      mark_existing(p, edge_at(mesh, at));
      return b;
    }
    at = next_around(mesh, at);
  } while (at.face != begin);
  const Vertex va = vertex_of(p, a), vb = vertex_of(p, b);
  do {  // the edge a-x, or between x and y
    const uint x = face_corner(mesh, at.face, next_corner(at.corner)),
               y = face_corner(mesh, at.face, previous_corner(at.corner));
    const i64 right = gcdt_orient2d(va, vb, vertex_of(p, x));
    if (right <= 0 && gcdt_orient2d(va, vb, vertex_of(p, y)) > 0) {
      if (right < 0) return cross(p, a, b, at.face, at.corner, part);
      if (part) mark_existing(p, edge_at(mesh, at));
      return x;
    }
    at = next_around(mesh, at);
  } while (at.face != begin);
  return ENFORCE_FAILED;
}

// Makes the constraint from a to b edges and returns how many, 0 if it has no length; or what went wrong, and then has
// changed nothing. One with a vertex on it is looked at to its end first, where of its pieces only that is made which
// was reached last. Ends: twice, it turns once, and each piece lies further along.
static uint enforce(private Problem* p, uint a, uint b) {
  uint pieces = 0;
  for (uint part = 0; part < 2u && (part == 0u || pieces > 1u); ++part) {
    uint from = a, to = b, most = ENFORCE_STAR;
    pieces = 0;
    while (from != to) {
      const uint next = enforce_piece(p, from, to, most, part == 1u);
      if (next == ENFORCE_FAILED || next == ENFORCE_CROSSES) return next;
      if (next == ENFORCE_TURN) {
        const uint end = from;
        from = to, to = end;
        most = GCDT_NONE;
      } else {
        from = next;
        ++pieces;
      }
    }
  }
  return pieces;
}

static inline void know_face(private Problem* p, uint t) {
  const uint4 c = p->mesh.face_data[GCDT_CORNERS(t)];
  if (c.x < p->mesh.n) p->vertex_face[c.x] = t;
  if (c.y < p->mesh.n) p->vertex_face[c.y] = t;
  if (c.z < p->mesh.n) p->vertex_face[c.z] = t;
}

// Fills vertex_face of vertices begin .. end - 1: all of the problem.
static void know_faces(private Problem* p, uint problem, uint begin, uint end) {
  know_face(p, problem);
  for (uint t = new_face(p->mesh, begin, 0u); t < new_face(p->mesh, end, 0u); ++t) know_face(p, t);
}

// What enforce_problems does for `trees`; `crossed` and `stack` have room for all. Returns failure bits, and counts in
// *done.
GCDT_APART uint enforce_trees(Items trees, Mesh mesh, uint inputs, uint all, global const uint* first_constraint,
                              global const uint2* constraints, global const uint* input_vertex, global uint* edge_marks,
                              global uint* vertex_face, global uint4* crossed, global uint4* stack,
                              global uint* pieces_of, global uint* crosses, private Problem* done) {
  Problem p;
  p.mesh = mesh;
  p.marks = edge_marks;
  p.vertex_face = vertex_face;
  p.zero_length = p.hits = p.existing = p.owned = p.pairs = p.flips = 0u;
  uint failed = 0;
  FOR_ITEMS(i, trees) {
    const uint begin = first_rank(mesh.points, mesh.n, i), end = first_rank(mesh.points, mesh.n, i + 1u);
    // Faces: two of each vertex, and the root.
    p.crossed = crossed + gcdt_forest_faces(begin, i);
    p.stack = stack + gcdt_forest_faces(begin, i);
    p.capacity = gcdt_forest_faces(end - begin, 1u);
    bool stopped = false;
    if (first_constraint[i] != first_constraint[i + 1u]) know_faces(&p, i, begin, end);
    for (uint c = first_constraint[i]; c < first_constraint[i + 1u]; ++c) {
      const uint2 in = constraints[c];
      if (in.x >= inputs || in.y >= inputs) {
        failed |= GCDT_FAILED_INDEX;
        stopped = true;
      }
      const uint pieces = stopped ? 0u : enforce(&p, input_vertex[in.x], input_vertex[in.y]);
      const bool one_crosses = pieces == ENFORCE_CROSSES, lost = pieces == ENFORCE_FAILED;
      if (one_crosses) failed |= GCDT_FAILED_CROSSING;
      if (lost) failed |= GCDT_FAILED_WALK;
      if (pieces == 0u && !stopped) ++p.zero_length;
      pieces_of[c] = one_crosses || lost ? 0u : pieces;
      p.hits += pieces_of[c] > 1u ? pieces_of[c] - 1u : 0u;
      crosses[c] = one_crosses ? 1u : 0u;
      stopped = stopped || lost || (one_crosses && !all);
    }
  }
  *done = p;
  return failed;
}

// One work-item per problem. Enforces its constraints, in the Delaunay mesh of its vertices, but for those that cross
// an earlier one; and if they do and not `all`, but for those that follow. Writes words of its problem; pieces_of[c]:
// of how many edges constraint c is made, 0 if it is left out or has no length; crosses[c]: 1 if it crosses an earlier
// one that was enforced, else 0. Ends: see the functions. After: the mesh is constrained Delaunay;
// GCDT_FAILED_CROSSING: some word of `crosses` is 1; GCDT_FAILED_WALK: the mesh is void; GCDT_FAILED_INDEX: an end is
// not below `inputs`, and constraints from there on are left out.
kernel void enforce_problems(uint problems, uint inputs, uint all, GCDT_MESH_PARAMETERS,
                             global const uint* first_constraint, global const uint2* constraints,
                             global const uint* input_vertex, global uint* edge_marks, global uint* vertex_face,
                             global uint4* crossed, global uint4* stack, global uint* pieces_of, global uint* crosses,
                             volatile global Counters* counters) {
  Problem done;
  const uint failed = enforce_trees(trees_of_this(problems, points, n), make_mesh(n, points, face_data, edge_faces),
                                    inputs, all, first_constraint, constraints, input_vertex, edge_marks, vertex_face,
                                    crossed, stack, pieces_of, crosses, &done);
  if (failed) atomic_or(&counters->failed, failed);
  atomic_add(&counters->zero_length, done.zero_length);
  atomic_add(&counters->hits, done.hits);
  atomic_add(&counters->existing_edges, done.existing);
  atomic_add(&counters->owned_left, done.owned);
  add_wide(&counters->pairs_low, &counters->pairs_high, done.pairs);
  add_wide(&counters->flips_low, &counters->flips_high, done.flips);
}

// ---- Pieces -------------------------------------------------------------------------------------------

// The vertex next to a on the constraint from a to b, all of which is edges. Ends: as in enforce.
static uint next_on(Mesh mesh, global const uint* vertex_face, uint a, uint b) {
  const Vertex va = load_vertex(mesh.points, mesh.n, a), vb = load_vertex(mesh.points, mesh.n, b);
  const uint begin = vertex_face[a];
  Place at = place_at(mesh, begin, a);
  do {
    const uint x = face_corner(mesh, at.face, next_corner(at.corner)),
               y = face_corner(mesh, at.face, previous_corner(at.corner));
    if (gcdt_orient2d(va, vb, load_vertex(mesh.points, mesh.n, x)) == 0 &&
        gcdt_orient2d(va, vb, load_vertex(mesh.points, mesh.n, y)) > 0)
      return x;
    at = next_around(mesh, at);
  } while (at.face != begin);
  return b;
}

// What enforce_pieces does for `trees`.
GCDT_APART void list_pieces(Items trees, GCDT_LEVELS_POINTER levels, Mesh mesh, global const uint* first_constraint,
                            global const uint2* constraints, global const uint* input_vertex,
                            global const uint* vertex_face, global const uint* offsets, global uint* places,
                            global ulong* unsorted_keys, global uint* unsorted_sources, global ulong* keys,
                            global uint* sources) {
  FOR_ITEMS(i, trees) {
    const uint begin = first_rank(mesh.points, mesh.n, i), end = first_rank(mesh.points, mesh.n, i + 1u);
    const uint first = offsets[first_constraint[i]], last = offsets[first_constraint[i + 1u]];
    for (uint v = begin; v < end; ++v) places[v] = 0u;
    for (uint c = first_constraint[i]; c < first_constraint[i + 1u]; ++c) {
      uint a = input_vertex[constraints[c].x];
      const uint b = input_vertex[constraints[c].y];
      for (uint at = offsets[c]; at < offsets[c + 1u]; ++at) {
        const uint to = at + 1u == offsets[c + 1u] ? b : next_on(mesh, vertex_face, a, b);
        const uint from_rank = gcdt_rank_of_vertex(levels, a), to_rank = gcdt_rank_of_vertex(levels, to);
        unsorted_keys[at] = (ulong)min(from_rank, to_rank) << 32 | max(from_rank, to_rank);
        unsorted_sources[at] = c;
        ++places[min(from_rank, to_rank)];
        a = to;
      }
    }
    for (uint v = begin, sum = first; v < end; ++v) {
      const uint count = places[v];
      places[v] = sum;
      sum += count;
    }
    for (uint at = first; at < last; ++at) {
      const ulong key = unsorted_keys[at];
      const uint to = places[(uint)(key >> 32)]++;
      keys[to] = key;
      sources[to] = unsorted_sources[at];
    }
    for (uint v = begin, from = first; v < end; ++v) {  // places[v] is where v's pieces end
      sort_run_below(places[v] - from, 32u, keys + from, sources + from, unsorted_keys + from, unsorted_sources + from);
      from = places[v];
    }
  }
}

// One work-item per problem. Writes its pieces, in order of lower rank, higher rank, source: `keys` (lower << 32 |
// higher) and sources, from offsets[first_constraint] on, as many as they are. By counting the lower ends, and for the
// pieces of each, mostly few, by insertion or by digits. `places`: a word per vertex, void afterwards, as are the
// unsorted ones. Writes words of its problem. After: as clean_pieces and a stable sort.
kernel void enforce_pieces(uint problems, GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS,
                           global const uint* first_constraint, global const uint2* constraints,
                           global const uint* input_vertex, global const uint* vertex_face, global const uint* offsets,
                           global uint* places, global ulong* unsorted_keys, global uint* unsorted_sources,
                           global ulong* keys, global uint* sources) {
  list_pieces(trees_of_this(problems, points, n), levels, make_mesh(n, points, face_data, edge_faces), first_constraint,
              constraints, input_vertex, vertex_face, offsets, places, unsorted_keys, unsorted_sources, keys, sources);
}

// One work-item per distinct piece. Writes its ends, lower rank first. No race: its own words.
kernel void enforce_ends(uint count, GCDT_LEVELS_POINTER levels, global const ulong* keys, global const uint* firsts,
                         global uint2* ends) {
  const uint last = levels->count - 1u;
  FOR_EACH(i, count) {
    const ulong key = keys[firsts[i]];
    ends[i] =
        (uint2)(gcdt_vertex_of_rank(levels, last, (uint)(key >> 32)), gcdt_vertex_of_rank(levels, last, (uint)key));
  }
}
