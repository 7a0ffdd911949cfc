// SPDX-License-Identifier: Apache-2.0
// Flips that follow one another along a fan, all of them in one round. Where a vertex v comes into the triangles around
// another one, x, each flip gives it one neighbour of x's, and the next edge to be flipped leads from x to that
// neighbour: a chain, one flip a round. But whether the k-th edge of the fan is illegal when its turn comes is said by
// v, x and the k-th triangle alone, and that triangle has not been changed by the flips before. So a work-item looks
// ahead along the fan, two loads a triangle; the group tests all edges that it found, side by side; and as many flips
// as the first of them that are illegal are done at once, each by a work-item of its own. They are the flips that
// rounds would do one after the other, with the same result.
//
//      p0----p1----p2       near = (v, x, y); the fan around x: f0 = (p0, y, x), f1 = (p1, p0, x), f2 = (p2, p1, x),
//     / \ f1 | f2 / \       with the edges e0 = x-y, e1 = x-p0, e2 = x-p1, e3 = x-p2 in front of them and behind.
//    / f0 \  |   /   \      After three flips f0 = (p0, y, v), f1 = (p1, p0, v), f2 = (p2, p1, v), near = (v, x, p2);
//   y-------- x --------    e0 = v-p0, e1 = v-p1, e2 = v-p2, and e3 is still x-p2.
//    \ near /
//     \    /                The fan around y is the mirror image.
//       v
//
// An edge to be flipped has two faces, of which each may be the near one, and each has two fans. Four fans are looked
// along, and the one of the most flips is taken: what the others offer comes in rounds to follow.
// OpenCL C only.
#ifndef GCDT_SLIDE_H
#define GCDT_SLIDE_H

#include "flip/rounds.h"

// Edges listed in a round that slides at most: many are flipped side by side, and faster so.
#define GCDT_SLIDE_TESTS 96u
// A round may slide if it has at least one edge for so many of the round before. (Tests let every round slide by this
// and by no pause.)
#ifndef GCDT_SLIDE_SHARE
#define GCDT_SLIDE_SHARE 2u
#endif
// Rounds without another attempt, at most, after vain ones.
#ifndef GCDT_SLIDE_PAUSE
#define GCDT_SLIDE_PAUSE 64u
#endif
#define GCDT_SLIDE_FLIPS 64u   // of a slide at most, which bounds the launch
#define GCDT_SLIDE_ROOM 2048u  // triangles of all fans

// Where flips propagate, chains need no slides; where records are not read whole, sides are not kept.
#if GCDT_FLIP_CHAIN == 1 && !defined(GCDT_CONTIGUOUS)
#define GCDT_SLIDES
#endif

#ifdef GCDT_SLIDES

// In local memory. A slide has two faces, each of which has two fans, around x and around y; the longest one is taken.
// Fan f is that of face f / 2, around y if f is odd, and has `stride` words of `refs` and `codes` from f * stride on.
typedef struct SlidesMemory {
  local uint* refs;             // of f_k, at p_k
  local uint* codes;            // of e_k: the side of f_(k-1), or of the near face
  local uint* known;            // of each fan: how many triangles are known
  volatile local uint* broken;  // of each fan: the first known edge that cannot be flipped, or GCDT_NONE
  local uint* outer;            // of each fan: the near face's side that f0 gets
  local uint *near, *v;         // of each face: its reference at v, and v
  local uint* ticket;           // of each slide
  volatile local uint* counts;  // slides; fans that grow, for stages of even and of odd numbers
} SlidesMemory;

// Declared in the kernel itself, as OpenCL C 1.2 asks.
#define DECLARE_SLIDES(name)                                                                                    \
  local uint name##_refs[GCDT_SLIDE_ROOM], name##_codes[GCDT_SLIDE_ROOM], name##_known[4u * GCDT_SLIDE_TESTS],  \
      name##_outer[4u * GCDT_SLIDE_TESTS], name##_near[2u * GCDT_SLIDE_TESTS], name##_v[2u * GCDT_SLIDE_TESTS], \
      name##_ticket[GCDT_SLIDE_TESTS];                                                                          \
  volatile local uint name##_broken[4u * GCDT_SLIDE_TESTS], name##_counts[3];                                   \
  const SlidesMemory name = {.refs = name##_refs,                                                               \
                             .codes = name##_codes,                                                             \
                             .known = name##_known,                                                             \
                             .broken = name##_broken,                                                           \
                             .outer = name##_outer,                                                             \
                             .near = name##_near,                                                               \
                             .v = name##_v,                                                                     \
                             .ticket = name##_ticket,                                                           \
                             .counts = name##_counts}

// The corner of x or y in a fan's triangle whose corner p is d, and the other one: that of the neighbour before.
static inline uint corner_of_centre(uint fan, uint d) { return (fan & 1u) ? next_corner(d) : previous_corner(d); }
static inline uint corner_before(uint fan, uint d) { return (fan & 1u) ? previous_corner(d) : next_corner(d); }

// The two fans of one of a slide's faces, with reference `near`; beyond the edge is the other face, the first triangle
// of both.
GCDT_GIVEN_LOCAL void begin_fans(SlidesMemory s, uint face, uint stride, uint near, uint4 corners, uint4 sides,
                                 uint beyond, uint4 sides_beyond) {
  const uint b = GCDT_REF_CORNER(near), d = GCDT_REF_CORNER(beyond);
  s.v[face] = element(corners, b);
  s.near[face] = near;
  for (uint fan = 2u * face; fan < 2u * face + 2u; ++fan) {
    const uint at = fan * stride;
    s.outer[fan] = element(sides, corner_before(fan, b));
    s.known[fan] = 1u;
    s.broken[fan] = GCDT_NONE;
    s.refs[at] = beyond;
    s.codes[at] = element(sides, b);
    s.codes[at + 1u] = element(sides_beyond, corner_before(fan, d));
  }
}

// Looks up the triangles of a fan from the `from`-th up to the `to`-th, two loads each that depend on one another.
// Returns whether there are any. It ends at the border of the mesh. (One that leads all the way around comes to v,
// beyond which it is not tested.)
GCDT_GIVEN_LOCAL bool look_ahead(Mesh mesh, SlidesMemory s, uint fan, uint stride, uint from, uint to) {
  const uint at = fan * stride;
  if (s.known[fan] < from || s.broken[fan] != GCDT_NONE) return false;
  uint k = from, code = s.codes[at + from];
  for (; k < to; ++k) {
    const uint ref = mesh.edge_faces[code ^ 1u];
    if (ref == GCDT_NONE) break;
    code = face_side(mesh, GCDT_REF_FACE(ref), corner_before(fan, GCDT_REF_CORNER(ref)));
    s.refs[at + k] = ref;
    s.codes[at + k + 1u] = code;
  }
  s.known[fan] = k;
  return k > from;
}

// Whether the edge with this code, in front of the triangle (p, Y, X) with reference `ref`, is illegal beside the face
// (v, X, Y), and the triangle is owned, or now is.
static bool goes_on(Mesh mesh, volatile global uint* marks, Claim c, uint ticket, uint v, uint ref, uint code) {
  const uint face = GCDT_REF_FACE(ref);
  const uint4 r = rotate_to(mesh.face_data[GCDT_CORNERS(face)], GCDT_REF_CORNER(ref));
  if (r.x == v || (marks[GCDT_SIDE_EDGE(code)] & GCDT_MARK_CONSTRAINED)) return false;
  return gcdt_must_flip(load_vertex(mesh.points, mesh.n, r.y), load_vertex(mesh.points, mesh.n, v),
                        load_vertex(mesh.points, mesh.n, r.z), load_vertex(mesh.points, mesh.n, r.x)) &&
         own_face(mesh, face, r.w, ticket, c);
}

// A slide: which of its fans, and how many flips.
typedef struct Slide {
  uint fan, flips;
} Slide;

// Ends: four fans.
GCDT_GIVEN_LOCAL Slide longest_fan(SlidesMemory s, uint slide) {
  Slide longest = {.fan = 4u * slide, .flips = 0u};
  for (uint fan = 4u * slide; fan < 4u * slide + 4u; ++fan) {
    const uint flips = min(s.broken[fan], s.known[fan]);
    if (flips <= longest.flips) continue;
    longest.fan = fan;
    longest.flips = flips;
  }
  return longest;
}

// The k-th triangle of a slide: v for x (or y), and between v-p_(k-1) and v-p_k.
GCDT_GIVEN_LOCAL void slide_triangle(Mesh mesh, SlidesMemory s, Slide slide, uint stride, uint k, Queue queue) {
  const uint at = slide.fan * stride + k, ref = s.refs[at], code = s.codes[at],
             before = k == 0u ? s.outer[slide.fan] : s.codes[at - 1u];
  const uint f = GCDT_REF_FACE(ref), d = GCDT_REF_CORNER(ref), centre = corner_of_centre(slide.fan, d),
             other = corner_before(slide.fan, d), around = face_side(mesh, f, centre);
  ((global uint*)(mesh.face_data + GCDT_CORNERS(f)))[centre] = s.v[slide.fan / 2u];
  set_side(mesh.face_data, f, d, before);
  set_side(mesh.face_data, f, other, code ^ 1u);
  mesh.edge_faces[before] = ref;
  mesh.edge_faces[code ^ 1u] = GCDT_FACE_REF(f, other);
  queue_edge(queue, GCDT_SIDE_EDGE(around));
  queue_edge(queue, GCDT_SIDE_EDGE(before));
}

// Its near face, which ends up between v-p_last and the edge that was not flipped.
GCDT_GIVEN_LOCAL void slide_near(Mesh mesh, SlidesMemory s, Slide slide, uint stride, Queue queue) {
  const uint at = slide.fan * stride + slide.flips, near = s.near[slide.fan / 2u], last = s.refs[at - 1u],
             flipped = s.codes[at - 1u], left = s.codes[at], kept = s.outer[slide.fan ^ 1u];
  const uint a = GCDT_REF_FACE(near), b = GCDT_REF_CORNER(near);
  // In the fan around x: across from x, where the edge from v to y was; y's corner becomes p_last.
  const uint across = corner_before(slide.fan, b), moved = corner_of_centre(slide.fan, b);
  ((global uint*)(mesh.face_data + GCDT_CORNERS(a)))[moved] =
      face_corner(mesh, GCDT_REF_FACE(last), GCDT_REF_CORNER(last));
  set_side(mesh.face_data, a, b, left);
  set_side(mesh.face_data, a, across, flipped);
  mesh.edge_faces[left] = near;
  mesh.edge_faces[flipped] = GCDT_FACE_REF(a, across);
  queue_edge(queue, GCDT_SIDE_EDGE(left));
  queue_edge(queue, GCDT_SIDE_EDGE(kept));
}

// Which rounds slide, the same for all of the group: those of few edges, where there are not much fewer than in the
// round before, as a chain has a flip in every round; and then for as long as there is a fan of four flips or more for
// every four slides. After a vain attempt the next one is put off, each time twice as long.
typedef struct Pace {
  uint before;       // edges of the round before
  uint rest, pause;  // rounds until the next attempt; those after the next vain one
  bool pays;
} Pace;

GCDT_GIVEN_LOCAL bool slides_now(Pace p, uint tests) {
  return tests <= GCDT_SLIDE_TESTS && (p.pays || (p.rest == 0u && tests >= p.before / GCDT_SLIDE_SHARE));
}

GCDT_GIVEN_LOCAL void note_slides(private Pace* p, uint slides, uint longer) {
  p->pays = slides > 0u && 4u * longer >= slides;
  p->rest = p->pays ? 0u : p->pause;
  p->pause = p->pays ? 1u : min(2u * p->pause, GCDT_SLIDE_PAUSE);
}

// The group's work-items each have an illegal edge or none (`kept`), whose faces it `owns` or does not. Those that do
// slide, and their work-items have none any more. Returns the number of the work-item's flips.
//
// No race: until the last barrier the mesh is read, and only claim words change (flip_propagate). From then on each
// triangle of a slide, and each near face, is written by one work-item, and read by it alone but for the corner p_last,
// which nobody writes: all of them are owned under the slide's ticket. The sides of e_0 to e_(r-1), that of e_r which
// f_(r-1) had, and the near face's two are dealt to them anew, each side to one. What is queued: every edge of what was
// changed but e_(r-1), the last one flipped.
// Ends: `from` doubles up to a fan's room. (The loop is left at its head alone: PoCL 3.1 does not come out of one that
// is left between two barriers.)
GCDT_GIVEN_LOCAL uint slide_along_fans(Mesh mesh, volatile global uint* marks, Claim c, private Kept* kept, bool owns,
                                       SlidesMemory s, private Pace* pace, Queue queue) {
  const uint me = get_local_id(0), size = (uint)get_local_size(0);
  const uint slide = owns ? atomic_inc(s.counts) : GCDT_NONE;
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint slides = s.counts[0], fans = 4u * slides,
             stride = min(GCDT_SLIDE_FLIPS + 1u, GCDT_SLIDE_ROOM / max(fans, 1u));
  if (owns) {
    begin_fans(s, 2u * slide, stride, kept->refs.x, kept->corners_t, kept->st, kept->refs.y, kept->su);
    begin_fans(s, 2u * slide + 1u, stride, kept->refs.y, kept->corners_u, kept->su, kept->refs.x, kept->st);
    s.ticket[slide] = make_ticket(c.stamp, c.bits, kept->e);
    kept->e = GCDT_NONE;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  uint from = 1, longer = 0;
  for (uint stage = 0; stage == 0u ? slides > 0u : s.counts[1u + (stage & 1u)] > 0u; ++stage) {
    const uint to = min(2u * from, stride - 1u);
    if (stage == 3u) longer = s.counts[1u + (stage & 1u)];  // fans not broken before their fourth edge
    for (uint fan = me; fan < fans; fan += size) {
      if (look_ahead(mesh, s, fan, stride, from, to)) atomic_inc(s.counts + 1u + (~stage & 1u));
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    if (me == 0u) s.counts[1u + (stage & 1u)] = 0u;
    for (uint i = me; i < fans * from; i += size) {
      const uint fan = i / from, k = from + i % from, at = fan * stride + k;
      if (k < s.known[fan] && !goes_on(mesh, marks, c, s.ticket[fan / 4u], s.v[fan / 2u], s.refs[at], s.codes[at]))
        atomic_min(s.broken + fan, k);
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    from = to;
  }
  note_slides(pace, slides, longer);
  uint flips = 0;
  for (uint i = me; i < slides * stride; i += size) {
    const uint k = i % stride;
    const Slide mine = longest_fan(s, i / stride);
    if (k < mine.flips) {
      slide_triangle(mesh, s, mine, stride, k, queue);
      ++flips;
    } else if (k == mine.flips) {
      slide_near(mesh, s, mine, stride, queue);
    }
  }
  return flips;
}

// As flip_in_group, with slides in rounds of few flips.
GCDT_GIVEN_LOCAL uint slide_in_group(Mesh mesh, global uint* edge_marks, uint stamp, uint bits, uint most, OwnLists own,
                                     RoundsMemory memory, SlidesMemory slides, private uint* flips) {
  uint done = 0;
  Pace pace = {.before = GCDT_NONE, .rest = 0u, .pause = 1u, .pays = false};
  begin_rounds(own, memory);
  for (;;) {
    const uint tests = memory.tests[done & 1u];
    if (tests == 0u || done == most) break;
    const Claim c = make_claim(stamp + done, bits);
    if (get_local_id(0) == 0) slides.counts[0] = slides.counts[1] = slides.counts[2] = 0u;
    Kept kept = test_listed(mesh, edge_marks, c, tests, done, own, memory);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    const bool owns = kept.e != GCDT_NONE && owns_faces(mesh, c, kept);
    const Queue queue = queue_of_round(edge_marks, done, own, memory);
    if (slides_now(pace, tests))
      *flips += slide_along_fans(mesh, edge_marks, c, &kept, owns, slides, &pace, queue);
    else if (pace.rest > 0u)
      --pace.rest;
    pace.before = tests;
    *flips += flip_listed(mesh, c, kept, owns, done, own, memory, queue);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    ++done;
  }
  end_rounds(own, memory, done);
  return done;
}

#else

// Nobody slides.
typedef struct SlidesMemory {
  uint none;
} SlidesMemory;
#define DECLARE_SLIDES(name) const SlidesMemory name = {.none = 0u}
GCDT_GIVEN_LOCAL uint slide_in_group(Mesh mesh, global uint* edge_marks, uint stamp, uint bits, uint most, OwnLists own,
                                     RoundsMemory memory, SlidesMemory slides, private uint* flips) {
  return flip_in_group(mesh, edge_marks, stamp, bits, most, own, memory, flips);
}

#endif

#endif
