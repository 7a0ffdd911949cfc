// SPDX-License-Identifier: Apache-2.0
// Quality refinement, the second half of a round: candidates claim their cavities, and those that hold all of theirs
// are inserted (docs/refinement.md, A).
#include "common/split_face.h"
#include "refine/star.h"
#include "refine/team.h"

// ---- Precedence -------------------------------------------------------------------------------------------

// The lesser and the greater end of an edge, by (x, y).
static ulong2 ends_of(Mesh mesh, uint e) {
  const uint ref = mesh.edge_faces[2u * e], k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const u64 p = gcdt_tie_key(corner_vertex(mesh, c, next_corner(k))),
            q = gcdt_tie_key(corner_vertex(mesh, c, previous_corner(k)));
  return (ulong2)(min(p, q), max(p, q));
}

// Of candidates with equal keys, is a first? Two points can share a hash, and two subsegments a place. (Two triangles
// with one target are one candidate to all that follows: either may be first.)
static bool comes_before(Mesh mesh, uint4 a, uint4 b) {
  const u64 key_a = gcdt_tie_key(candidate_point(a)), key_b = gcdt_tie_key(candidate_point(b));
  if (key_a != key_b) return key_a < key_b;
  if (!(a.w & GCDT_ON_SUBSEGMENT) || !(b.w & GCDT_ON_SUBSEGMENT)) return false;
  const ulong2 ends_a = ends_of(mesh, a.z), ends_b = ends_of(mesh, b.z);
  return ends_a.x < ends_b.x || (ends_a.x == ends_b.x && ends_a.y < ends_b.y);
}

// One work-item per candidate, in the order of keys. The first of several with one key sorts these, and tells each its
// place in order, by number. (Candidates are claimed and inserted in the order in which they were found, which is that
// of faces: neighbours share cache lines.) All have won until claims are made. And one per subsegment that was asked
// for: its mark goes. No race: a run of equal keys has one first, other work-items write nothing of it, and each word
// of `won` and each mark is of one. After: candidates stand in the order of (key, point, ends), which does not depend
// on how they were found. Ends: each is moved forward at most by the length of its run, which is more than a few where
// many triangles have one target, and then nothing moves.
kernel void refine_rank(uint count, GCDT_MESH_PARAMETERS, global const ulong* keys, global const uint4* candidates,
                        global uint* numbers, global uint* ranks, global uint* won, global const uint* asked,
                        global uint* edge_marks, global const RefineReport* report) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint marked = report->asked;
  FOR_EACH(i, marked) edge_marks[asked[i]] &= ~GCDT_MARK_ASKED;
  FOR_EACH(i, count) {
    const u64 key = keys[i];
    won[i] = 1u;
    if (i > 0u && keys[i - 1u] == key) continue;
    uint end = i + 1u;
    for (; end < count && keys[end] == key; ++end) {
      const uint number = numbers[end];
      uint place = end;
      for (; place > i && comes_before(mesh, candidates[number], candidates[numbers[place - 1u]]); --place)
        numbers[place] = numbers[place - 1u];
      numbers[place] = number;
    }
    for (uint j = i; j < end; ++j) ranks[numbers[j]] = j;
  }
}

// Where a team of work-items counts what comes before its candidate: keys are few, and all are read by all.

#define GCDT_COUNTING_TEAMS 16u  // of a work-group at most

// One team of work-items per candidate. The same as sort and refine_rank, in one launch, for a few thousand candidates:
// its place is how many come before it. Of equal ones by keys, points and ends the one that was found first. No race:
// each candidate has a word of local memory, its place no other has, and its words of `ranks` and `won` are its own.
kernel void refine_count_ranks(uint count, GCDT_MESH_PARAMETERS, global const ulong* keys,
                               global const uint4* candidates, global uint* numbers, global uint* ranks,
                               global uint* won, global const uint* asked, global uint* edge_marks,
                               global const RefineReport* report) {
  local uint before[GCDT_COUNTING_TEAMS];
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint marked = report->asked, items = (uint)get_local_size(0), lanes = min(GCDT_COUNTING_TEAM, items);
  const uint teams = min(GCDT_COUNTING_TEAMS, items / lanes), team = (uint)get_local_id(0) / lanes;
  const uint lane = (uint)get_local_id(0) % lanes;
  FOR_EACH(i, marked) edge_marks[asked[i]] &= ~GCDT_MARK_ASKED;
  FOR_EACH_TILE_OF(tile, teams, count) {
    const uint i = tile + team;
    const bool counts = team < teams && i < count;
    if (team < teams && lane == 0u) before[team] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (counts) {
      const u64 key = keys[i];
      // Eight loads at once: one after the other each would wait for its own.
      uint sum = 0u, equal = 0u, j = lane;
      for (; j + 7u * lanes < count; j += 8u * lanes) {
        u64 other[8];
        for (uint k = 0; k < 8u; ++k) other[k] = keys[j + k * lanes];
        for (uint k = 0; k < 8u; ++k) {
          sum += other[k] < key ? 1u : 0u;
          equal += other[k] == key ? 1u : 0u;
        }
      }
      for (; j < count; j += lanes) {
        sum += keys[j] < key ? 1u : 0u;
        equal += keys[j] == key ? 1u : 0u;
      }
      for (j = lane; equal > 0u && j < count; j += lanes) {
        if (keys[j] != key) continue;
        --equal;
        if (j != i && (comes_before(mesh, candidates[j], candidates[i]) ||
                       (j < i && !comes_before(mesh, candidates[i], candidates[j]))))
          ++sum;
      }
      atomic_add(before + team, sum);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (counts && lane == 0u) {
      const uint place = before[team];
      ranks[i] = place;
      numbers[place] = i;
      won[i] = 1u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// ---- Claims -----------------------------------------------------------------------------------------------

// A face is met once for each of its sides that are looked over.
static void claim_cavity(Mesh mesh, volatile global const uint* marks, uint root, Vertex x, Ticket t,
                         volatile global RefineReport* report) {
  Tour tour = begin_tour(mesh, marks, root, x);
  do claim_face(mesh, tour.face, t);
  while (go_on(&tour));
  if (tour.steps == 0u) atomic_or(&report->failed, 1u);
}

// All that a candidate needs. Of a subsegment: the faces on both sides, whose flags change; the face that x is in if it
// is not these; and the cavities of all. A face in which x is, or on whose unconstrained side, is of a cavity: strictly
// inside a circle is all of the closed face but its corners.
static void claim_all(Mesh mesh, volatile global const uint* marks, uint4 candidate, Ticket t,
                      volatile global RefineReport* report) {
  const Vertex x = candidate_point(candidate);
  const uint kind = kind_of_candidate(candidate);
  if (kind == GCDT_IN_FACE) {
    claim_cavity(mesh, marks, candidate.z, x, t, report);
  } else if (kind == GCDT_ON_EDGE) {
    claim_cavity(mesh, marks, GCDT_REF_FACE(mesh.edge_faces[candidate.z]), x, t, report);
  } else {
    for (uint side = 0; side < 2u; ++side) {
      const uint ref = mesh.edge_faces[2u * candidate.z + side], face = GCDT_REF_FACE(ref);
      if (side_of_circle(mesh, face, x) > 0)
        claim_cavity(mesh, marks, face, x, t, report);
      else
        claim_face(mesh, face, t);
      const uint beyond = code_beyond(mesh, ref, x);
      if (beyond != GCDT_NONE) claim_cavity(mesh, marks, GCDT_REF_FACE(mesh.edge_faces[beyond ^ 1u]), x, t, report);
    }
  }
}

// Whose the block is, by number; GCDT_NONE of a face that aimed in vain, or of whom the list is not whole.
static inline uint candidate_of(global const uint* block, global const uint* chosen, global const uint4* candidates) {
  const uint owner = block[GCDT_BLOCK - 1u];
  if (!(owner & GCDT_OF_SUBSEGMENT)) return chosen[owner];
  return candidates[owner & ~GCDT_OF_SUBSEGMENT].w & GCDT_LISTED ? owner & ~GCDT_OF_SUBSEGMENT : GCDT_NONE;
}

#ifdef GCDT_GPU
// The candidates that are not listed, one by a team.
GCDT_GIVEN_LOCAL void claim_by_teams(Judge judge, uint count, global const uint* ranks, global const uint4* candidates,
                                     Ticket t, volatile global RefineReport* report, volatile local Team* memory,
                                     volatile local uint* busy) {
  const Mesh mesh = judge.mesh;
  const TeamOf of = team_of(memory);
  const TeamList none = {.words = 0, .blocks = 0u, .report = report};
  FOR_EACH_TILE_OF(tile, of.teams, count) {
    const uint i = tile + of.number;
    const bool leads = of.lane == 0u && of.number < of.teams;
    const bool claims = leads && i < count && !(candidates[i].w & GCDT_LISTED);
    if (leads) of.team->pending = 0u;
    if (claims) {
      const uint4 candidate = candidates[i];
      const uint kind = kind_of_candidate(candidate);
      t.place = ranks[i];
      begin_team(of.team, candidate_point(candidate), ~0ul, t.place);
      if (kind & GCDT_ON_SUBSEGMENT)
        add_roots_of_subsegment(mesh, of.team, candidate.z, candidate_point(candidate), none, t);
      else
        add_root(mesh, of.team, kind == GCDT_IN_FACE ? candidate.z : GCDT_REF_FACE(mesh.edge_faces[candidate.z]), true,
                 none, t);
    }
    tour_by_teams(of, judge, none, t, busy);
    if (claims && (of.team->flags & (TEAM_FULL | TEAM_FAILED))) claim_all(mesh, judge.marks, candidates[i], t, report);
  }
}
#endif

// One work-item per candidate that is not listed (on a GPU a team of them, of up to `teamed`), and per block of the
// lists. Claims faces, the later candidate in order with precedence: tickets are places there. Reads the mesh, of
// corners not the claim word beside them. Writes claim words by atomic_max, and won[i] = 0 of those that lose, which
// were 1, by atomics; what they end with does not depend on the order. After: the faces of those with won[i] = 1 are
// disjoint; the last in order is one of them.
kernel void refine_claim(uint count, uint stamp, uint bits, GCDT_MESH_PARAMETERS, global const uint* edge_marks,
                         global const uint* numbers, global const uint* ranks, global const uint4* candidates,
                         uint blocks, global const uint* cavities, global const uint* chosen, volatile global uint* won,
                         volatile global RefineReport* report, uint teamed) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  Ticket t;
  t.stamp = stamp;
  t.bits = bits;
  t.place = 0u;
  t.numbers = numbers;
  t.won = won;
  const uint alone = without_teams(count, teamed);
  FOR_EACH(i, alone) {
    t.place = ranks[i];
    if (!(candidates[i].w & GCDT_LISTED)) claim_all(mesh, edge_marks, candidates[i], t, report);
  }
  FOR_EACH(b, blocks) {
    global const uint* block = cavities + GCDT_BLOCK * b;
    const uint candidate = candidate_of(block, chosen, candidates);
    if (candidate == GCDT_NONE) continue;
    t.place = ranks[candidate];
    for (uint k = 0; k + 1u < GCDT_BLOCK && block[k] != GCDT_NONE; ++k) claim_face(mesh, block[k], t);
  }
#ifdef GCDT_GPU
  local Team memory[GCDT_TEAMS];
  local uint busy;
  Judge judge;
  judge.mesh = mesh;
  judge.marks = (volatile global uint*)edge_marks;
  claim_by_teams(judge, count - alone, ranks, candidates, t, report, memory, &busy);
#endif
}

// One work-item per candidate in order. Of the scan of winners by number: whether it is one. No race: its own word.
kernel void refine_in_order(uint count, global const uint* numbers, global const uint* before, global uint* won) {
  FOR_EACH(i, count) won[i] = before[numbers[i] + 1u] - before[numbers[i]];
}

// One work-item per candidate in order. Of the scan of winners in order: whether it is one of the last `most` of
// these, by number. No race: numbers are a permutation.
kernel void refine_last_in_order(uint count, uint winners, uint most, global const uint* numbers,
                                 global const uint* before, global uint* won) {
  FOR_EACH(i, count) won[numbers[i]] = before[i + 1u] > before[i] && winners - 1u - before[i] < most ? 1u : 0u;
}

// ---- Insertion ----------------------------------------------------------------------------------------------

static inline void set_label(Mesh mesh, uint face, uint label) { mesh.face_data[GCDT_SIDES(face)].w = label; }

static inline void make_subsegment(Insertion in, uint code, uint piece) {
  atomic_or(in.marks + GCDT_SIDE_EDGE(code), GCDT_MARK_CONSTRAINED);
  in.edge_pieces[GCDT_SIDE_EDGE(code)] = piece;
}

// v in face t.
static void insert_in_face(Insertion in, uint v, uint t, uint claim) {
  const uint4 s = in.mesh.face_data[GCDT_SIDES(t)];
  split_face(in.mesh, v, t, claim, false);
  set_label(in.mesh, t, s.w);
  for (uint i = 0; i < 2u; ++i) set_label(in.mesh, new_face(in.mesh, v, i), s.w);
}

// v on edge e.
static void insert_on_edge(Insertion in, uint v, uint e, uint claim) {
  uint face[2], label[2];
  for (uint side = 0; side < 2u; ++side) {
    const uint ref = in.mesh.edge_faces[2u * e + side];
    face[side] = GCDT_REF_FACE(ref);
    label[side] = label_of(in.mesh, face[side]);
  }
  split_edge(in.mesh, v, e, claim, false);
  for (uint side = 0; side < 2u; ++side) {
    set_label(in.mesh, face[side], label[side]);
    set_label(in.mesh, new_face(in.mesh, v, side), label[side]);
  }
}

// v in the face beyond a side of face t that is across from pq's corner r; then the side is flipped, so that v is
// joined to both p and q (fits_beyond).
static void insert_beyond(Insertion in, uint v, uint code, Vertex x, uint claim) {
  const Mesh mesh = in.mesh;
  uint around[4];
  const uint face = GCDT_REF_FACE(mesh.edge_faces[code ^ 1u]), on = side_under(mesh, face, x);
  if (on == 3u)
    insert_in_face(in, v, face, claim);
  else
    insert_on_edge(in, v, GCDT_SIDE_EDGE(element(mesh.face_data[GCDT_SIDES(face)], on)), claim);
  const uint e = GCDT_SIDE_EDGE(code);
  const uint2 refs = ((global const uint2*)mesh.edge_faces)[e];
  flip_edge(mesh, e, refs, mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.x))],
            mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(refs.y))], around);
}

// v for subsegment e = pq: on it, or beside it. Then the triangle v, p, q takes the label from beyond pq, its sides pv
// and vq are the subsegments, and pq is an edge like others.
static void insert_for_subsegment(Insertion in, uint v, uint e, Vertex x, uint claim) {
  const Mesh mesh = in.mesh;
  const uint piece = in.edge_pieces[e], ref = mesh.edge_faces[2u * e];
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const i64 side = gcdt_orient2d_finite(corner_vertex(mesh, c, next_corner(GCDT_REF_CORNER(ref))),
                                        corner_vertex(mesh, c, previous_corner(GCDT_REF_CORNER(ref))), x);
  if (side == 0) {
    insert_on_edge(in, v, e, claim);
    make_subsegment(in, GCDT_SIDE(new_edge(mesh, v, 0u), 0u), piece);
    return;
  }
  const uint near = GCDT_SIDE(e, side > 0 ? 0u : 1u);
  const uint near_ref = mesh.edge_faces[near], t = GCDT_REF_FACE(near_ref), k = GCDT_REF_CORNER(near_ref);
  const uint4 corners = mesh.face_data[GCDT_CORNERS(t)], s = mesh.face_data[GCDT_SIDES(t)];
  const uint beyond = mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(mesh.edge_faces[near ^ 1u]))].w;
  const Vertex p = corner_vertex(mesh, corners, next_corner(k)), q = corner_vertex(mesh, corners, previous_corner(k)),
               r = corner_vertex(mesh, corners, k);
  atomic_and(in.marks + e, ~GCDT_MARK_CONSTRAINED);
  in.edge_pieces[e] = GCDT_NONE;
  const uint other = code_beyond(mesh, near_ref, x);
  if (other != GCDT_NONE)
    insert_beyond(in, v, other, x, claim);
  else if (gcdt_orient2d(q, r, x) == 0)
    insert_on_edge(in, v, GCDT_SIDE_EDGE(element(s, next_corner(k))), claim);
  else if (gcdt_orient2d(r, p, x) == 0)
    insert_on_edge(in, v, GCDT_SIDE_EDGE(element(s, previous_corner(k))), claim);
  else
    insert_in_face(in, v, t, claim);
  const uint between = mesh.edge_faces[near], at = GCDT_REF_CORNER(between);
  const uint4 sides = mesh.face_data[GCDT_SIDES(GCDT_REF_FACE(between))];
  set_label(mesh, GCDT_REF_FACE(between), beyond);
  make_subsegment(in, element(sides, next_corner(at)), piece);
  make_subsegment(in, element(sides, previous_corner(at)), piece);
}

// What a new vertex is put on: the corners of its face, counter-clockwise from the least in (x, y), or the ends of its
// edge in that order, so that it is the same whatever corner the face begins with, and whatever face the walk came
// from; and the piece.
static uint4 origin_of(Mesh mesh, uint4 candidate, global const uint* edge_pieces) {
  if (kind_of_candidate(candidate) == GCDT_IN_FACE) {
    const uint4 c = mesh.face_data[GCDT_CORNERS(candidate.z)];
    const u64 x = gcdt_tie_key(vertex_at(mesh.points, c.x)), y = gcdt_tie_key(vertex_at(mesh.points, c.y)),
              z = gcdt_tie_key(vertex_at(mesh.points, c.z));
    const uint4 from = rotate_to(c, x < y ? (x < z ? 0u : 2u) : (y < z ? 1u : 2u));
    return (uint4)(from.x, from.y, from.z, GCDT_NONE);
  }
  const bool on_edge = kind_of_candidate(candidate) == GCDT_ON_EDGE;
  const uint ref = mesh.edge_faces[on_edge ? candidate.z : 2u * candidate.z], k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const uint p = element(c, next_corner(k)), q = element(c, previous_corner(k));
  const bool first = gcdt_tie_key(vertex_at(mesh.points, p)) < gcdt_tie_key(vertex_at(mesh.points, q));
  return (uint4)(first ? p : q, first ? q : p, GCDT_NONE, on_edge ? GCDT_NONE : edge_pieces[candidate.z]);
}

// The wanted length at a new vertex.
static uint wanted_at(Mesh mesh, uint4 origin, Vertex x, global const uint* sizes) {
  const Vertex a = vertex_at(mesh.points, origin.x), b = vertex_at(mesh.points, origin.y);
  if (origin.z == GCDT_NONE) return gcdt_length_on_edge(a, b, x, sizes[origin.x], sizes[origin.y]);
  return gcdt_length_on_face(a, b, vertex_at(mesh.points, origin.z), x, sizes[origin.x], sizes[origin.y],
                             sizes[origin.z]);
}

// One work-item per candidate; `before` is the scan of the winners by number. Inserts them, numbers their vertices from
// `first` on in the order in which candidates were found, which is that of faces, so that what is near in the mesh is
// near in memory; and makes the stars of these Delaunay. Writes the words of its faces and edges and those that its
// vertex brings, which others do not have (L1: winners' faces are disjoint), and marks of the edges around by atomics.
// Of a face beyond these it reads whose it is, which stays, and all of it if nobody changes it. After: a valid mesh;
// edges that may be illegal are queued, and listed; list_insert[0] is the number of winners.
kernel void refine_insert(uint count, uint first, uint stamp, uint bits, uint sized, GCDT_MESH_PARAMETERS,
                          global uint* edge_marks, global uint* edge_pieces, global const uint* numbers,
                          global const uint* ranks, global const uint4* candidates, global const uint* before,
                          global int2* new_points, uint inputs, global uint4* origins, global uint* sizes,
                          global uint* queue, volatile global Counters* counters,
                          volatile global RefineReport* report) {
  local uint sum;
  Insertion in;
  in.mesh = make_mesh(n, points, face_data, edge_faces);
  in.marks = edge_marks;
  in.edge_pieces = edge_pieces;
  in.queue = queue;
  in.counters = counters;
  in.old_faces = new_face(in.mesh, first, 0u);
  in.round = make_claim(stamp, bits);
  in.numbers = numbers;
  in.before = before;
  uint flips = 0;
  if (get_global_id(0) == 0) counters->list_insert[0] = before[count];
  FOR_EACH(number, count) {
    if (before[number + 1u] == before[number]) continue;
    const uint v = first + before[number], claim = (stamp << bits) | ranks[number];
    const uint4 candidate = candidates[number];
    const Vertex x = candidate_point(candidate);
    const uint4 origin = origin_of(in.mesh, candidate, edge_pieces);
    origins[v - inputs] = origin;
    new_points[v] = (int2)((int)x.x, (int)x.y);
    if (sized) sizes[v] = wanted_at(in.mesh, origin, x, sizes);
    for (uint j = 0; j < 3u; ++j) {
      edge_marks[new_edge(in.mesh, v, j)] = 0u;
      edge_pieces[new_edge(in.mesh, v, j)] = GCDT_NONE;
    }
    const uint kind = kind_of_candidate(candidate);
    if (kind == GCDT_IN_FACE) {
      insert_in_face(in, v, candidate.z, claim);
    } else if (kind == GCDT_ON_EDGE) {
      insert_on_edge(in, v, GCDT_SIDE_EDGE(candidate.z), claim);
    } else {
      atomic_inc(&report->on_subsegments);
      if (gcdt_orient2d_finite(vertex_at(points, origin.x), vertex_at(points, origin.y), x) != 0)
        atomic_inc(&report->bent);
      if (kind & GCDT_FAR) atomic_inc(&report->far);
      insert_for_subsegment(in, v, candidate.z, x, claim);
    }
    flips += settle_star(in, v, x, claim, (kind & GCDT_ON_SUBSEGMENT) != 0u, (candidate.w & GCDT_TIED) != 0u);
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
}
