// SPDX-License-Identifier: Apache-2.0
// Regions, depths and winding numbers for CPUs and batches of small problems: of each problem by one work-item, while
// it is in its cache. What regions.cl and domain.cl do for one mesh, with the same results; domain.cl defines the
// terms.
//
// A forest in canonical order: a problem's triangles are consecutive, and so are its pieces. No word has two writers:
// all of a problem's are its work-item's, which reads no others. Words by triangle and half edge are where the
// problem's triangles are; words by node begin at gcdt_first_node.
#include "common/corners.h"
#include "domain/domain.h"

// One problem: its triangles first .. last - 1, its pieces low .. high - 1, the mesh, and its words.
typedef struct Part {
  uint first, last, low, high;
  global const uint* corners;
  global const int* neighbours;
  global const uchar* constrained;
  global const uint2* ends;
  global const int* turns;
  global uint* region;    // by triangle, from 0 on in each problem
  global uint* queue;     // triangles to go on from; then nodes in the order of their depths
  global uint* all_arcs;  // constrained half edges between two nodes
  global uint* arcs;      // the same by the node that they leave
  global uint* begins;    // by node: its first arc
  global uint* depth;     // by node
  global int* winding;    // by node
  global uint* entry;     // by node
} Part;

// Labels all that is joined to triangle t, the least without a label; 0 if a neighbour is of another problem, which no
// checked mesh has. Ends, and the queue has room: each triangle is put there once, when it gets its label. What may or
// may not be put there is always written, to the place behind the last, since no branch tells these apart: a processor
// would guess each second one wrongly. The place is there: t itself is never put there again.
static inline uint flood(const Part* part, uint t, uint label) {
  global uint* queue = part->queue;
  uint count = 1;
  part->region[t] = label;
  queue[0] = t;
  while (count > 0u) {
    const uint from = queue[--count], flags = part->constrained[from];
    for (uint k = 0; k < 3u; ++k) {
      const int across = part->neighbours[3u * from + k];
      const uint to = across < 0 ? from : (uint)across;
      if (to < part->first || to >= part->last) return 0u;
      const uint had = part->region[to];
      const bool open = (((flags >> k) & 1u) == 0u) & (had == GCDT_NONE);
      part->region[to] = open ? label : had;
      queue[count] = to;
      count += open ? 1u : 0u;
    }
  }
  return 1u;
}

// Numbers the regions by their least triangles. Returns how many there are; GCDT_NONE as flood() does.
static inline uint label_part(const Part* part) {
  for (uint t = part->first; t < part->last; ++t) part->region[t] = GCDT_NONE;
  uint count = 0;
  for (uint t = part->first; t < part->last; ++t)
    if (part->region[t] == GCDT_NONE && !flood(part, t, count++)) return GCDT_NONE;
  return count;
}

// The winding number beyond half edge k of triangle t less that on this side: as turn_across of domain.cl. Ends: high -
// low shrinks. With one level numbers are ranks, and pieces are sorted by (least end, other end).
static inline int turn_of(const Part* part, uint t, uint k) {
  const uint a = part->corners[3u * t + next_corner(k)], b = part->corners[3u * t + previous_corner(k)];
  const ulong wanted = ((ulong)min(a, b) << 32) | max(a, b);
  uint low = part->low, high = part->high;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    const uint2 e = part->ends[middle];
    const ulong found = ((ulong)e.x << 32) | e.y;
    if (found < wanted) {
      low = middle + 1u;
    } else if (found > wanted) {
      high = middle;
    } else {
      const int left_over_right = e.x == a ? part->turns[middle] : -part->turns[middle];
      return part->neighbours[3u * t + k] < 0 ? left_over_right : -left_over_right;
    }
  }
  return 0;  // the mesh was not checked, and its flags are wrong
}

// The node that arc h leaves, and the one that it leads to.
static inline uint arc_source(const Part* part, uint h) {
  return part->neighbours[h] < 0 ? 0u : part->region[h / 3u] + 1u;
}
static inline uint arc_target(const Part* part, uint h) {
  const int across = part->neighbours[h];
  return part->region[across < 0 ? h / 3u : (uint)across] + 1u;
}

// Begins the search and lists the arcs: all in the order of their numbers, and by node. Puts what is of depth 0 into
// the queue: outside, and regions with an unconstrained edge in the hull. Returns how many there are.
static inline uint list_part(const Part* part, uint nodes) {
  uint count = 0, outside = 1;
  for (uint i = 0; i < nodes; ++i) {
    part->depth[i] = i == 0u ? 0u : GCDT_NONE;
    part->winding[i] = 0;
    part->entry[i] = GCDT_NONE;
    part->begins[i] = 0u;
  }
  part->begins[nodes] = 0u;
  part->queue[0] = 0u;
  for (uint t = part->first; t < part->last; ++t) {
    const uint region = part->region[t], flags = part->constrained[t];
    for (uint k = 0; k < 3u; ++k) {
      const int across = part->neighbours[3u * t + k];
      const uint flagged = (flags >> k) & 1u, beyond = across < 0 ? GCDT_NONE : part->region[across];
      // As in flood(): there is a place for each half edge.
      const uint is_arc = flagged & (beyond != region ? 1u : 0u);
      part->all_arcs[count] = 3u * t + k;
      count += is_arc;
      part->begins[across < 0 ? 0u : region + 1u] += is_arc;
      if (across < 0 && !flagged && part->depth[region + 1u] != 0u) {
        part->depth[region + 1u] = 0u;
        part->queue[outside++] = region + 1u;
      }
    }
  }
  for (uint i = 0, sum = 0; i <= nodes; ++i) part->begins[i] = sum += part->begins[i];
  for (uint i = count; i-- > 0u;) {
    const uint h = part->all_arcs[i];
    part->arcs[--part->begins[arc_source(part, h)]] = h;
  }
  return outside;
}

// Depth by depth, from the `end` nodes in the queue: the nodes that those of depth d lead to get their least entries,
// then depth and winding number. Returns how many nodes were reached. Ends, and the queue has room: a node is put there
// once, when it gets an entry or has depth 0.
static inline uint search_part(const Part* part, uint end) {
  uint begin = 0;
  for (uint d = 0; begin < end; ++d) {
    uint next = end;
    for (uint i = begin; i < end; ++i) {
      const uint node = part->queue[i];
      for (uint a = part->begins[node]; a < part->begins[node + 1u]; ++a) {
        const uint h = part->arcs[a], target = arc_target(part, h);
        if (part->depth[target] != GCDT_NONE) continue;
        if (part->entry[target] == GCDT_NONE) part->queue[next++] = target;
        part->entry[target] = min(part->entry[target], h);
      }
    }
    for (uint i = end; i < next; ++i) {
      const uint node = part->queue[i], h = part->entry[node];
      part->winding[node] = part->winding[arc_source(part, h)] + turn_of(part, h / 3u, h % 3u);
      part->depth[node] = d + 1u;
    }
    begin = end;
    end = next;
  }
  return begin;
}

// One work-item per problem. Reads the mesh and the pieces with their turns.
// Writes region, depth and winding, kept[t]: the triangle's place among the kept ones of its problem, -1 if it is
// removed; and kept_count[p]. queue, all_arcs, arcs, begins and entry are void afterwards. Adds to report: atomics, in
// any order the same.
kernel void domain_each(uint problems, uint rule, global const uint* first_triangle, global const uint* first_piece,
                        global const uint* corners, global const int* neighbours, global const uchar* constrained,
                        global const uint2* ends, global const int* turns, global uint* region, global uint* queue,
                        global uint* all_arcs, global uint* arcs, global uint* begins, global uint* depth,
                        global int* winding, global uint* entry, global int* kept, global uint* kept_count,
                        volatile global DomainReport* report) {
  const Items mine = problems_of_this(problems, first_triangle);
  FOR_ITEMS(p, mine) {
    const uint first = first_triangle[p], last = first_triangle[p + 1u], by_node = gcdt_first_node(first, p);
    kept_count[p] = 0u;
    if (first == last) continue;
    const Part part = {first,
                       last,
                       first_piece[p],
                       first_piece[p + 1u],
                       corners,
                       neighbours,
                       constrained,
                       ends,
                       turns,
                       region,
                       queue + by_node,
                       all_arcs + 3u * (size_t)first,
                       arcs + 3u * (size_t)first,
                       begins + by_node,
                       depth + by_node,
                       winding + by_node,
                       entry + by_node};
    const uint regions = label_part(&part);
    if (regions == GCDT_NONE) {
      atomic_or(&report->pending, 1u);
      continue;
    }
    const uint reached = search_part(&part, list_part(&part, regions + 1u));
    uint count = 0;
    for (uint t = first; t < last; ++t) {
      const uint node = region[t] + 1u;
      const uint keeps = domain_keeps(rule, part.depth[node], part.winding[node], 0u);
      kept[t] = keeps ? (int)count : -1;
      count += keeps;
    }
    kept_count[p] = count;
    atomic_add(&report->regions, regions);
    atomic_add(&report->settled, reached - 1u);
  }
}

// One work-item per problem. Reads what domain_each has written, and first_kept, the scan of kept_count.
// Writes the kept triangles: the mesh (unless all are kept, `rule` says), region, depth and winding number. A kept
// triangle is its problem's.
// After this kernel neighbours across removed triangles are -1, and regions are numbered problem by problem.
kernel void domain_each_keep(uint problems, uint rule, global const uint* first_triangle, global const uint* first_kept,
                             global const int* kept, global const uint* corners, global const int* neighbours,
                             global const uchar* constrained, global const uint* region, global const uint* depth,
                             global const int* winding, global uint* out_corners, global int* out_neighbours,
                             global uchar* out_constrained, global uint* out_region, global uint* out_depth,
                             global int* out_winding) {
  const Items mine = problems_of_this(problems, first_triangle);
  FOR_ITEMS(p, mine) {
    const uint first = first_triangle[p], by_node = gcdt_first_node(first, p);
    const int begin = (int)first_kept[p];
    for (uint t = first; t < first_triangle[p + 1u]; ++t) {
      if (kept[t] < 0) continue;
      const uint place = (uint)(begin + kept[t]), node = by_node + region[t] + 1u;
      out_region[place] = region[t];
      out_depth[place] = depth[node];
      out_winding[place] = winding[node];
      if (rule == GCDT_KEEP_ALL) continue;
      for (uint k = 0; k < 3u; ++k) {
        const int across = neighbours[3u * t + k];
        out_corners[3u * place + k] = corners[3u * t + k];
        out_neighbours[3u * place + k] = across < 0 || kept[across] < 0 ? -1 : begin + kept[across];
      }
      out_constrained[place] = constrained[t];
    }
  }
}
