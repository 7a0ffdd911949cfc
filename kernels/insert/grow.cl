// SPDX-License-Identifier: Apache-2.0
// Phases 1 and 3 for CPUs, where a work-item is a thread's loop over thousands of neighbouring vertices or edges
// (GCDT_CONTIGUOUS): each does what a sequential program would, and meets others only along the border of its share.
//
// Ownership. A work-item takes every face that it changes by try_lock, with one ticket for the whole launch (its
// number, which has as many bits as `bits` says), and keeps it to the launch's end. So no word has two writers (L1), a
// face once taken was not changed in this launch before (what was read of it is right), and what is read of a face that
// is not taken may be worthless, so nothing is concluded from it. What needs a face of another work-item is left to the
// next launch; a launch of one work-item leaves nothing.
#include "common/split_face.h"
#include "flip/flip.h"

// Edges that a work-item remembers while it flips; further ones are queued.
#define GROW_WORKLIST 64

typedef struct Owner {
  Claim claim;
  u32 ticket;
  volatile global uint* marks;
  global uint* queue;  // edges to be tested later, each once
  volatile global uint* queued;
  bool walked;  // others walk through its faces
} Owner;

static inline Owner make_owner(uint stamp, uint bits, global uint* edge_marks, global uint* queue,
                               volatile global uint* queued, bool walked) {
  const Owner o = {.claim = make_claim(stamp, bits),
                   .ticket = (stamp << bits) | (uint)get_global_id(0),
                   .marks = edge_marks,
                   .queue = queue,
                   .queued = queued,
                   .walked = walked};
  return o;
}

// Root p, whose edges no constraint has.
static inline void plant(Mesh mesh, Owner o, uint p) {
  make_root(mesh, p);
  for (uint k = 0; k < 3u; ++k) o.marks[3u * p + k] = 0u;
}

// Few, so that the counter is nobody's burden.
static void leave_edge(Owner o, uint e) {
  if (!(atomic_or(o.marks + e, GCDT_MARK_QUEUED) & GCDT_MARK_QUEUED)) o.queue[atomic_inc(o.queued)] = e;
}

// Whether `face`, whose claim word was read as `word`, is or now becomes the work-item's own. It needs no claim where
// the launch has no other work-item, as the host's have (GCDT_ALONE).
static inline bool own(Mesh mesh, Owner o, uint face, uint word) {
#ifdef GCDT_ALONE
  return true;
#else
  return own_face(mesh, face, word, o.ticket, o.claim);
#endif
}

// ---- Insertion ------------------------------------------------------------------------------------

// What a work-item has done.
typedef struct Grown {
  u32 steps, flips, on_edges;
  bool failed;  // the mesh is wrong: nothing more is inserted
} Grown;

static inline Way way_to(Mesh mesh, Vertex o, uint v) { return gcdt_way_to(o, load_vertex(mesh.points, mesh.n, v)); }

// Visibility walk from face t to the face that holds p in its closure, which becomes the work-item's own; GCDT_NONE
// if another has it, or after `limit` faces. `zero` gets the corner whose opposite edge holds p, or 3. While nobody
// else changes it the mesh is Delaunay, and the walk visits no face twice (L5).
//
// It comes into a face by an edge that p lies strictly behind, so that one corner is new, and two edges are to be
// asked. Where others change faces, it may have come by another edge than it believes: so the face where it ends is
// asked by all its corners, read with the claim word by which it is taken, and the walk goes on if p is not there.
static uint find_and_own(Mesh mesh, Owner o, Vertex p, uint t, uint limit, private uint* steps, private uint* zero) {
  uint left = limit;
  ++*steps;
  for (;;) {
    const uint4 c = mesh.face_data[GCDT_CORNERS(t)];
    const Way x = way_to(mesh, p, c.x), y = way_to(mesh, p, c.y), z = way_to(mesh, p, c.z);
    const i64 ox = gcdt_orient2d_of_ways(y, z), oy = gcdt_orient2d_of_ways(z, x), oz = gcdt_orient2d_of_ways(x, y);
    if (ox >= 0 && oy >= 0 && oz >= 0) {
      *zero = ox == 0 ? 0u : oy == 0 ? 1u : oz == 0 ? 2u : 3u;
      return own(mesh, o, t, c.w) ? t : GCDT_NONE;
    }
    // The edge opposite corner k is crossed; in the next face q is the corner behind the new one, and r the last.
    uint k = ox < 0 ? 0u : oy < 0 ? 1u : 2u;
    Way q = ox < 0 ? z : oy < 0 ? x : y, r = ox < 0 ? y : oy < 0 ? z : x;
    for (bool arrived = false; !arrived;) {
      const uint ref = mesh.edge_faces[face_side(mesh, t, k) ^ 1u];
      if (ref == GCDT_NONE || --left == 0u) return GCDT_NONE;
      t = GCDT_REF_FACE(ref);
      k = GCDT_REF_CORNER(ref);
      const Way d = way_to(mesh, p, face_corner(mesh, t, k));
      const i64 oq = gcdt_orient2d_of_ways(r, d), along = gcdt_orient2d_of_ways(d, q);
      ++*steps;
      if (oq < 0) {
        k = next_corner(k);
        q = d;
      } else if (along < 0) {
        k = previous_corner(k);
        r = d;
      } else {
        *zero = oq == 0 ? next_corner(k) : along == 0 ? previous_corner(k) : 3u;
        arrived = true;
      }
    }
#ifdef GCDT_ALONE
    return t;
#endif
  }
}

// gcdt_must_flip(y, v, x, d) by the ways from v to the others, which have these numbers.
static inline bool must_flip_by_ways(Mesh mesh, Vertex v, Way x, Way y, Way d, uint xn, uint yn, uint dn) {
  if (max(max(xn, yn), dn) < mesh.n) {
    const int s = gcdt_incircle_of_ways(x, d, y);
    if (s != 0) return s > 0;
  }
  return gcdt_must_flip(load_vertex(mesh.points, mesh.n, yn), v, load_vertex(mesh.points, mesh.n, xn),
                        load_vertex(mesh.points, mesh.n, dn));
}

// Flips what v's insertion made illegal: goes once around v, whose star begins with corner 0 of face t. An edge that
// is illegal against a face that cannot be owned is left. That is all: take the edges that cannot be flipped for
// constraints; then the faces that are the work-item's own or nobody's were constrained Delaunay before v, and are so
// again when the edges across from v are legal (as in any incremental insertion). Ends: each pass flips, and takes a
// face into the star, or goes on to the next of the star; so many passes as there are faces twice mean that the mesh is
// wrong.
static void settle_star(Mesh mesh, Owner o, uint v, uint t, private Grown* grown) {
  const Vertex vv = load_vertex(mesh.points, mesh.n, v);
  const uint first = face_corner(mesh, t, 1u);
  uint k = 0, code = face_side(mesh, t, k), xn = first, yn = face_corner(mesh, t, 2u);
  Way x = way_to(mesh, vv, xn), y = way_to(mesh, vv, yn);
  for (uint passes = 2u * gcdt_forest_faces(mesh.n, mesh.roots); passes > 0u; --passes) {
    const uint far = mesh.edge_faces[code ^ 1u];
    bool flipped = false;
    if (far != GCDT_NONE) {
      const uint u = GCDT_REF_FACE(far);
      if (!own(mesh, o, u, *claim_word(mesh.face_data, u))) {
        leave_edge(o, GCDT_SIDE_EDGE(code));
      } else {
        const uint dn = face_corner(mesh, u, GCDT_REF_CORNER(far));
        const Way d = way_to(mesh, vv, dn);
        if (must_flip_by_ways(mesh, vv, x, y, d, xn, yn, dn)) {
          uint around[4];
          flip_side(mesh, code, (uint2)(GCDT_FACE_REF(t, k), far), mesh.face_data[GCDT_CORNERS(t)],
                    mesh.face_data[GCDT_CORNERS(u)], around);
          ++grown->flips;
          // t is now (v, x, d), v still at corner k, opposite what was between x and d.
          code = around[0];
          yn = dn;
          y = d;
          flipped = true;
        }
      }
    }
    if (flipped) continue;
    if (yn == first) return;
    const uint ref = mesh.edge_faces[face_side(mesh, t, next_corner(k)) ^ 1u];
    t = GCDT_REF_FACE(ref);
    k = next_corner(GCDT_REF_CORNER(ref));
    code = face_side(mesh, t, k);
    x = y;
    xn = yn;
    yn = face_corner(mesh, t, previous_corner(k));
    y = way_to(mesh, vv, yn);
  }
  grown->failed = true;
}

// The edges that v brings belong to no constraint. Before they are linked: until then they are nobody else's.
static inline void clear_marks(Mesh mesh, Owner o, uint v) {
  for (uint j = 0; j < 3u; ++j) o.marks[new_edge(mesh, v, j)] = 0u;
}

// Inserts v if all faces that it splits can be owned. Returns the face whose corner 0 v then is, or GCDT_NONE.
static uint split_at(Mesh mesh, Owner o, uint v, uint t, uint zero) {
  if (zero == 3u) {
    clear_marks(mesh, o, v);
    split_face(mesh, v, t, o.ticket, o.walked);
    return t;
  }
  const uint code = element(mesh.face_data[GCDT_SIDES(t)], zero), far = mesh.edge_faces[code ^ 1u];
  const uint u = GCDT_REF_FACE(far);
  if (!own(mesh, o, u, *claim_word(mesh.face_data, u))) return GCDT_NONE;
  clear_marks(mesh, o, v);
  split_edge(mesh, v, GCDT_SIDE_EDGE(code), o.ticket, o.walked);
  return t;
}

// Where the walk to v begins if no vertex of its triangulation was inserted just before: a face that the coarser
// vertex before it on the curve brought, which flips have not moved far away. Any face is right.
static inline uint face_to_begin(GCDT_LEVELS_POINTER levels, uint level, Mesh mesh, uint begin, uint v) {
  if (level > 0u) {
    const uint2 units = coarse_units(levels, level, mesh.points, mesh.n, v);
    const uint unit = max(gcdt_rank_of_vertex(levels, v) / levels->stride[level - 1u], units.x);
    if (unit < units.y) return new_face(mesh, gcdt_vertex_of_rank(levels, level - 1u, unit), 0u);
  }
  return root_of(mesh.points, mesh.n, v);
}

// Inserts v, walking from face `last`. Returns a face of its star, or GCDT_NONE if it is left, or the mesh is wrong.
static uint insert_vertex(Mesh mesh, Owner o, uint v, uint last, uint limit, private Grown* grown) {
  uint zero;
  if (grown->failed) return GCDT_NONE;
  uint t = find_and_own(mesh, o, load_vertex(mesh.points, mesh.n, v), last, limit, &grown->steps, &zero);
  if (t != GCDT_NONE) t = split_at(mesh, o, v, t, zero);
  if (t == GCDT_NONE) return t;
  if (zero != 3u) ++grown->on_edges;
  settle_star(mesh, o, v, t, grown);
  return grown->failed ? GCDT_NONE : t;
}

// What grow_insert does for `items`, of its shares. Returns how many vertices it leaves.
GCDT_APART uint grow_shares(Items items, uint count, uint begin, uint segments, uint step, uint step_before, uint level,
                            uint limit, GCDT_LEVELS_POINTER levels, Mesh mesh, Owner o, global uint* left,
                            global uint* left_of, private Grown* grown) {
  uint left_count = 0;
  FOR_ITEMS(share, items) {
    const uint first = share * step, end = min(first + step, segments), place = share_begin(count, first, segments);
    if (begin == 0u)
      for (uint p = 0; p < mesh.roots; ++p) plant(mesh, o, p);
    uint remaining = 0, last = GCDT_NONE, tree = 0;
    for (uint segment = first; segment < end; segment += step_before) {
      const uint from = share_begin(count, segment, segments);
      const uint to = step == 1u ? share_begin(count, segment + 1u, segments) : from + left_of[segment];
      for (uint i = from; i < to; ++i) {
        const uint v = step == 1u ? begin + i : left[i];
        const uint own_tree = root_of(mesh.points, mesh.n, v);
        if (last == GCDT_NONE || own_tree != tree) last = face_to_begin(levels, level, mesh, begin, v);
        tree = own_tree;
        last = insert_vertex(mesh, o, v, last, limit, grown);
        if (last == GCDT_NONE) left[place + remaining++] = v;
      }
    }
    left_of[first] = remaining;
    left_count += remaining;
  }
  return left_count;
}

// One work-item per share of the vertices begin .. begin + count - 1, of which there were `segments` in the first
// round, where `step` is 1. In later rounds a work-item takes `step` neighbouring segments, and inserts what
// work-items of the round before, with `step_before` segments each, have left of them: along the curve, so that what
// borders of shares kept apart is together. left_of[k] is how many are left of the share that begins with segment k;
// they stand in `left` from that segment's first place on, ascending.
// `level` is that of `begin`. The mesh must be Delaunay. Each vertex is found by a walk from the one before, split
// off, and settled. Writes words of owned faces, and those that its vertices bring; the queue, in any order; `left` and
// left_of of its own segments, no place of which it has still to read: it leaves no more than it has read.
// The launch with begin = 0 is of one segment, and its work-item makes the roots, and the counters zero. With one
// work-item none are left; `limit` then is the number of faces. Ends: see the functions. After: a triangulation in
// which every edge that is not queued is legal.
kernel void grow_insert(uint count, uint begin, uint segments, uint step, uint step_before, uint level, uint limit,
                        uint stamp, uint bits, GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS,
                        global uint* edge_marks, global uint* left, global uint* left_of, global uint* queue,
                        volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Owner o = make_owner(stamp, bits, edge_marks, queue, &counters->list_test[0], true);
  Grown grown = {0u, 0u, 0u, false};
  const Items shares = items_of_this((segments + step - 1u) / step);
  if (begin == 0u && shares.x < shares.y)
    for (uint word = 0; word < sizeof(Counters) / sizeof(uint); ++word) ((volatile global uint*)counters)[word] = 0u;
  const uint left_count = grow_shares(shares, count, begin, segments, step, step_before, level, limit, levels, mesh, o,
                                      left, left_of, &grown);
  if (left_count > 0u) atomic_add(&counters->list_insert[0], left_count);
  add_wide(&counters->steps_low, &counters->steps_high, grown.steps);
  add_wide(&counters->flips_low, &counters->flips_high, grown.flips);
  if (grown.on_edges > 0u) atomic_add(&counters->edge_splits, grown.on_edges);
}

#ifdef GCDT_FOREST

#define PROBLEM_RATIO 4u

// What grow_problems does for `items`, of the problems. Returns how many have a vertex that was not found.
GCDT_APART uint grow_trees(Items items, uint limit, GCDT_LEVELS_POINTER levels, Mesh mesh, Owner o,
                           private Grown* grown) {
  uint lost = 0;
  FOR_ITEMS(p, items) {
    const uint begin = first_rank(mesh.points, mesh.n, p), count = first_rank(mesh.points, mesh.n, p + 1u) - begin;
    uint last = p, stride = 1u;
    plant(mesh, o, p);
    while (stride < count) stride *= PROBLEM_RATIO;
    for (; stride > 0u; stride /= PROBLEM_RATIO)
      for (uint i = 0; i < count && last != GCDT_NONE; i += stride) {
        if (i % (stride * PROBLEM_RATIO) == 0u && stride < count) continue;
        last = insert_vertex(mesh, o, gcdt_vertex_of_rank(levels, levels->count - 1u, begin + i), last, limit, grown);
      }
    if (last == GCDT_NONE) ++lost;
  }
  return lost;
}

// One work-item per problem. Makes its root, and inserts the problem's vertices coarse to fine, every 4^k-th along the
// curve, then every 4^(k-1)-th and so on, each found by a walk from the one before, split off, and settled. No face of
// a problem is reached from another, so none is anybody else's. Writes words of faces and edges of its problem. A
// vertex that is not found is counted in list_insert, and the rest of its problem left out: that cannot be. Ends: the
// stride falls; see the functions. After: every problem is Delaunay.
kernel void grow_problems(uint problems, uint limit, uint stamp, uint bits, GCDT_LEVELS_POINTER levels,
                          GCDT_MESH_PARAMETERS, global uint* edge_marks, global uint* queue,
                          volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Owner o = make_owner(stamp, bits, edge_marks, queue, &counters->list_test[0], false);
  Grown grown = {0u, 0u, 0u, false};
  const uint lost = grow_trees(problems_of_this(problems, first_ranks(points, n)), limit, levels, mesh, o, &grown);
  if (lost > 0u) atomic_add(&counters->list_insert[0], lost);
  add_wide(&counters->steps_low, &counters->steps_high, grown.steps);
  add_wide(&counters->flips_low, &counters->flips_high, grown.flips);
  if (grown.on_edges > 0u) atomic_add(&counters->edge_splits, grown.on_edges);
}
#endif

// ---- Flips ----------------------------------------------------------------------------------------

// Goes on flipping around an edge that was flipped. Ends: each pass takes an edge from the worklist, and only flips
// add edges, as many flips as there are edges at most: further ones are queued, and the host counts its rounds.
static uint settle(Mesh mesh, Owner o, private uint* around) {
  const uint most = gcdt_forest_edges(mesh.n, mesh.roots);
  uint work[GROW_WORKLIST];
  uint size = 0, flips = 0;
  for (;;) {
    for (uint i = 0; i < 4u; ++i) {
      if (size < GROW_WORKLIST && flips < most)
        work[size++] = around[i];
      else
        leave_edge(o, GCDT_SIDE_EDGE(around[i]));
    }
    bool flipped = false;
    while (size > 0u && !flipped) {
      const uint code = work[--size], e = GCDT_SIDE_EDGE(code);
      if (o.marks[e] & GCDT_MARK_CONSTRAINED) continue;
      const uint near = mesh.edge_faces[code], far = mesh.edge_faces[code ^ 1u];
      if (far == GCDT_NONE) continue;
      const uint t = GCDT_REF_FACE(near), u = GCDT_REF_FACE(far);
      if (!own(mesh, o, u, *claim_word(mesh.face_data, u))) {
        leave_edge(o, e);
      } else if (is_illegal(mesh, near, far)) {
        flip_side(mesh, code, (uint2)(near, far), mesh.face_data[GCDT_CORNERS(t)], mesh.face_data[GCDT_CORNERS(u)],
                  around);
        ++flips;
        flipped = true;
      }
    }
    if (!flipped) return flips;
  }
}

// What grow_flip does for `items`, of the edges. Returns the number of flips.
GCDT_APART uint grow_flip_edges(Items items, Mesh mesh, Owner o) {
  uint flips = 0;
  FOR_ITEMS(e, items) {
    if (o.marks[e] & GCDT_MARK_CONSTRAINED) continue;
    const uint2 refs = faces_of_edge(mesh, e);
    if (refs.x == GCDT_NONE || refs.y == GCDT_NONE || !is_illegal(mesh, refs.x, refs.y)) continue;
    const uint t = GCDT_REF_FACE(refs.x), u = GCDT_REF_FACE(refs.y);
    uint4 ct = mesh.face_data[GCDT_CORNERS(t)], cu = mesh.face_data[GCDT_CORNERS(u)];
    if (!own(mesh, o, t, ct.w) || !own(mesh, o, u, cu.w)) {
      leave_edge(o, e);
      continue;
    }
    ct.w = cu.w = o.ticket;
    uint around[4];
    flip_edge(mesh, e, refs, ct, cu, around);
    flips += 1u + settle(mesh, o, around);
  }
  return flips;
}

// One work-item per share of the edges. Tests each that is not constrained, and flips it and what becomes illegal
// around it if it owns the faces; else queues it. An edge found legal whose faces others change is tested by these.
// Writes words of owned faces, marks by atomics, the queue in any order. After: an edge that is not queued is legal or
// constrained.
kernel void grow_flip(uint edges, uint stamp, uint bits, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                      global uint* queue, volatile global Counters* counters) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const Owner o = make_owner(stamp, bits, edge_marks, queue, &counters->list_test[0], true);
  const uint flips = grow_flip_edges(items_of_this(edges), mesh, o);
  add_wide(&counters->flips_low, &counters->flips_high, flips);
}
