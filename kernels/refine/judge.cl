// SPDX-License-Identifier: Apache-2.0
// Quality refinement, the first half of a round: which triangles and subsegments are to be mended, and by which
// vertices. Nothing of the mesh changes but marks (docs/refinement.md, A).
#include "refine/candidates.h"
#include "refine/wait.h"

// Verdicts beyond the reasons to leave a triangle (GCDT_LEFT_...).
#define VERDICT_FINE 16u
#define VERDICT_SHARP 17u
#define VERDICT_LARGE 18u

#define JUDGE_PARAMETERS                                                                                      \
  GCDT_MESH_PARAMETERS, global const RefineRules *given_rules, volatile global uint *edge_marks, uint inputs, \
      global const uint4 *origins, global const uint2 *pieces, global const uint *sizes, global const ulong *areas

typedef struct Judge {
  Mesh mesh;
  RefineRules rules;
  volatile global uint* marks;
  Origins origins;
  global const uint2* pieces;
  global const uint* edge_pieces;  // this and the next one only for find_place
  global const uint* sharp;
  global const uint* sizes;   // by vertex, if rules.sized
  global const ulong* areas;  // by label less 1, if rules.by_label: the largest doubled areas
} Judge;

#define MAKE_JUDGE(judge)                                   \
  Judge judge;                                              \
  judge.mesh = make_mesh(n, points, face_data, edge_faces); \
  judge.rules = *given_rules;                               \
  judge.marks = edge_marks;                                 \
  judge.origins.inputs = inputs;                            \
  judge.origins.of = origins;                               \
  judge.pieces = pieces;                                    \
  judge.edge_pieces = judge.sharp = 0;                      \
  judge.sizes = sizes;                                      \
  judge.areas = areas

typedef struct Judged {
  uint verdict;
  Shape shape;
  uint4 corners;
} Judged;

// Do u and v lie on two pieces with a common end, about as far from it? (Miller, Pav and Walkington: between
// constraints that meet at a small angle such a side cannot be mended.)
static bool beside_angle(Judge judge, uint u, uint v) {
  const uint pu = piece_under(judge.origins, u), pv = piece_under(judge.origins, v);
  if (pu == GCDT_NONE || pv == GCDT_NONE || pu == pv) return false;
  const uint2 a = judge.pieces[pu], b = judge.pieces[pv];
  const uint z = a.x == b.x || a.x == b.y ? a.x : a.y == b.x || a.y == b.y ? a.y : GCDT_NONE;
  if (z == GCDT_NONE) return false;
  const Vertex end = vertex_at(judge.mesh.points, z);
  const u64 du = gcdt_square_root(gcdt_squared_length(end, vertex_at(judge.mesh.points, u))),
            dv = gcdt_square_root(gcdt_squared_length(end, vertex_at(judge.mesh.points, v)));
  const u64 most = max(du, dv), least = min(du, dv);
  return most - least <= 2u + most / 512u;
}

// Of a kept face.
static Judged judge_face(Judge judge, uint face) {
  Judged j;
  const Mesh mesh = judge.mesh;
  const uint4 c = j.corners = mesh.face_data[GCDT_CORNERS(face)], s = mesh.face_data[GCDT_SIDES(face)];
  j.shape = gcdt_shape(vertex_at(mesh.points, c.x), vertex_at(mesh.points, c.y), vertex_at(mesh.points, c.z));
  const u64 wanted = judge.rules.sized ? (u64)judge.sizes[c.x] + judge.sizes[c.y] + judge.sizes[c.z] : 0u;
  const bool sharp = gcdt_is_sharp(j.shape, judge.rules);
  const u64 most_area =
      judge.rules.by_label ? min(judge.rules.most_area, judge.areas[s.w - 1u]) : judge.rules.most_area;
  const bool large = gcdt_is_large(j.shape, most_area, judge.rules.sized, wanted);
  j.verdict = VERDICT_FINE;
  if (!sharp && !large) return j;
  uint excuse = VERDICT_FINE;
  const uint k = j.shape.corner;
  if (sharp) {
    if (is_constrained(judge.marks, element(s, next_corner(k))) &&
        is_constrained(judge.marks, element(s, previous_corner(k))))
      excuse = GCDT_LEFT_INPUT_ANGLE;
    else if (beside_angle(judge, element(c, next_corner(k)), element(c, previous_corner(k))))
      excuse = GCDT_LEFT_BESIDE_ANGLE;
  }
  const bool excused = sharp && excuse != VERDICT_FINE;
  if (excused && !large)
    j.verdict = excuse;
  else if (j.shape.shortest < judge.rules.least_squared)
    j.verdict = GCDT_LEFT_GRID;
  else
    j.verdict = sharp && !excused ? VERDICT_SHARP : VERDICT_LARGE;
  return j;
}

// ---- Places on subsegments ------------------------------------------------------------------------------

// Is m in the closed face beyond an unconstrained side, no corner, and on no constrained side? Outside the domain,
// where faces are as good as any other cover, a vertex may be there, if the side can be flipped then: r and the vertex
// are on either side of the line on which the side's ends are. So what is beside a border does not hide its places, nor
// do the rays that bound symbolic faces.
static bool fits_beyond(Mesh mesh, volatile global const uint* marks, uint code, Vertex m) {
  if (is_constrained(marks, code)) return false;
  const uint face = GCDT_REF_FACE(mesh.edge_faces[code ^ 1u]), on = side_under(mesh, face, m);
  if (on == GCDT_NONE) return false;
  return on == 3u || !is_constrained(marks, element(mesh.face_data[GCDT_SIDES(face)], on));
}

// m on the side of directed edge p -> q that face (p, q, r) lies on, strictly: is it in the closed face, no corner, and
// on no constrained side? `ref` is the face with its corner r.
static bool fits_face(Mesh mesh, volatile global const uint* marks, uint ref, Vertex m) {
  const uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref);
  const uint4 c = mesh.face_data[GCDT_CORNERS(face)], s = mesh.face_data[GCDT_SIDES(face)];
  const Vertex p = corner_vertex(mesh, c, next_corner(k)), q = corner_vertex(mesh, c, previous_corner(k)),
               r = corner_vertex(mesh, c, k);
  const i64 beside_p = gcdt_orient2d(q, r, m), beside_q = gcdt_orient2d(r, p, m);
  if (s.w == 0u && beside_p < 0 && beside_q > 0)
    return gcdt_orient2d(p, m, r) > 0 && fits_beyond(mesh, marks, element(s, next_corner(k)), m);
  if (s.w == 0u && beside_q < 0 && beside_p > 0)
    return gcdt_orient2d(m, q, r) > 0 && fits_beyond(mesh, marks, element(s, previous_corner(k)), m);
  if (beside_p < 0 || beside_q < 0 || (beside_p == 0 && beside_q == 0)) return false;
  // The side across from p ends in q and r.
  if (beside_p == 0) return !is_constrained(marks, element(s, next_corner(k)));
  if (beside_q == 0) return !is_constrained(marks, element(s, previous_corner(k)));
  return true;
}

// May subsegment pq, the edge e, be split at m? Its near face is that of side 0, on which p -> q runs forward.
static bool is_valid_place(Mesh mesh, volatile global const uint* marks, uint e, Vertex p, Vertex q, Vertex m) {
  const i64 side = gcdt_orient2d_finite(p, q, m);
  if (side == 0) return gcdt_dot(m, p, q) < 0;
  return fits_face(mesh, marks, mesh.edge_faces[2u * e + (side > 0 ? 0u : 1u)], m);
}

// The h-th of five attempts around place k: k, k + h, k - h, k + 2h, k - 2h.
static inline i64 attempt(i64 k, i64 step, uint number) {
  const i64 away = (number + 1u) / 2u * step;
  return number % 2u == 1u ? k + away : k - away;
}

typedef struct Place {
  bool found, far;  // far: rounded the other way
  Vertex at;
  u64 squared;  // the length of the subsegment
} Place;

// Where subsegment e can be split.
static Place find_place(Judge judge, uint e) {
  const Mesh mesh = judge.mesh;
  const uint ref = mesh.edge_faces[2u * e], number = judge.edge_pieces[e];
  const uint4 c = mesh.face_data[GCDT_CORNERS(GCDT_REF_FACE(ref))];
  const uint vp = element(c, next_corner(GCDT_REF_CORNER(ref))), vq = element(c, previous_corner(GCDT_REF_CORNER(ref)));
  const Vertex p = vertex_at(mesh.points, vp), q = vertex_at(mesh.points, vq);
  Place place;
  place.found = place.far = false;
  place.at = p;
  place.squared = gcdt_squared_length(p, q);
  const uint2 ends = judge.pieces[number];
  const Piece piece = gcdt_piece(vertex_at(mesh.points, ends.x), vertex_at(mesh.points, ends.y));
  const i64 kp = gcdt_place_of(piece, p), kq = gcdt_place_of(piece, q), low = min(kp, kq), high = max(kp, kq);
  const uint sharp_ends = judge.sharp[number];
  const bool p_sharp = (vp == ends.x && (sharp_ends & 1u)) || (vp == ends.y && (sharp_ends & 2u)),
             q_sharp = (vq == ends.x && (sharp_ends & 1u)) || (vq == ends.y && (sharp_ends & 2u));
  i64 k = (low + high) / 2;
  if (p_sharp != q_sharp) {
    const i64 shell = gcdt_shell(piece, place.squared);
    k = (p_sharp ? kp : kq) == 0 ? shell : piece.along - shell;
  }
  const i64 step = max((i64)1, (high - low) / 16);
  const bool border =
      label_of(mesh, GCDT_REF_FACE(ref)) == 0u || label_of(mesh, GCDT_REF_FACE(mesh.edge_faces[2u * e + 1u])) == 0u;
  // Not shorter than wanted: refused. Else five places, and beside a border five that are rounded the other way.
  const uint attempts = place.squared / 4u < judge.rules.least_squared ? 0u : border ? 10u : 5u;
  for (uint at = 0; at < attempts && !place.found; ++at) {
    const i64 tried = attempt(k, step, at % 5u);
    if (tried <= low || tried >= high) continue;
    place.far = at >= 5u;
    place.at = gcdt_at_place(piece, tried, place.far);
    place.found = is_valid_place(mesh, judge.marks, e, p, q, place.at);
  }
  return place;
}

// ---- Aims -----------------------------------------------------------------------------------------------

// What comes of a triangle that is to be mended.
typedef struct Aim {
  Vertex target;
  Arrival at;
  bool wanted;  // a candidate
  bool failed;
  bool sits_out;  // its cavity has more faces than it may look at in this round
  uint in_way;    // subsegments that must be split first
  uint open;      // of these, if it explains, that have a place to be split at
  uint fixed;     // that may not be split
} Aim;

// A subsegment is in the way. `looks`: for a place to split it at.
static void meet(Judge judge, uint code, Aim* aim, bool looks) {
  if (!may_split(judge.mesh, judge.rules, code)) {
    ++aim->fixed;
    return;
  }
  ++aim->in_way;
  if (looks && find_place(judge, GCDT_SIDE_EDGE(code)).found) ++aim->open;
}

// Asks for the subsegments that are in the way of an aim: when it is known that it does not sit out. Ends: go_on.
static void ask_for_way(Judge judge, Aim aim, Lists lists) {
  const Mesh mesh = judge.mesh;
  if (aim.at.kind == GCDT_AT_SUBSEGMENT) {
    ask(lists, GCDT_SIDE_EDGE(element(mesh.face_data[GCDT_SIDES(aim.at.face)], aim.at.corner)));
    return;
  }
  Tour tour = begin_tour(mesh, judge.marks, aim.at.face, aim.target);
  do {
    if (tour.constrained &&
        gcdt_in_lens(judge.rules, corner_vertex(mesh, tour.corners, next_corner(tour.corner)),
                     corner_vertex(mesh, tour.corners, previous_corner(tour.corner)), aim.target) &&
        may_split(mesh, judge.rules, tour.code))
      ask(lists, GCDT_SIDE_EDGE(tour.code));
  } while (go_on(&tour));
}

// The target of a triangle, by a walk to it and a tour of its cavity. A subsegment that stops the walk, or has the
// target in its lens, must be split first. A target too near a vertex is given up: a circumcentre has R >= s / (2 sin
// theta), so up to 39 degrees sqrt(5/8) s around it are free unless rounding or a subsegment has been at work. A cavity
// of more than `most` faces is given up for this round, before anything has come of it. `explains`: to tell the reason.
static Aim aim_from(Judge judge, uint face, Judged j, bool explains, ulong most, CavityList* cavity, Lists lists) {
  Aim aim;
  const Mesh mesh = judge.mesh;
  const uint k = j.shape.corner;
  aim.wanted = aim.failed = aim.sits_out = false;
  aim.in_way = aim.open = aim.fixed = 0u;
  aim.target =
      gcdt_aim(corner_vertex(mesh, j.corners, next_corner(k)), corner_vertex(mesh, j.corners, previous_corner(k)),
               corner_vertex(mesh, j.corners, k), j.shape, judge.rules);
  aim.at = walk_to(mesh, judge.marks, face, aim.target);
  if (aim.at.kind == GCDT_AT_SUBSEGMENT)
    meet(judge, element(mesh.face_data[GCDT_SIDES(aim.at.face)], aim.at.corner), &aim, explains);
  if (aim.at.kind == GCDT_AT_FAILED) aim.failed = true;
  if (aim.at.kind != GCDT_AT_FACE && aim.at.kind != GCDT_AT_EDGE) return aim;
  const u64 times = j.verdict == VERDICT_SHARP ? 8u : 4u, least = j.verdict == VERDICT_SHARP ? 5u : 1u;
  ulong entered = 0u;
  bool near = false;
  Tour tour = begin_ordered_tour(mesh, judge.marks, aim.at.face, aim.target);
  do {
    if (tour.entered) {
      if (++entered > most) {
        aim.sits_out = true;
        return aim;
      }
      if (cavity) add_to_list(cavity, tour.face, lists.report);
    }
    const Vertex p = corner_vertex(mesh, tour.corners, next_corner(tour.corner)),
                 q = corner_vertex(mesh, tour.corners, previous_corner(tour.corner));
    // Each corner of the cavity begins one of the sides that are looked over.
    if (gcdt_product_less(times, gcdt_squared_length(p, aim.target), least, j.shape.shortest)) near = true;
    if (tour.constrained && gcdt_in_lens(judge.rules, p, q, aim.target)) meet(judge, tour.code, &aim, explains);
  } while (go_on(&tour));
  aim.failed = tour.steps == 0u;
  aim.wanted = !near && aim.in_way == 0u && aim.fixed == 0u;
  return aim;
}

#define LIST_PARAMETERS                                                                                  \
  uint capacity, global uint *asked, global ulong *keys, global uint *numbers, global uint4 *candidates, \
      volatile global RefineReport *report

#define MAKE_LISTS(lists)        \
  Lists lists;                   \
  lists.marks = edge_marks;      \
  lists.asked = asked;           \
  lists.keys = keys;             \
  lists.numbers = numbers;       \
  lists.candidates = candidates; \
  lists.capacity = capacity;     \
  lists.report = report

// Asks for the subsegments among the face's sides that have its other corner in their lens. Returns whether there are
// any that may be split.
static bool ask_for_encroached(Judge judge, uint face, Lists lists) {
  const uint4 c = judge.mesh.face_data[GCDT_CORNERS(face)], s = judge.mesh.face_data[GCDT_SIDES(face)];
  bool any = false;
  for (uint k = 0; k < 3u; ++k) {
    const uint code = element(s, k);
    if (!is_constrained(judge.marks, code) ||
        !gcdt_in_lens(judge.rules, corner_vertex(judge.mesh, c, next_corner(k)),
                      corner_vertex(judge.mesh, c, previous_corner(k)), corner_vertex(judge.mesh, c, k)) ||
        !may_split(judge.mesh, judge.rules, code))
      continue;
    ask(lists, GCDT_SIDE_EDGE(code));
    any = true;
  }
  return any;
}

// One work-item per face, and per face of the list `before` of the last round. Puts kept faces that are to be mended,
// or have a subsegment to be split for a side, into the list `bad`, and those subsegments into the list `asked`. What a
// face is depends on itself alone; one whose claim word is below `threshold` has not changed since the last round, so
// that it is in the list if it was. A face is a new triangle if one of its corners is: all that a round makes are
// joined to a vertex of that round, which have numbers from `judged` on; others keep what their aims have found. Reads
// the mesh. Writes: marks by atomic_or, its face's word of `urgency`, each list's words once, at places that atomics
// give. Lists come in any order, which nothing depends on.
kernel void refine_judge(uint faces, uint threshold, uint were_bad, uint judged, JUDGE_PARAMETERS, LIST_PARAMETERS,
                         global const uint* before, global uint* bad, global uint* urgency) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  FOR_EACH(i, were_bad + faces) {
    const bool was_bad = i < were_bad;
    const uint t = was_bad ? before[i] : i - were_bad;
    const uint4 c = face_data[GCDT_CORNERS(t)];
    const bool changed = c.w >= threshold;
    if (changed == was_bad) continue;
    if (label_of(judge.mesh, t) == 0u) {
      urgency[t] = 0u;
      continue;
    }
    const bool encroached = ask_for_encroached(judge, t, lists);
    if (was_bad) {
      bad[atomic_inc(&report->bad)] = t;
      continue;
    }
    const Judged j = judge_face(judge, t);
    const uint verdict = j.verdict, own = verdict == VERDICT_SHARP ? urgency_of(j.shape) : 0u;
    const bool is_new = max(max(c.x, c.y), c.z) >= judged;
    urgency[t] = (own << URGENCY_BITS) | (is_new ? URGENCY_IN_THE_WAY : urgency[t] & ((1u << URGENCY_BITS) - 1u));
    if (encroached || verdict == VERDICT_SHARP || verdict == VERDICT_LARGE) bad[atomic_inc(&report->bad)] = t;
  }
}

// Tells the host that a triangle has not aimed whose turn it was. Most find it told.
static inline void sit_out(volatile global RefineReport* report) {
  if (report->sitting_out == 0u) atomic_or(&report->sitting_out, 1u);
}

// One work-item per face of the list `bad`. Those that need not wait, and do not lose by their handicap unless `all`
// may aim, make the list `aiming`. Reads the mesh and words of `urgency`. Writes the list's words once, at places that
// an atomic gives: in any order, which nothing depends on; and its face's own way, which no other reads.
kernel void refine_wait(GCDT_MESH_PARAMETERS, global const uint* edge_marks, volatile global RefineReport* report,
                        global const uint* bad, global const uint* urgency, global uchar* ways, global uint* aiming,
                        uint round, uint all) {
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint count = report->bad;
  FOR_EACH(i, count) {
    const uint face = bad[i], found = way_to_worse(mesh, edge_marks, face, ways[face], urgency);
    ways[face] = (uchar)found;
    if (found != GCDT_NO_WAY) continue;
    const uint handicap = all ? 0u : handicap_of(urgency[face]);
    if (handicap > 0u && draw(mesh, face_data[GCDT_CORNERS(face)], round) < handicap)
      sit_out(report);
    else
      aiming[atomic_inc(&report->aiming)] = face;
  }
}

// One work-item per face of the list `aiming`. Finds its target, which becomes a candidate, or subsegments are asked
// for, or neither. Reads the mesh; writes as refine_judge, blocks of `cavities` that an atomic gives once, its place of
// `chosen`, which is its candidate if that is listed, else GCDT_NONE, and its face's word of `urgency`, which no other
// reads. Launched again with more room, it draws the same number, writes the same, and asks for nothing new.
kernel void refine_aim(JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* aiming, global uint* urgency, uint most,
                       uint round, uint blocks, global uint* cavities, global uint* chosen) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  const uint count = report->aiming;
  FOR_EACH(i, count) {
    const uint t = aiming[i];
    chosen[i] = GCDT_NONE;
    const Judged j = judge_face(judge, t);
    if (j.verdict != VERDICT_SHARP && j.verdict != VERDICT_LARGE) continue;
    CavityList cavity = begin_list(cavities, blocks, i);
    const uint number = draw(judge.mesh, j.corners, round);
    const Aim aim = aim_from(judge, t, j, false, (ulong)most << number, &cavity, lists);
    if (aim.failed) atomic_or(&report->failed, 1u);
    if (aim.sits_out) {
      urgency[t] = with_handicap(urgency[t], number);
      sit_out(report);
      continue;
    }
    if (aim.in_way > 0u) ask_for_way(judge, aim, lists);
    if (!aim.wanted) {
      urgency[t] &= ~URGENCY_IN_THE_WAY;
      continue;
    }
    const bool on_edge = aim.at.kind == GCDT_AT_EDGE;
    const uint what = on_edge ? element(face_data[GCDT_SIDES(aim.at.face)], aim.at.corner) : aim.at.face;
    const uint listed = end_list(&cavity);
    const uint candidate =
        add_candidate(lists, gcdt_candidate_key(0u, j.shape.shortest, gcdt_badness(j.shape), aim.target), aim.target,
                      what, (on_edge ? GCDT_ON_EDGE : GCDT_IN_FACE) | listed);
    if (listed) chosen[i] = candidate;
  }
}

// One work-item per subsegment of the list `asked`. Finds a place for its vertex, which becomes a candidate. `sharp`:
// bit 0 and 1 tell of the first and second end of each piece that another subsegment meets it there at less than 60
// degrees over kept faces. Reads the mesh; writes as refine_judge.
kernel void refine_place(JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* edge_pieces, global const uint* sharp) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  judge.edge_pieces = edge_pieces;
  judge.sharp = sharp;
  const uint count = report->asked;
  FOR_EACH(i, count) {
    const Place place = find_place(judge, asked[i]);
    if (place.found)
      add_candidate(lists, gcdt_candidate_key(1u, place.squared, 0u, place.at), place.at, asked[i],
                    place.far ? GCDT_ON_SUBSEGMENT | GCDT_FAR : GCDT_ON_SUBSEGMENT);
    else
      atomic_inc(&report->refused);
  }
}

// Why a kept face is worse than wanted, of GCDT_LEFT_...; VERDICT_FINE if it is not.
static uint reason_of(Judge judge, uint face, Lists lists) {
  const Judged j = judge_face(judge, face);
  if (j.verdict <= VERDICT_FINE) return j.verdict;
  const Aim aim = aim_from(judge, face, j, true, ~0ul, 0, lists);
  if (aim.failed) atomic_or(&lists.report->failed, 1u);
  if (aim.fixed > 0u) return GCDT_LEFT_FIXED;
  if (aim.wanted || aim.open > 0u) return GCDT_LEFT_LIMIT;
  return aim.in_way > 0u ? GCDT_LEFT_REFUSED : GCDT_LEFT_TARGET;
}

// One work-item per face. Counts why kept faces are worse than wanted, and subsegments with the corner of a kept face
// in their lens, once a side. Reads the mesh. Writes the report by atomics, and of each face 1 + the reason, or 0.
kernel void refine_explain(uint faces, JUDGE_PARAMETERS, LIST_PARAMETERS, global const uint* edge_pieces,
                           global const uint* sharp, global uint* reasons) {
  MAKE_JUDGE(judge);
  MAKE_LISTS(lists);
  judge.edge_pieces = edge_pieces;
  judge.sharp = sharp;
  FOR_EACH(t, faces) {
    const uint4 s = face_data[GCDT_SIDES(t)];
    reasons[t] = 0u;
    if (s.w == 0u) continue;
    const uint4 c = face_data[GCDT_CORNERS(t)];
    for (uint k = 0; k < 3u; ++k)
      if (is_constrained(edge_marks, element(s, k)) &&
          gcdt_in_lens(judge.rules, corner_vertex(judge.mesh, c, next_corner(k)),
                       corner_vertex(judge.mesh, c, previous_corner(k)), corner_vertex(judge.mesh, c, k)))
        atomic_inc(&report->encroached);
    const uint reason = reason_of(judge, t, lists);
    if (reason == VERDICT_FINE) continue;
    atomic_inc(&report->left[reason]);
    reasons[t] = reason + 1u;
  }
}
